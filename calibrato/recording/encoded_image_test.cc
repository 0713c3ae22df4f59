#include "calibrato/recording/encoded_image.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include "calibrato/base/input_error.h"
#include "calibrato/recording/test_folder.h"

namespace calibrato {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::string BigEndian(uint32_t value, int count = 4) {
  std::string bytes;
  for (int i = count - 1; i >= 0; --i) bytes += static_cast<char>(value >> (8 * i) & 0xff);
  return bytes;
}

std::string LittleEndian(uint32_t value, int count = 4) {
  const std::string bytes = BigEndian(value, count);
  return {bytes.rbegin(), bytes.rend()};
}

std::string PngChunk(const std::string& type, const std::string& content) {
  const std::string checked = type + content;
  const auto checksum = crc32_z(0, reinterpret_cast<const Bytef*>(checked.data()), checked.size());
  return BigEndian(static_cast<uint32_t>(content.size())) + checked +
         BigEndian(static_cast<uint32_t>(checksum));
}

const std::string kPngSignature = "\x89PNG\r\n\x1a\n";

std::string PngHeader(uint32_t width, uint32_t height) {
  return PngChunk("IHDR", BigEndian(width) + BigEndian(height) + std::string("\x8\0\0\0\0", 5));
}

std::string JpegSegment(const std::string& marker, const std::string& content) {
  return "\xff" + marker + BigEndian(static_cast<uint32_t>(content.size() + 2), 2) + content;
}

std::string JpegFrameHeader(uint32_t width, uint32_t height) {
  return JpegSegment("\xc0", "\x8" + BigEndian(height, 2) + BigEndian(width, 2) + "\x1");
}

class EncodedImageTest : public testing::Test {
 protected:
  EncodedImage Read(const std::string& bytes) const {
    return ReadEncodedImage(folder_.Write("image", bytes));
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

TEST_F(EncodedImageTest, KeepsOfAPngOnlyWhatTheImageNeeds) {
  const std::string needed_begin = kPngSignature + PngHeader(640, 480);
  const std::string needed_end = PngChunk("IDAT", "pixels") + PngChunk("IEND", "");
  const EncodedImage image =
      Read(needed_begin + PngChunk("iCCP", "a faulty profile") + needed_end + "trailing bytes");
  EXPECT_EQ(image.format, ImageFormat::kPng);
  EXPECT_EQ(image.resolution, (Resolution{640, 480}));
  EXPECT_EQ(image.bytes, needed_begin + needed_end);
}

TEST_F(EncodedImageTest, RefusesAPngWhoseChecksumsOrPartsAreWrong) {
  std::string pixels = PngChunk("IDAT", "pixels");
  pixels[9] ^= 1;
  const std::string end = PngChunk("IEND", "");
  EXPECT_THAT(ErrorOf(kPngSignature + PngHeader(64, 48) + pixels + end), HasSubstr("checksum"));
  EXPECT_THAT(ErrorOf(kPngSignature + PngHeader(64, 48) + end), HasSubstr("no pixels"));
  EXPECT_THAT(ErrorOf(kPngSignature + end), HasSubstr("does not begin with a header"));
}

TEST_F(EncodedImageTest, TakesTheFirstPictureOfAnAnimatedPng) {
  // Animation lies in ancillary parts (acTL, fcTL, fdAT) around the picture that all programs show.
  const std::string plain =
      kPngSignature + PngHeader(640, 480) + PngChunk("IDAT", "pixels") + PngChunk("IEND", "");
  const std::string animated =
      kPngSignature + PngHeader(640, 480) + PngChunk("acTL", std::string(8, '\1')) +
      PngChunk("fcTL", std::string(26, '\0')) + PngChunk("IDAT", "pixels") +
      PngChunk("fcTL", std::string(26, '\0')) + PngChunk("fdAT", "0000other pixels") +
      PngChunk("IEND", "");
  EXPECT_EQ(Read(animated).bytes, plain);
}

TEST_F(EncodedImageTest, RefusesAJpegOfInks) {
  const std::string four_components =
      JpegSegment("\xc0", "\x8" + BigEndian(480, 2) + BigEndian(640, 2) + "\x4");
  EXPECT_THAT(ErrorOf("\xff\xd8" + four_components),
              AllOf(HasSubstr("4 colour components"), HasSubstr("convert it to grey")));
}

TEST_F(EncodedImageTest, LooksForTheEndOfAJpegBehindItsScanNotInItsThumbnail) {
  const std::string start = "\xff\xd8";
  const std::string end = "\xff\xd9";
  const std::string thumbnail =
      JpegSegment("\xe1", start + JpegFrameHeader(16, 12) + "thumbnail" + end);
  // FF 00 is a pixel's byte, FF D3 a restart, FF FF D9 an end behind a fill byte.
  const std::string scan =
      JpegSegment("\xda", "how") + "pixels\xff" + std::string(1, '\0') + "\xff\xd3more\xff";
  const std::string head = start + thumbnail + JpegFrameHeader(640, 480) + scan;
  const EncodedImage image = Read(head + end + "trailing bytes");
  EXPECT_EQ(image.format, ImageFormat::kJpeg);
  EXPECT_EQ(image.resolution, (Resolution{640, 480}));
  EXPECT_EQ(image.bytes, head + end);
  for (size_t size = 3; size < head.size() + 2; ++size) {
    EXPECT_THAT(ErrorOf((head + end).substr(0, size)), HasSubstr("truncated")) << size;
  }
}

std::string BmpHeader(uint32_t width, uint32_t height) {
  return "BM" + LittleEndian(0) + LittleEndian(0) + LittleEndian(54) + LittleEndian(40) +
         LittleEndian(width) + LittleEndian(height) + LittleEndian(1, 2) + LittleEndian(8, 2) +
         std::string(24, '\0');
}

// A big-endian TIFF of 6 x 4 pixels in two strips, whose list of offsets follows the directory.
std::string Tiff() {
  const auto entry = [](uint32_t tag, uint32_t type, uint32_t count, const std::string& value) {
    return BigEndian(tag, 2) + BigEndian(type, 2) + BigEndian(count) + value;
  };
  const std::string directory =
      BigEndian(4, 2) + entry(256, 3, 1, BigEndian(6, 2) + BigEndian(0, 2)) +
      entry(257, 4, 1, BigEndian(4)) + entry(273, 4, 2, BigEndian(62)) +
      entry(279, 3, 2, BigEndian(12, 2) + BigEndian(12, 2)) + BigEndian(0);
  return std::string("MM\0*", 4) + BigEndian(8) + directory + BigEndian(70) + BigEndian(82) +
         std::string(24, 'p');
}

TEST_F(EncodedImageTest, ReadsTheSizeFromTheHeadersOfTheOthers) {
  // Rows of 6 bytes are filled up to 8; a negative height turns the image over.
  EXPECT_EQ(Read(BmpHeader(6, static_cast<uint32_t>(-4)) + std::string(32, 'p')).resolution,
            (Resolution{6, 4}));
  const std::string os2 = "BM" + std::string(8, '\0') + LittleEndian(26) + LittleEndian(12) +
                          LittleEndian(6, 2) + LittleEndian(4, 2) + LittleEndian(1, 2) +
                          LittleEndian(8, 2);
  EXPECT_EQ(Read(os2 + std::string(32, 'p')).resolution, (Resolution{6, 4}));
  EXPECT_EQ(Read("P5 # by hand\n#2 2\n6\t4\n255\n" + std::string(24, 'p')).resolution,
            (Resolution{6, 4}));
  EXPECT_EQ(Read(Tiff()).resolution, (Resolution{6, 4}));
}

TEST_F(EncodedImageTest, MissesThePixelsThatTheHeaderAnnounces) {
  EXPECT_THAT(ErrorOf(BmpHeader(6, 4) + std::string(31, 'p')), HasSubstr("truncated"));
  EXPECT_THAT(ErrorOf("P5 6 4 255\n" + std::string(23, 'p')), HasSubstr("truncated"));
  EXPECT_THAT(ErrorOf("P5 6 4 256\n" + std::string(47, 'p')), HasSubstr("truncated"));
  EXPECT_THAT(ErrorOf("P2 2 2 255\n1 2 3\n"), HasSubstr("truncated"));
  EXPECT_THAT(ErrorOf("P2 2 2 255\n1 two 3 4\n"), HasSubstr("a number is missing"));
  const std::string tiff = Tiff();
  for (size_t size = 4; size < tiff.size(); ++size) {
    EXPECT_THAT(ErrorOf(tiff.substr(0, size)), HasSubstr("truncated")) << size;
  }
}

TEST_F(EncodedImageTest, RefusesMoreThanAHundredMegapixelsByTheHeaderAlone) {
  const std::string png_end = PngChunk("IDAT", "pixels") + PngChunk("IEND", "");
  EXPECT_THAT(ErrorOf(kPngSignature + PngHeader(20'000, 5'001) + png_end),
              AllOf(HasSubstr("20000 x 5001"), HasSubstr("100 megapixels")));
  EXPECT_EQ(Read(kPngSignature + PngHeader(20'000, 5'000) + png_end).resolution,
            (Resolution{20'000, 5'000}));
  EXPECT_THAT(ErrorOf(kPngSignature + PngHeader(0xffffffff, 0xffffffff) + png_end),
              HasSubstr("100 megapixels"));
  EXPECT_THAT(ErrorOf("\xff\xd8" + JpegFrameHeader(65'535, 65'535)), HasSubstr("100 megapixels"));
  EXPECT_THAT(ErrorOf("P5 99999999999999999999 99999999999999999999 255\n"),
              HasSubstr("100 megapixels"));
  EXPECT_THAT(ErrorOf(BmpHeader(0x7fffffff, 0x80000000)), HasSubstr("100 megapixels"));
}

TEST_F(EncodedImageTest, SaysWhatIsWrongWithWhatIsNoImage) {
  EXPECT_THAT(ErrorOf(""), HasSubstr("the file is empty"));
  EXPECT_THAT(ErrorOf("a letter"), HasSubstr("not an image that calibrato reads"));
  EXPECT_THAT(ErrorOf("P5 0 480 255\n"), HasSubstr("no image size"));
  EXPECT_THAT(ErrorOf("\xff\xd8\xff\xd9"), HasSubstr("no image size"));
}

}  // namespace
}  // namespace calibrato
