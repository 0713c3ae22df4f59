#include "calibrato/recording/stored_image.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "calibrato/base/input_error_testing.h"

namespace calibrato {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

// Bytes from their values, written as they would stand in a file.
std::string Bytes(const std::vector<int>& values) {
  std::string bytes;
  for (const int value : values) bytes += static_cast<char>(value);
  return bytes;
}

RawPixels Pixels(Resolution resolution, const std::string& encoding, size_t row_bytes,
                 std::string bytes) {
  return {resolution, encoding, false, row_bytes, std::move(bytes)};
}

std::vector<uint8_t> GreyPixels(const RawPixels& pixels) { return GreyOf({pixels, "here"}).pixels; }

std::string ErrorOf(const RawPixels& pixels) {
  return InputErrorOf([&] { static_cast<void>(GreyPixels(pixels)); });
}

TEST(GreyOf, LeavesOutWhatFillsTheRows) {
  // Rows of 5 bytes for 3 pixels; behind the last row nothing has to follow.
  const RawPixels pixels = Pixels({3, 2}, "mono8", 5, Bytes({1, 2, 3, 99, 99, 4, 5, 6}));
  EXPECT_THAT(GreyPixels(pixels), ElementsAre(1, 2, 3, 4, 5, 6));
  EXPECT_EQ(GreyOf({pixels, ""}).resolution, (Resolution{3, 2}));
}

TEST(GreyOf, WeighsColoursInEveryOrder) {
  // 0.299 * 200 + 0.587 * 100 + 0.114 * 50 = 124.2.
  EXPECT_THAT(GreyPixels(Pixels({1, 1}, "rgb8", 3, Bytes({200, 100, 50}))), ElementsAre(124));
  EXPECT_THAT(GreyPixels(Pixels({1, 1}, "bgr8", 3, Bytes({50, 100, 200}))), ElementsAre(124));
  EXPECT_THAT(GreyPixels(Pixels({1, 1}, "8UC3", 3, Bytes({50, 100, 200}))), ElementsAre(124));
  EXPECT_THAT(GreyPixels(Pixels({1, 1}, "rgba8", 4, Bytes({200, 100, 50, 7}))), ElementsAre(124));
  EXPECT_THAT(GreyPixels(Pixels({1, 1}, "bgra8", 4, Bytes({50, 100, 200, 7}))), ElementsAre(124));
}

// A uniform red, green and blue of (200, 100, 50), seen through the filters whose first two rows
// begin with these letters.
std::string Mosaic(const std::string& letters, int side) {
  std::string bytes;
  for (int v = 0; v < side; ++v) {
    for (int u = 0; u < side; ++u) {
      const char letter = letters[static_cast<size_t>(2 * (v % 2) + u % 2)];
      bytes += static_cast<char>(letter == 'r' ? 200 : letter == 'g' ? 100 : 50);
    }
  }
  return bytes;
}

TEST(GreyOf, InterpolatesEveryMosaicToTheLuminanceOfItsColours) {
  for (const std::string letters : {"rggb", "bggr", "gbrg", "grbg"}) {
    const auto grey = GreyPixels(Pixels({8, 8}, "bayer_" + letters + "8", 8, Mosaic(letters, 8)));
    ASSERT_EQ(grey.size(), 64U);
    for (const uint8_t value : grey) EXPECT_NEAR(value, 124.2, 1.0) << letters;
  }
}

TEST(GreyOf, ReadsAMosaicInAnImageFileAsOne) {
  const std::string mosaic = Mosaic("gbrg", 8);
  const RawPixels raw = Pixels({8, 8}, "bayer_gbrg8", 8, mosaic);
  const GreyImage grey = GreyOf({EncodedFile{PngOf(raw, "here"), "bayer_gbrg8"}, "there"});
  EXPECT_EQ(grey.pixels, GreyPixels(raw));
  // Without its encoding, the same file is grey as it stands.
  EXPECT_EQ(GreyOf({EncodedFile{PngOf(raw, "here"), ""}, "there"}).pixels,
            std::vector<uint8_t>(mosaic.begin(), mosaic.end()));
}

TEST(GreyOf, ScalesSixteenBitsOfEitherByteOrder) {
  // 1023 needs 10 bits, so it becomes 255, and 512 becomes 512 * 255 / 1023 = 127.6.
  RawPixels pixels = Pixels({3, 1}, "mono16", 6, Bytes({0xff, 0x03, 0x00, 0x02, 0, 0}));
  EXPECT_THAT(GreyPixels(pixels), ElementsAre(255, 128, 0));
  pixels.bytes = Bytes({0x03, 0xff, 0x02, 0x00, 0, 0});
  pixels.is_big_endian = true;
  EXPECT_THAT(GreyPixels(pixels), ElementsAre(255, 128, 0));
}

TEST(GreyOf, RefusesSizesAndEncodingsThatCannotBe) {
  EXPECT_THAT(ErrorOf(Pixels({4, 4}, "yuv422", 8, std::string(32, 'x'))),
              AllOf(HasSubstr("here"), HasSubstr("yuv422")));
  EXPECT_THAT(ErrorOf(Pixels({4, 4}, "mono8", 4, std::string(15, 'x'))), HasSubstr("15 bytes"));
  EXPECT_THAT(ErrorOf(Pixels({4, 4}, "mono8", 3, std::string(99, 'x'))), HasSubstr("rows of 3"));
  EXPECT_THAT(ErrorOf(Pixels({4, 4}, "mono8", 0, "")), HasSubstr("0 bytes"));
  EXPECT_THAT(ErrorOf(Pixels({4, 0}, "mono8", 4, "")), HasSubstr("4 x 0"));
  EXPECT_THAT(ErrorOf(Pixels({-1, 4}, "mono8", 4, "")), HasSubstr("-1 x 4"));
  EXPECT_THAT(ErrorOf(Pixels({1 << 30, 1 << 30}, "mono8", size_t{1} << 62, "x")),
              HasSubstr("100 megapixels"));
  EXPECT_THAT(ErrorOf(Pixels({2, 2}, "bayer_rggb8", 2, "abcd")), HasSubstr("3 x 3"));
}

cv::Mat Decoded(const std::string& png) {
  return cv::imdecode(std::vector<uint8_t>(png.begin(), png.end()), cv::IMREAD_UNCHANGED);
}

TEST(PngOf, KeepsEverySample) {
  const cv::Mat colour = Decoded(PngOf(Pixels({1, 2}, "rgb8", 3, Bytes({1, 2, 3, 4, 5, 6})), ""));
  ASSERT_EQ(colour.type(), CV_8UC3);  // OpenCV has blue first.
  EXPECT_EQ(colour.at<cv::Vec3b>(1, 0), cv::Vec3b(6, 5, 4));
  const cv::Mat deep = Decoded(PngOf(Pixels({1, 1}, "mono16", 2, Bytes({0x34, 0x12})), ""));
  ASSERT_EQ(deep.type(), CV_16UC1);
  EXPECT_EQ(deep.at<uint16_t>(0, 0), 0x1234);
  const cv::Mat clear = Decoded(PngOf(Pixels({1, 1}, "rgba8", 4, Bytes({1, 2, 3, 4})), ""));
  EXPECT_EQ(clear.at<cv::Vec4b>(0, 0), cv::Vec4b(3, 2, 1, 4));
}

TEST(GreyOf, IsTheSameOfColoursRawAndPacked) {
  std::string bytes;
  for (int k = 0; k < 3 * 64; ++k) bytes += static_cast<char>(k * 37 + k / 5);
  const RawPixels raw = Pixels({8, 8}, "rgb8", 24, bytes);
  EXPECT_EQ(GreyOf({EncodedFile{PngOf(raw, ""), ""}, ""}).pixels, GreyPixels(raw));
}

}  // namespace
}  // namespace calibrato
