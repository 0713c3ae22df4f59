#include "calibrato/recording/photo.h"

#include <algorithm>
#include <cstdint>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgcodecs.hpp>

#include "calibrato/base/input_error.h"
#include "calibrato/recording/encoded_image.h"

namespace calibrato {
namespace {

// The command line promises one line on stderr; OpenCV would add its own.
void SilenceOpenCvOnce() {
  [[maybe_unused]] static const bool once = [] {
    cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
    cv::redirectError([](int, const char*, const char*, const char*, int, void*) { return 0; });
    return true;
  }();
}

uint32_t FullScale(uint16_t brightest) {
  for (const int bits : {8, 10, 12, 14}) {
    const uint32_t full = (uint32_t{1} << bits) - 1;
    if (brightest <= full) return full;
  }
  return 65535;
}

std::vector<uint8_t> ScaledTo8Bits(const cv::Mat& image) {
  const auto* values = image.ptr<uint16_t>();
  const size_t count = image.total();
  const uint32_t full = FullScale(count == 0 ? 0 : *std::max_element(values, values + count));
  std::vector<uint8_t> pixels(count);
  std::transform(values, values + count, pixels.begin(), [full](uint32_t value) {
    return static_cast<uint8_t>((value * 255 + full / 2) / full);
  });
  return pixels;
}

cv::Mat Decode(const std::string& bytes) {
  SilenceOpenCvOnce();
  const cv::Mat encoded(1, static_cast<int>(bytes.size()), CV_8UC1,
                        const_cast<char*>(bytes.data()));  // cv::Mat knows no const data
  try {
    return cv::imdecode(encoded,
                        cv::IMREAD_GRAYSCALE | cv::IMREAD_ANYDEPTH | cv::IMREAD_IGNORE_ORIENTATION);
  } catch (const cv::Exception&) {
    return {};
  }
}

}  // namespace

GreyImage ReadPhoto(const std::string& path) {
  const EncodedImage encoded = ReadEncodedImage(path);
  const cv::Mat image = Decode(encoded.bytes);
  if (image.empty()) {
    throw InputError({"cannot read image", path, "the file is truncated or damaged",
                      "copy it again or leave it out with --images"});
  }
  const Resolution decoded{image.cols, image.rows};
  const bool has_known_samples = image.type() == CV_8UC1 || image.type() == CV_16UC1;
  if (decoded != encoded.resolution || !has_known_samples || !image.isContinuous()) {
    throw InputError({"cannot read image", path, "its pixels are not of 8 or 16 bits",
                      "convert it to a PNG of 8 bits"});
  }
  GreyImage grey{decoded, {}};
  if (image.depth() == CV_16U) {
    grey.pixels = ScaledTo8Bits(image);
  } else {
    grey.pixels.assign(image.data, image.data + image.total());
  }
  return grey;
}

}  // namespace calibrato
