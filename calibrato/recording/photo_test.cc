#include "calibrato/recording/photo.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "calibrato/base/input_error.h"
#include "calibrato/base/rng.h"
#include "calibrato/recording/test_folder.h"

namespace calibrato {
namespace {

using ::testing::AllOf;
using ::testing::AnyOf;
using ::testing::HasSubstr;

constexpr int kWidth = 97;
constexpr int kHeight = 61;

// Noise over a slope: nothing that a codec could pack into its first bytes.
cv::Mat Picture() {
  cv::Mat picture(kHeight, kWidth, CV_8UC1);
  Rng rng(1);
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) {
      picture.at<uint8_t>(v, u) = static_cast<uint8_t>(u + v + rng.UniformIndex(60));
    }
  }
  return picture;
}

std::string Encoded(const cv::Mat& picture, const std::string& extension,
                    const std::vector<int>& parameters = {}) {
  std::vector<uint8_t> bytes;
  cv::imencode(extension, picture, bytes, parameters);
  return {bytes.begin(), bytes.end()};
}

std::vector<uint8_t> PixelsOf(const cv::Mat& picture) {
  return {picture.data, picture.data + picture.total()};
}

class PhotoTest : public testing::Test {
 protected:
  GreyImage Read(const std::string& bytes) const {
    return ReadPhoto(folder_.Write("photo", bytes));
  }
  std::string ErrorOf(const std::string& bytes) const {
    try {
      static_cast<void>(Read(bytes));
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }

  TestFolder folder_;
};

TEST_F(PhotoTest, GivesThePixelsOfLosslessFormatsAsTheyAre) {
  const cv::Mat picture = Picture();
  for (const std::string extension : {".png", ".bmp", ".tiff", ".pgm"}) {
    const GreyImage image = Read(Encoded(picture, extension));
    EXPECT_EQ(image.resolution, (Resolution{kWidth, kHeight})) << extension;
    EXPECT_EQ(image.pixels, PixelsOf(picture)) << extension;
  }
  EXPECT_EQ(Read(Encoded(picture, ".pgm", {cv::IMWRITE_PXM_BINARY, 0})).pixels, PixelsOf(picture));
}

TEST_F(PhotoTest, TurnsColourIntoLuminance) {
  // ITU-R BT.601: 0.299 R + 0.587 G + 0.114 B, here of (blue, green, red) = (200, 100, 50).
  const cv::Mat picture(kHeight, kWidth, CV_8UC3, cv::Scalar(200, 100, 50));
  for (const std::string extension : {".png", ".jpg", ".bmp", ".tiff"}) {
    EXPECT_NEAR(Read(Encoded(picture, extension)).pixels.at(1234), 96.45, 1.5) << extension;
  }
}

TEST_F(PhotoTest, ScalesSixteenBitsWithoutClipping) {
  cv::Mat picture(1, 3, CV_16UC1);
  for (const std::string extension : {".png", ".tiff", ".pgm"}) {
    picture.at<uint16_t>(0) = 0;
    picture.at<uint16_t>(1) = 32'896;
    picture.at<uint16_t>(2) = 65'535;
    EXPECT_THAT(Read(Encoded(picture, extension)).pixels, testing::ElementsAre(0, 128, 255));
    // Twelve bits in a file of sixteen: 2056 of 4095 is 128 of 255.
    picture.at<uint16_t>(1) = 2056;
    picture.at<uint16_t>(2) = 4095;
    EXPECT_THAT(Read(Encoded(picture, extension)).pixels, testing::ElementsAre(0, 128, 255));
  }
}

TEST_F(PhotoTest, IgnoresTransparency) {
  cv::Mat picture(kHeight, kWidth, CV_8UC4, cv::Scalar(200, 100, 50, 0));
  EXPECT_NEAR(Read(Encoded(picture, ".png")).pixels.at(1234), 96.45, 1.5);
}

TEST_F(PhotoTest, GoesByWhatAFileIsNotByItsName) {
  const std::string path = folder_.Write("photo.jpg", Encoded(Picture(), ".png"));
  EXPECT_EQ(ReadPhoto(path).pixels, PixelsOf(Picture()));
}

TEST_F(PhotoTest, ReadsImagesTwentyThousandPixelsWide) {
  const cv::Mat picture(40, 20'000, CV_8UC1, cv::Scalar(77));
  const GreyImage image = Read(Encoded(picture, ".png"));
  EXPECT_EQ(image.resolution, (Resolution{20'000, 40}));
  EXPECT_EQ(image.pixels.back(), 77);
}

TEST_F(PhotoTest, ReadsTheFirstOfSeveralPages) {
  const cv::Mat other(kHeight, kWidth, CV_8UC1, cv::Scalar(9));
  const std::string path = folder_.path() + "/pages.tiff";
  ASSERT_TRUE(cv::imwritemulti(path, std::vector<cv::Mat>{Picture(), other}));
  EXPECT_EQ(ReadPhoto(path).pixels, PixelsOf(Picture()));
}

TEST_F(PhotoTest, RefusesAGif) {
  EXPECT_THAT(ErrorOf("GIF89a and some frames"), HasSubstr("give PNG, JPEG, BMP, TIFF or PGM"));
}

TEST_F(PhotoTest, IgnoresTheOrientationNoted) {
  // A JPEG whose EXIF asks to be turned by a quarter (orientation 6).
  using namespace std::string_literals;
  const std::string exif = "\xff\xe1\x00\x22"s + "Exif\0\0"s + "MM\0*\0\0\0\x8"s + "\0\x1"s +
                           "\x01\x12\0\x3\0\0\0\x1\0\x6\0\0"s + "\0\0\0\0"s;
  const std::string jpeg = Encoded(Picture(), ".jpg");
  EXPECT_EQ(Read(jpeg.substr(0, 2) + exif + jpeg.substr(2)).resolution,
            (Resolution{kWidth, kHeight}));
}

TEST_F(PhotoTest, RefusesATruncatedImageWhereverItEnds) {
  const cv::Mat picture = Picture();
  const std::vector<std::pair<std::string, std::vector<int>>> formats = {
      {".png", {}},
      {".jpg", {}},
      {".jpg", {cv::IMWRITE_JPEG_PROGRESSIVE, 1}},
      {".jpg", {cv::IMWRITE_JPEG_RST_INTERVAL, 2}},
      {".bmp", {}},
      {".tiff", {}},
      {".tiff", {cv::IMWRITE_TIFF_COMPRESSION, 1}},
      {".pgm", {}},
      {".pgm", {cv::IMWRITE_PXM_BINARY, 0}}};
  for (const auto& [extension, parameters] : formats) {
    const std::string whole = Encoded(picture, extension, parameters);
    ASSERT_EQ(ErrorOf(whole), "no error") << extension;
    std::vector<size_t> sizes = {whole.size() - 1, whole.size() - 2, whole.size() - 5};
    for (size_t k = 1; k < 40; ++k) sizes.push_back(k * whole.size() / 40);
    for (const size_t size : sizes) {
      testing::internal::CaptureStderr();
      const std::string error = ErrorOf(whole.substr(0, size));
      EXPECT_THAT(error, AllOf(HasSubstr("photo"),
                               AnyOf(HasSubstr("truncated"), HasSubstr("no image size"))))
          << extension << " " << size << " of " << whole.size();
      EXPECT_EQ(testing::internal::GetCapturedStderr(), "") << extension << " " << size;
    }
  }
}

TEST_F(PhotoTest, RefusesAJpegThatEndsInZeros) {
  // As a disk leaves it that lost power.
  std::string bytes = Encoded(Picture(), ".jpg");
  std::fill(bytes.begin() + static_cast<std::ptrdiff_t>(bytes.size() / 2), bytes.end(), '\0');
  EXPECT_THAT(ErrorOf(bytes), HasSubstr("truncated"));
}

TEST_F(PhotoTest, RefusesSamplesThatAreNoIntensities) {
  const cv::Mat picture(kHeight, kWidth, CV_32FC1, cv::Scalar(0.5));
  EXPECT_THAT(ErrorOf(Encoded(picture, ".tiff")), HasSubstr("not of 8 or 16 bits"));
}

TEST_F(PhotoTest, SaysWhyAFileCannotBeRead) {
  const auto error_at = [](const std::string& path) -> std::string {
    try {
      static_cast<void>(ReadPhoto(path));
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_THAT(error_at(folder_.path() + "/absent.png"),
              AllOf(HasSubstr("absent.png"), HasSubstr("no such file")));
  EXPECT_THAT(error_at(folder_.path()), HasSubstr("it is a folder"));
  EXPECT_THAT(ErrorOf(""), HasSubstr("empty"));
}

TEST(EncodePng, ReadsBackBitByBit) {
  GreyImage image{{kWidth, kHeight}, {}};
  Rng rng(2);
  for (int k = 0; k < kWidth * kHeight; ++k) {
    image.pixels.push_back(static_cast<uint8_t>(rng.UniformIndex(256)));
  }
  const GreyImage again = DecodePhoto({EncodePng(image), ""}, "test");
  EXPECT_EQ(again.resolution, image.resolution);
  EXPECT_EQ(again.pixels, image.pixels);
}

}  // namespace
}  // namespace calibrato
