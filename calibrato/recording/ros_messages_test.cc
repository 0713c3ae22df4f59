#include "calibrato/recording/ros_messages.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrato/recording/bag_for_test.h"
#include "calibrato/recording/byte_fields.h"

namespace calibrato {
namespace {

using testing::HasSubstr;
using namespace std::string_literals;

constexpr Time kStamp = Time::FromNanoseconds(1'600'000'000'123'456'789);
constexpr MessageEncoding kBoth[] = {MessageEncoding::kRos1, MessageEncoding::kCdr};

// 1600000000 s, 123456789 ns as in a CDR of either byte order, the frame "cam", and what fills up.
const std::string kCdrLittle = "\0\1\0\0"s + U32(1600000000) + U32(123456789) + U32(4) + "cam\0"s;
const std::string kCdrBig = "\0\0\0\0\x5f\x5e\x10\x00\x07\x5b\xcd\x15\0\0\0\4cam\0"s;

TEST(ReadImageMessage, ReadsRos1) {
  const ImageMessage image = ReadImageMessage(
      MessageEncoding::kRos1,
      Ros1Image(kStamp.nanoseconds(), 2, 3, "mono8", 4, std::string("\1\2\3\0\4\5\6\0", 8)));
  EXPECT_EQ(image.stamp, kStamp);
  EXPECT_EQ(image.frame_id, "f");
  EXPECT_EQ(image.pixels.resolution, (Resolution{3, 2}));
  EXPECT_EQ(image.pixels.encoding, "mono8");
  EXPECT_FALSE(image.pixels.is_big_endian);
  EXPECT_EQ(image.pixels.row_bytes, 4U);
  EXPECT_EQ(image.pixels.bytes, "\1\2\3\0\4\5\6\0"s);
}

TEST(ReadImageMessage, ReadsCdrWithItsFillings) {
  // "mono16" and its zero end at byte 7 of a word, so is_bigendian needs no filling, step three.
  const ImageMessage image =
      ReadImageMessage(MessageEncoding::kCdr, kCdrLittle + U32(2) + U32(1) + U32(7) + "mono16\0"s +
                                                  U8(1) + U32(2) + U32(4) + "abcd");
  EXPECT_EQ(image.stamp, kStamp);
  EXPECT_EQ(image.frame_id, "cam");
  EXPECT_EQ(image.pixels.resolution, (Resolution{1, 2}));
  EXPECT_EQ(image.pixels.encoding, "mono16");
  EXPECT_TRUE(image.pixels.is_big_endian);
  EXPECT_EQ(image.pixels.row_bytes, 2U);
  EXPECT_EQ(image.pixels.bytes, "abcd");
  const ImageMessage filled =
      ReadImageMessage(MessageEncoding::kCdr, kCdrLittle + U32(2) + U32(1) + U32(6) + "mono8\0"s +
                                                  U8(0) + "?"s + U32(2) + U32(4) + "abcd");
  EXPECT_EQ(filled.pixels.row_bytes, 2U);
}

TEST(StampOfMessage, ReadsCdrOfEitherByteOrder) {
  EXPECT_EQ(StampOfMessage(MessageEncoding::kCdr, kCdrLittle), kStamp);
  EXPECT_EQ(StampOfMessage(MessageEncoding::kCdr, kCdrBig), kStamp);
}

TEST(StampOfMessage, ReachesBeyondTheYear2038InRos1) {
  EXPECT_EQ(StampOfMessage(MessageEncoding::kRos1, U32(0) + U32(4'000'000'000) + U32(5)),
            Time::FromNanoseconds(4'000'000'000'000'000'005));
  EXPECT_THROW(static_cast<void>(StampOfMessage(MessageEncoding::kCdr,
                                                "\0\1\0\0"s + U32(4'000'000'000) + U32(5))),
               Damage);
}

TEST(ReadImuMessage, ReadsRos1AndCdr) {
  const ImuMessage ros1 =
      ReadImuMessage(MessageEncoding::kRos1, Ros1Imu(kStamp.nanoseconds(), {1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(ros1.stamp, kStamp);
  EXPECT_EQ(ros1.gyro, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(ros1.accel, Eigen::Vector3d(4, 5, 6));
  // Behind 16 bytes of header the doubles need no filling.
  std::string cdr = kCdrLittle + std::string(13 * 8, '\0') + F64(1) + F64(2) + F64(3) +
                    std::string(9 * 8, '\0') + F64(4) + F64(5) + F64(6) + F64(-1) +
                    std::string(8 * 8, '\0');
  const ImuMessage read = ReadImuMessage(MessageEncoding::kCdr, cdr);
  EXPECT_EQ(read.gyro, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(read.accel, std::nullopt);  // Its covariance begins with -1.
}

TEST(ReadCompressedImageMessage, KeepsTheEncodingOfMosaicsOnly) {
  const auto encoding_of = [](const std::string& format) {
    return ReadCompressedImageMessage(MessageEncoding::kRos1, Ros1CompressedImage(5, format, "x"))
        .file.encoding;
  };
  EXPECT_EQ(encoding_of("bayer_grbg8; png compressed "), "bayer_grbg8");
  EXPECT_EQ(encoding_of("bgr8; jpeg compressed bgr8"), "");
  EXPECT_EQ(encoding_of("jpeg"), "");
}

TEST(RosMessages, AreReadBackAsWritten) {
  for (const MessageEncoding encoding : kBoth) {
    const ImageMessage image{
        kStamp, "camera", {{3, 1}, "bayer_rggb16", true, 6, std::string("\0\1\2\3\4\5", 6)}};
    const ImageMessage image_read =
        ReadImageMessage(encoding, ImageMessageBytes(encoding, image, 9));
    EXPECT_EQ(image_read.stamp, kStamp);
    EXPECT_EQ(image_read.frame_id, "camera");
    EXPECT_EQ(image_read.pixels.resolution, image.pixels.resolution);
    EXPECT_EQ(image_read.pixels.encoding, image.pixels.encoding);
    EXPECT_TRUE(image_read.pixels.is_big_endian);
    EXPECT_EQ(image_read.pixels.row_bytes, 6U);
    EXPECT_EQ(image_read.pixels.bytes, image.pixels.bytes);

    const CompressedImageMessage file{kStamp, "", {"\x89PNG\r\n\x1a\n...", "bayer_gbrg8"}};
    const CompressedImageMessage file_read =
        ReadCompressedImageMessage(encoding, CompressedImageMessageBytes(encoding, file, 0));
    EXPECT_EQ(file_read.file.bytes, file.file.bytes);
    EXPECT_EQ(file_read.file.encoding, "bayer_gbrg8");

    const ImuMessage imu{kStamp, "imu", Eigen::Vector3d(0.1, -2e-9, 3e300), std::nullopt};
    const ImuMessage imu_read = ReadImuMessage(encoding, ImuMessageBytes(encoding, imu, 1));
    EXPECT_EQ(imu_read.stamp, kStamp);
    EXPECT_EQ(imu_read.gyro, imu.gyro);
    EXPECT_EQ(imu_read.accel, std::nullopt);
  }
}

TEST(RosMessages, AreWrittenByteForByteAsRos1Has) {
  EXPECT_EQ(ImuMessageBytes(MessageEncoding::kRos1,
                            {kStamp, "f", Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(4, 5, 6)}, 7)
                .size(),
            Ros1Imu(kStamp.nanoseconds(), {1, 2, 3, 4, 5, 6}).size());
  EXPECT_EQ(ImageMessageBytes(MessageEncoding::kRos1,
                              {kStamp, "f", {{2, 1}, "mono8", false, 2, "ab"}}, 7),
            Ros1Image(kStamp.nanoseconds(), 1, 2, "mono8", 2, "ab"));
}

TEST(RosMessages, ThatEndAnywhereAreRefused) {
  for (const MessageEncoding encoding : kBoth) {
    const std::string image =
        ImageMessageBytes(encoding, {kStamp, "f", {{2, 1}, "mono8", false, 2, "ab"}}, 7);
    const std::string imu = ImuMessageBytes(
        encoding, {kStamp, "f", Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(4, 5, 6)}, 7);
    for (size_t size = 0; size < image.size(); ++size) {
      EXPECT_THROW(static_cast<void>(ReadImageMessage(encoding, image.substr(0, size))), Damage)
          << size;
    }
    for (size_t size = 0; size < imu.size(); ++size) {
      EXPECT_THROW(static_cast<void>(ReadImuMessage(encoding, imu.substr(0, size))), Damage)
          << size;
    }
  }
  EXPECT_THROW(static_cast<void>(ReadImageMessage(MessageEncoding::kRos1,
                                                  Ros1Image(5, 1, 1u << 31, "mono8", 1, ""))),
               Damage);
  EXPECT_THROW(
      static_cast<void>(StampOfMessage(MessageEncoding::kCdr, "\0\7\0\0"s + U64(0) + U64(0))),
      Damage);
}

}  // namespace
}  // namespace calibrato
