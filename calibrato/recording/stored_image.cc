#include "calibrato/recording/stored_image.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <string_view>
#include <vector>

#include "calibrato/base/input_error.h"
#include "calibrato/recording/encoded_image.h"
#include "calibrato/recording/photo.h"
#include "calibrato/recording/pixel_scaling.h"

namespace calibrato {
namespace {

constexpr int kNoConversion = -1;

// What OpenCV has to be told of an encoding.
struct Encoding {
  std::string_view name;
  int type;     // of one pixel
  int to_grey;  // cv::cvtColor's code
  int to_png;   // the same to the order of a PNG in OpenCV: blue first
  bool is_mosaic = false;
};

// OpenCV names a mosaic by the second row's second and third pixel: its BayerBG begins with R G.
constexpr std::array<Encoding, 17> kEncodings = {{
    {"mono8", CV_8UC1, kNoConversion, kNoConversion},
    {"8UC1", CV_8UC1, kNoConversion, kNoConversion},
    {"mono16", CV_16UC1, kNoConversion, kNoConversion},
    {"16UC1", CV_16UC1, kNoConversion, kNoConversion},
    {"bgr8", CV_8UC3, cv::COLOR_BGR2GRAY, kNoConversion},
    {"8UC3", CV_8UC3, cv::COLOR_BGR2GRAY, kNoConversion},
    {"rgb8", CV_8UC3, cv::COLOR_RGB2GRAY, cv::COLOR_RGB2BGR},
    {"bgra8", CV_8UC4, cv::COLOR_BGRA2GRAY, kNoConversion},
    {"rgba8", CV_8UC4, cv::COLOR_RGBA2GRAY, cv::COLOR_RGBA2BGRA},
    {"bayer_rggb8", CV_8UC1, cv::COLOR_BayerBG2GRAY, kNoConversion, true},
    {"bayer_bggr8", CV_8UC1, cv::COLOR_BayerRG2GRAY, kNoConversion, true},
    {"bayer_gbrg8", CV_8UC1, cv::COLOR_BayerGR2GRAY, kNoConversion, true},
    {"bayer_grbg8", CV_8UC1, cv::COLOR_BayerGB2GRAY, kNoConversion, true},
    {"bayer_rggb16", CV_16UC1, cv::COLOR_BayerBG2GRAY, kNoConversion, true},
    {"bayer_bggr16", CV_16UC1, cv::COLOR_BayerRG2GRAY, kNoConversion, true},
    {"bayer_gbrg16", CV_16UC1, cv::COLOR_BayerGR2GRAY, kNoConversion, true},
    {"bayer_grbg16", CV_16UC1, cv::COLOR_BayerGB2GRAY, kNoConversion, true},
}};

std::optional<Encoding> FindEncoding(const std::string& name) {
  const auto* found = std::find_if(kEncodings.begin(), kEncodings.end(),
                                   [&](const Encoding& e) { return e.name == name; });
  return found == kEncodings.end() ? std::nullopt : std::optional(*found);
}

[[noreturn]] void Fail(const std::string& where, const std::string& why,
                       const std::string& remedy) {
  throw InputError({"cannot read image", where, why, remedy});
}

struct Samples {
  Encoding encoding;
  cv::Mat image;
};

// The pixels one row behind the other, in the machine's byte order.
Samples SamplesOf(const RawPixels& pixels, const std::string& where) {
  const std::optional<Encoding> encoding = FindEncoding(pixels.encoding);
  if (!encoding) {
    Fail(where, "its encoding is '" + pixels.encoding.substr(0, 40) + "'",
         "record mono8, mono16, rgb8, bgr8, rgba8, bgra8 or bayer_*, or compressed images");
  }
  const auto [width, height] = pixels.resolution;
  if (width <= 0 || height <= 0 || int64_t{width} * height > kMaxImagePixels) {
    Fail(where,
         "it claims " + std::to_string(width) + " x " + std::to_string(height) +
             " pixels, the limit is 100 megapixels",
         "record it again");
  }
  const size_t row_bytes = static_cast<size_t>(width) * CV_ELEM_SIZE(encoding->type);
  const auto num_rows = static_cast<size_t>(height);
  // The last row needs no filling behind it.
  if (pixels.row_bytes < row_bytes || pixels.bytes.size() < row_bytes ||
      (pixels.bytes.size() - row_bytes) / pixels.row_bytes + 1 < num_rows) {
    Fail(where,
         "it has " + std::to_string(pixels.bytes.size()) + " bytes in rows of " +
             std::to_string(pixels.row_bytes) + ", less than its " + std::to_string(width) + " x " +
             std::to_string(height) + " pixels of " + pixels.encoding + " need",
         "record it again");
  }
  Samples samples{*encoding, cv::Mat(height, width, encoding->type)};
  for (size_t v = 0; v < num_rows; ++v) {
    std::memcpy(samples.image.ptr(static_cast<int>(v)), &pixels.bytes[v * pixels.row_bytes],
                row_bytes);
  }
  const bool is_native = pixels.is_big_endian == (std::endian::native == std::endian::big);
  if (CV_MAT_DEPTH(encoding->type) == CV_16U && !is_native) {
    auto* words = samples.image.ptr<uint16_t>();
    std::transform(words, words + samples.image.total(), words,
                   [](uint16_t word) { return static_cast<uint16_t>(word << 8 | word >> 8); });
  }
  return samples;
}

GreyImage GreyOfPixels(const RawPixels& pixels, const std::string& where) {
  Samples samples = SamplesOf(pixels, where);
  cv::Mat& image = samples.image;
  if (samples.encoding.is_mosaic && (image.cols < 3 || image.rows < 3)) {
    Fail(where, "a mosaic of colours has 3 x 3 pixels at least", "record it again");
  }
  if (samples.encoding.to_grey != kNoConversion) {
    cv::Mat grey;
    cv::cvtColor(image, grey, samples.encoding.to_grey);
    image = grey;
  }
  GreyImage grey{pixels.resolution, {}};
  if (image.depth() == CV_16U) {
    grey.pixels = ScaledTo8Bits(image.ptr<uint16_t>(), image.total());
  } else {
    grey.pixels.assign(image.data, image.data + image.total());
  }
  return grey;
}

}  // namespace

GreyImage GreyOf(const StoredImage& image) {
  if (const auto* file = std::get_if<EncodedFile>(&image.content)) {
    return DecodePhoto(*file, image.where);
  }
  return GreyOfPixels(std::get<RawPixels>(image.content), image.where);
}

std::string PngOf(const RawPixels& pixels, const std::string& where) {
  Samples samples = SamplesOf(pixels, where);
  if (samples.encoding.to_png != kNoConversion) {
    cv::Mat reordered;
    cv::cvtColor(samples.image, reordered, samples.encoding.to_png);
    samples.image = reordered;
  }
  std::vector<uint8_t> png;
  cv::imencode(".png", samples.image, png);
  return {png.begin(), png.end()};
}

bool IsMosaic(const std::string& encoding) {
  const std::optional<Encoding> found = FindEncoding(encoding);
  return found && found->is_mosaic;
}

}  // namespace calibrato
