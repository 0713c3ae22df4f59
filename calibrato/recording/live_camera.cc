#include "calibrato/recording/live_camera.h"

#include <algorithm>
#include <cctype>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <filesystem>
#include <mutex>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <thread>
#include <utility>

#include "calibrato/base/input_error.h"

namespace calibrato {
namespace {

std::optional<GreyImage> Retrieved(cv::VideoCapture* capture) {
  cv::Mat pixels;
  if (!capture->retrieve(pixels) || pixels.empty() || pixels.depth() != CV_8U) return std::nullopt;
  cv::Mat grey = pixels;
  if (pixels.channels() == 3) cv::cvtColor(pixels, grey, cv::COLOR_BGR2GRAY);
  if (pixels.channels() == 4) cv::cvtColor(pixels, grey, cv::COLOR_BGRA2GRAY);
  if (!grey.isContinuous()) grey = grey.clone();
  GreyImage image{{grey.cols, grey.rows}, {}};
  image.pixels.assign(grey.data, grey.data + grey.total());
  return image;
}

LiveCamera::Device OpenDevice(const std::string& device) {
  const auto capture = std::make_shared<cv::VideoCapture>();
  const bool is_number = !device.empty() && device.size() < 4 &&
                         std::all_of(device.begin(), device.end(),
                                     [](unsigned char c) { return std::isdigit(c) != 0; });
  // OpenCV asks one library after another about a path that is not there, each with words of its
  // own.
  std::error_code unknown;
  const bool is_missing = device.starts_with("/") && device.find('%') == std::string::npos &&
                          !std::filesystem::exists(device, unknown);
  const bool is_open = !is_missing && (is_number ? capture->open(std::stoi(device), cv::CAP_V4L2)
                                                 : capture->open(device));
  if (!is_open) {
    throw InputError({"cannot open camera", device, "there is none, or another program has it",
                      "give a number as 0, a device as /dev/video0, or an address"});
  }
  capture->set(cv::CAP_PROP_ORIENTATION_AUTO, 0);
  // Frames that wait in a queue would get stamps of when they leave it. Where a backend has none to
  // set, as that of streams, nothing changes.
  capture->set(cv::CAP_PROP_BUFFERSIZE, 1);
  // What knows how many frames it has, as files and sequences of images do, can wait.
  const bool has_end = !is_number && capture->get(cv::CAP_PROP_FRAME_COUNT) > 0.0;
  return {[capture] { return capture->grab(); }, [capture] { return Retrieved(capture.get()); },
          !has_end};
}

Time Now() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return Time::FromNanoseconds(std::chrono::duration_cast<std::chrono::nanoseconds>(now).count());
}

}  // namespace

struct LiveCamera::Impl {
  Device device;
  std::mutex mutex;
  std::condition_variable changed;
  std::optional<Frame> latest;
  bool has_ended = false;
  bool stop = false;
  std::thread thread;

  void Run() {
    try {
      while (TakeOne()) {
      }
    } catch (const std::exception&) {  // Of the device's library: the camera is gone.
    }
    const std::lock_guard lock(mutex);
    has_ended = true;
    changed.notify_all();
  }

  bool TakeOne() {
    {
      std::unique_lock lock(mutex);
      changed.wait(lock, [&] { return stop || device.may_drop || !latest; });
      if (stop) return false;
    }
    if (!device.grab()) return false;
    const Time stamp = Now();
    std::optional<GreyImage> image = device.retrieve();
    if (!image) return false;
    const std::lock_guard lock(mutex);
    const int num_dropped = latest ? latest->num_dropped + 1 : 0;
    latest = Frame{stamp, std::move(*image), num_dropped};
    changed.notify_all();
    return true;
  }
};

LiveCamera::LiveCamera(const std::string& device) : LiveCamera(OpenDevice(device)) {}

LiveCamera::LiveCamera(Device device) : impl_(std::make_unique<Impl>()) {
  impl_->device = std::move(device);
  impl_->thread = std::thread([impl = impl_.get()] { impl->Run(); });
}

LiveCamera::~LiveCamera() {
  {
    const std::lock_guard lock(impl_->mutex);
    impl_->stop = true;
  }
  impl_->changed.notify_all();
  impl_->thread.join();
}

std::optional<LiveCamera::Frame> LiveCamera::Next() {
  std::unique_lock lock(impl_->mutex);
  impl_->changed.wait(lock, [&] { return impl_->latest || impl_->has_ended; });
  std::optional<Frame> frame = std::exchange(impl_->latest, {});
  impl_->changed.notify_all();
  return frame;
}

}  // namespace calibrato
