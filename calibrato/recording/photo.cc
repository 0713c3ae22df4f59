#include "calibrato/recording/photo.h"

#include <bit>
#include <cstdint>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "calibrato/base/input_error.h"
#include "calibrato/recording/encoded_image.h"
#include "calibrato/recording/pixel_scaling.h"

namespace calibrato {
namespace {

constexpr int kAsStored = cv::IMREAD_ANYDEPTH | cv::IMREAD_IGNORE_ORIENTATION;

// The command line promises one line on stderr; OpenCV would add its own.
void SilenceOpenCvOnce() {
  [[maybe_unused]] static const bool once = [] {
    cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
    cv::redirectError([](int, const char*, const char*, const char*, int, void*) { return 0; });
    return true;
  }();
}

cv::Mat Decode(ImageFormat format, const std::string& bytes) {
  SilenceOpenCvOnce();
  const cv::Mat encoded(1, static_cast<int>(bytes.size()), CV_8UC1,
                        const_cast<char*>(bytes.data()));  // cv::Mat knows no const data
  try {
    // libpng rounds luminance in another way than cvtColor, which the same pixels in a bag meet.
    if (format != ImageFormat::kPng) {
      return cv::imdecode(encoded, cv::IMREAD_GRAYSCALE | kAsStored);
    }
    cv::Mat image = cv::imdecode(encoded, cv::IMREAD_ANYCOLOR | kAsStored);
    if (image.channels() == 3) cv::cvtColor(image, image, cv::COLOR_BGR2GRAY);
    return image;
  } catch (const cv::Exception&) {
    return {};
  }
}

GreyImage Grey(const EncodedImage& encoded, const std::string& encoding, const std::string& where) {
  cv::Mat image = Decode(encoded.format, encoded.bytes);
  if (image.empty()) {
    throw InputError({"cannot read image", where, "the file is truncated or damaged",
                      "copy it again or leave it out with --images"});
  }
  const Resolution decoded{image.cols, image.rows};
  const bool has_known_samples = image.type() == CV_8UC1 || image.type() == CV_16UC1;
  if (decoded != encoded.resolution || !has_known_samples || !image.isContinuous()) {
    throw InputError({"cannot read image", where, "its pixels are not of 8 or 16 bits",
                      "convert it to a PNG of 8 bits"});
  }
  if (IsMosaic(encoding)) {
    const bool is_16_bit = image.depth() == CV_16U;
    return GreyOf(
        {RawPixels{decoded,
                   encoding.substr(0, encoding.find_first_of("18")) + (is_16_bit ? "16" : "8"),
                   std::endian::native == std::endian::big, image.step,
                   std::string(image.datastart, image.dataend)},
         where});
  }
  GreyImage grey{decoded, {}};
  if (image.depth() == CV_16U) {
    grey.pixels = ScaledTo8Bits(image.ptr<uint16_t>(), image.total());
  } else {
    grey.pixels.assign(image.data, image.data + image.total());
  }
  return grey;
}

std::string Encoded(const cv::Mat& pixels) {
  std::vector<uint8_t> bytes;
  if (!cv::imencode(".png", pixels, bytes, {cv::IMWRITE_PNG_COMPRESSION, 1})) {
    throw InputError({"cannot write an image", "", "OpenCV cannot encode PNG",
                      "install libopencv-imgcodecs with PNG"});
  }
  return {bytes.begin(), bytes.end()};
}

}  // namespace

GreyImage ReadPhoto(const std::string& path) { return Grey(ReadEncodedImage(path), "", path); }

GreyImage DecodePhoto(const EncodedFile& file, const std::string& where) {
  return Grey(ExamineEncodedImage(file.bytes, where), file.encoding, where);
}

std::string EncodePng(const GreyImage& image) {
  // OpenCV's header has no room for "will not be changed".
  return Encoded(cv::Mat(image.resolution.height, image.resolution.width, CV_8UC1,
                         const_cast<uint8_t*>(image.pixels.data())));  // NOLINT
}

std::string EncodePng(const RgbImage& image) {
  const cv::Mat rgb(image.resolution.height, image.resolution.width, CV_8UC3,
                    const_cast<uint8_t*>(image.pixels.data()));  // NOLINT
  cv::Mat bgr;
  cv::cvtColor(rgb, bgr, cv::COLOR_RGB2BGR);
  return Encoded(bgr);
}

std::string EncodeJpeg(const GreyImage& image) {
  constexpr int kQuality = 70;
  const cv::Mat grey(image.resolution.height, image.resolution.width, CV_8UC1,
                     const_cast<uint8_t*>(image.pixels.data()));  // NOLINT
  std::vector<uint8_t> bytes;
  if (!cv::imencode(".jpg", grey, bytes, {cv::IMWRITE_JPEG_QUALITY, kQuality})) {
    throw InputError({"cannot encode an image", "", "OpenCV cannot encode JPEG",
                      "install libopencv-imgcodecs with JPEG"});
  }
  return {bytes.begin(), bytes.end()};
}

}  // namespace calibrato
