#include "calibrato/recording/video_writer.h"

#include <cassert>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "calibrato/base/input_error.h"

namespace calibrato {

struct VideoWriter::Parts {
  Resolution resolution;
  cv::VideoWriter file;
};

VideoWriter::VideoWriter(const std::string& path, Resolution resolution, double rate_hz)
    : parts_(new Parts{resolution, {}}) {
  // OpenCV's own writer: other back ends write the time into the file.
  parts_->file.open(path, cv::CAP_OPENCV_MJPEG, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'),
                    rate_hz, cv::Size(resolution.width, resolution.height));
  if (!parts_->file.isOpened()) {
    throw InputError({"cannot write the video", path, "OpenCV can't open it",
                      "check the folder and the space on the disk"});
  }
}

VideoWriter::~VideoWriter() = default;

void VideoWriter::Add(const RgbImage& image) {
  assert(image.resolution == parts_->resolution);
  const cv::Mat rgb(image.resolution.height, image.resolution.width, CV_8UC3,
                    const_cast<uint8_t*>(image.pixels.data()));  // NOLINT
  cv::Mat bgr;
  cv::cvtColor(rgb, bgr, cv::COLOR_RGB2BGR);
  parts_->file.write(bgr);
}

}  // namespace calibrato
