#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include "calibrato/base/input_error_testing.h"
#include "calibrato/recording/bag_for_test.h"
#include "calibrato/recording/recording.h"
#include "calibrato/recording/test_folder.h"

namespace calibrato {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr int64_t kStart = 1'600'000'000'000'000'000;

const std::string kTopics =
    McapSchema(1, "sensor_msgs/msg/Image") + McapSchema(2, "sensor_msgs/msg/Imu") +
    McapSchema(3, "std_msgs/msg/String") + McapChannel(0, 1, "/cam0/image_raw") +
    McapChannel(1, 2, "/imu0") + McapChannel(2, 3, "/chatter") + McapChannel(3, 0, "/json", "json");

std::string Image(int64_t stamp, char first) {
  return McapMessage(0, stamp + 99, CdrImage(stamp, 1, 2, "mono8", 2, {first, first}));
}

std::string Imu(int64_t stamp) { return McapMessage(1, stamp, CdrImu(stamp, {1, 2, 3, 4, 5, 6})); }

const std::string kFirst = Imu(kStart) + McapMessage(2, 1, "hello") + Image(kStart + 7, 'k');
const std::string kSecond = McapMessage(3, 1, "{}") + Image(kStart + 3, 'a') + Imu(kStart + 5);

uint32_t Checksum(const std::string& bytes) {
  return static_cast<uint32_t>(
      crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

class McapTest : public testing::Test {
 protected:
  Recording Open(const std::string& records) const {
    return OpenRecording(folder_.Write("recording", McapFile(records)), {});
  }
  std::string ErrorOf(const std::string& records) const {
    return InputErrorOf([&] { static_cast<void>(Open(records)); });
  }
  static void ExpectContent(const Recording& recording) {
    ASSERT_EQ(recording.cameras.size(), 1U);
    EXPECT_EQ(recording.cameras[0].name, "/cam0/image_raw");
    const auto& images = std::get<CameraImages>(recording.cameras[0].data);
    ASSERT_EQ(images.list.size(), 2U);
    EXPECT_EQ(images.list[0].stamp.nanoseconds(), kStart + 3);
    EXPECT_THAT(GreyOf(images.reader->Read(0)).pixels, ElementsAre('a', 'a'));
    EXPECT_THAT(GreyOf(images.reader->Read(1)).pixels, ElementsAre('k', 'k'));
    ASSERT_EQ(recording.imus.size(), 1U);
    const ImuStream& imu = recording.imus[0].stream;
    ASSERT_EQ(imu.gyro.size(), 2U);
    EXPECT_EQ(imu.gyro[1].stamp.nanoseconds(), kStart + 5);
    EXPECT_EQ(imu.gyro[1].value, Eigen::Vector3d(1, 2, 3));
    EXPECT_EQ(imu.accel[1].value, Eigen::Vector3d(4, 5, 6));
  }
  TestFolder folder_;
};

TEST_F(McapTest, ReadsMessagesWithAndWithoutChunks) {
  ExpectContent(Open(kTopics + kFirst + kSecond));
  ExpectContent(Open(kTopics + McapChunk("", kFirst, kFirst.size()) +
                     McapChunk("", kSecond, kSecond.size())));
}

TEST_F(McapTest, ReadsChunksPackedByLz4AndZstdWithTheirChecksums) {
  const std::string first = kTopics + kFirst;
  ExpectContent(Open(McapChunk("lz4", PackedByLz4(first), first.size(), Checksum(first)) +
                     McapChunk("zstd", PackedByZstd(kSecond), kSecond.size(), Checksum(kSecond))));
}

TEST_F(McapTest, ReadsMessagesOfRos1) {
  const std::string message = McapMessage(0, 5, Ros1Image(5, 1, 2, "mono8", 2, "ab"));
  const Recording recording =
      Open(McapSchema(1, "sensor_msgs/Image") + McapChannel(0, 1, "/camera", "ros1") + message);
  const auto& images = std::get<CameraImages>(recording.cameras.at(0).data);
  EXPECT_THAT(GreyOf(images.reader->Read(0)).pixels, ElementsAre('a', 'b'));
}

TEST_F(McapTest, PassesOverRecordsOfLaterVersions) {
  ExpectContent(Open(McapRecordOf(0x6a, "new") + kTopics + McapRecordOf(0x0c, "metadata") + kFirst +
                     kSecond + McapRecordOf(0x90, "private")));
}

TEST_F(McapTest, RefusesWhatIsCutAnywhere) {
  const std::string whole = McapFile(kTopics + McapChunk("", kFirst, kFirst.size()));
  for (size_t size = 8; size < whole.size(); ++size) {
    const std::string path = folder_.Write("cut", whole.substr(0, size));
    EXPECT_THAT(InputErrorOf([&] { static_cast<void>(OpenRecording(path, {})); }), HasSubstr("cut"))
        << size;
  }
}

TEST_F(McapTest, SaysWhatIsWrong) {
  const std::string all = kTopics + kFirst;
  EXPECT_THAT(ErrorOf(McapChunk("", all, all.size(), Checksum(all) + 1)), HasSubstr("checksum"));
  EXPECT_THAT(ErrorOf(McapChunk("rar", all, all.size())), HasSubstr("'rar'"));
  EXPECT_THAT(ErrorOf(McapChunk("zstd", PackedByZstd(all), uint64_t{1} << 62)),
              HasSubstr("claims to be"));
  EXPECT_THAT(ErrorOf(kFirst), HasSubstr("belongs to no channel"));
  EXPECT_THAT(ErrorOf(McapSchema(3, "std_msgs/msg/String") + McapChannel(2, 3, "/chatter")),
              HasSubstr("no images"));
}

}  // namespace
}  // namespace calibrato
