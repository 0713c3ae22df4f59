#include "calibrato/recording/live_camera.h"

#include <algorithm>
#include <cctype>
#include <chrono>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "calibrato/base/input_error.h"

namespace calibrato {

struct LiveCamera::Impl {
  cv::VideoCapture capture;
};

LiveCamera::LiveCamera(const std::string& device) : impl_(std::make_unique<Impl>()) {
  const bool is_number = !device.empty() && device.size() < 4 &&
                         std::all_of(device.begin(), device.end(),
                                     [](unsigned char c) { return std::isdigit(c) != 0; });
  const bool is_open = is_number ? impl_->capture.open(std::stoi(device), cv::CAP_V4L2)
                                 : impl_->capture.open(device);
  if (!is_open) {
    throw InputError({"cannot open camera", device, "there is none, or another program has it",
                      "give a number as 0, a device as /dev/video0, or an address"});
  }
  impl_->capture.set(cv::CAP_PROP_ORIENTATION_AUTO, 0);
  // Frames that wait in a queue would get stamps of when they leave it. Where a backend has none to
  // set, as that of streams, nothing changes.
  impl_->capture.set(cv::CAP_PROP_BUFFERSIZE, 1);
}

LiveCamera::~LiveCamera() = default;

std::optional<LiveCamera::Frame> LiveCamera::Next() {
  if (!impl_->capture.grab()) return std::nullopt;
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  const Time stamp =
      Time::FromNanoseconds(std::chrono::duration_cast<std::chrono::nanoseconds>(now).count());
  cv::Mat pixels;
  if (!impl_->capture.retrieve(pixels) || pixels.empty() || pixels.depth() != CV_8U) {
    return std::nullopt;
  }
  cv::Mat grey = pixels;
  if (pixels.channels() == 3) cv::cvtColor(pixels, grey, cv::COLOR_BGR2GRAY);
  if (pixels.channels() == 4) cv::cvtColor(pixels, grey, cv::COLOR_BGRA2GRAY);
  if (!grey.isContinuous()) grey = grey.clone();
  Frame frame{stamp, {{grey.cols, grey.rows}, {}}};
  frame.image.pixels.assign(grey.data, grey.data + grey.total());
  return frame;
}

}  // namespace calibrato
