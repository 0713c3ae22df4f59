#include "calibrato/recording/video_writer.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "calibrato/base/input_error.h"

namespace calibrato {

namespace {

double WholeRate(double rate_hz) {
  constexpr double kRateOfOthers = 30.0;
  const double next = std::ceil(rate_hz);
  return next == rate_hz ? rate_hz : std::max(kRateOfOthers, next);
}

}  // namespace

struct VideoWriter::Parts {
  // What stands, so often that the next picture begins at t_s.
  void ShowUntil(double t_s) {
    for (const int64_t end = std::llround(t_s * rate_hz); num_written < end; ++num_written) {
      file.write(standing);
    }
  }

  Resolution resolution;
  double rate_hz;
  cv::VideoWriter file;
  cv::Mat standing = {};
  int64_t num_written = 0;
};

VideoWriter::VideoWriter(const std::string& path, Resolution resolution, double rate_hz)
    : parts_(new Parts{resolution, WholeRate(rate_hz), {}}) {
  // OpenCV's own writer: other back ends write the time into the file.
  parts_->file.open(path, cv::CAP_OPENCV_MJPEG, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'),
                    parts_->rate_hz, cv::Size(resolution.width, resolution.height));
  if (!parts_->file.isOpened()) {
    throw InputError({"cannot write the video", path, "OpenCV can't open it",
                      "check the folder and the space on the disk"});
  }
}

VideoWriter::~VideoWriter() = default;

void VideoWriter::Add(const RgbImage& image, double t_s) {
  assert(image.resolution == parts_->resolution);
  const cv::Mat rgb(image.resolution.height, image.resolution.width, CV_8UC3,
                    const_cast<uint8_t*>(image.pixels.data()));  // NOLINT
  cv::Mat bgr;
  cv::cvtColor(rgb, bgr, cv::COLOR_RGB2BGR);
  // Before the first picture there is nothing to stand.
  if (parts_->standing.empty()) parts_->standing = bgr;
  parts_->ShowUntil(t_s);
  parts_->standing = bgr;
}

void VideoWriter::Finish(double end_s) {
  if (!parts_->standing.empty()) parts_->ShowUntil(end_s);
  parts_->file.release();
}

}  // namespace calibrato
