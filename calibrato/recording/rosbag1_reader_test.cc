#include <gmock/gmock.h>
#include <gtest/gtest.h>

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

const std::string kImageTopic = BagConnection(0, "/cam0/image_raw", "sensor_msgs/Image");
const std::string kImuTopic = BagConnection(1, "/imu0", "sensor_msgs/Imu");
const std::string kOtherTopic = BagConnection(2, "/rosout", "rosgraph_msgs/Log");

std::string Image(int64_t stamp, char first) {
  return BagMessage(
      0, stamp + 99,
      Ros1Image(stamp, 1, 3, "mono8", 3, first + std::string(2, static_cast<char>(first + 1))));
}

std::string Imu(int64_t stamp) {
  return BagMessage(1, stamp, Ros1Imu(stamp, {1, 2, 3, 4, 5, static_cast<double>(stamp - kStart)}));
}

// The later image first.
const std::string kFirstChunk = kImageTopic + kImuTopic + kOtherTopic + Imu(kStart) +
                                Image(kStart + 7, 'k') + BagMessage(2, kStart, "whatever");
const std::string kSecondChunk = Image(kStart + 3, 'a') + Imu(kStart + 5);

class Rosbag1Test : public testing::Test {
 protected:
  Recording Open(const std::string& bag) const {
    return OpenRecording(folder_.Write("recording", bag), {});
  }
  std::string ErrorOf(const std::string& bag) const {
    return InputErrorOf([&] { static_cast<void>(Open(bag)); });
  }
  static void ExpectContent(const Recording& recording) {
    ASSERT_EQ(recording.cameras.size(), 1U);
    EXPECT_EQ(recording.cameras[0].name, "/cam0/image_raw");
    const auto& images = std::get<CameraImages>(recording.cameras[0].data);
    ASSERT_EQ(images.list.size(), 2U);
    EXPECT_EQ(images.list[0].stamp.nanoseconds(), kStart + 3);
    EXPECT_EQ(images.list[1].name, std::to_string(kStart + 7));
    ASSERT_EQ(images.stamps_as_recorded.size(), 2U);
    EXPECT_EQ(images.stamps_as_recorded[0].nanoseconds(), kStart + 7);
    EXPECT_THAT(GreyOf(images.reader->Read(0)).pixels, ElementsAre('a', 'b', 'b'));
    EXPECT_THAT(GreyOf(images.reader->Read(1)).pixels, ElementsAre('k', 'l', 'l'));
    ASSERT_EQ(recording.imus.size(), 1U);
    EXPECT_EQ(recording.imus[0].name, "/imu0");
    const ImuStream& imu = recording.imus[0].stream;
    ASSERT_EQ(imu.gyro.size(), 2U);
    EXPECT_EQ(imu.gyro[1].stamp.nanoseconds(), kStart + 5);
    EXPECT_EQ(imu.gyro[1].value, Eigen::Vector3d(1, 2, 3));
    EXPECT_EQ(imu.accel[1].value, Eigen::Vector3d(4, 5, 5));
  }
  TestFolder folder_;
};

std::string PlainChunk(const std::string& records) {
  return BagChunk("none", records, records.size());
}

TEST_F(Rosbag1Test, ReadsChunksPackedInEveryWay) {
  const std::string index = kImageTopic + kImuTopic + kOtherTopic;
  ExpectContent(Open(Bag({PlainChunk(kFirstChunk), PlainChunk(kSecondChunk)}, 2, index)));
  ExpectContent(Open(Bag({BagChunk("bz2", PackedByBzip2(kFirstChunk), kFirstChunk.size()),
                          BagChunk("lz4", PackedByLz4(kSecondChunk), kSecondChunk.size())},
                         2, index)));
}

TEST_F(Rosbag1Test, ReadsABagThatWasNeverClosedAndSaysSo) {
  // As a recorder leaves it: the last chunk is still empty by its header, its records follow.
  const std::string bag = Bag({PlainChunk(kFirstChunk), PlainChunk("") + kSecondChunk}, 0, "");
  const Recording whole = Open(bag);
  ExpectContent(whole);
  EXPECT_TRUE(whole.warnings.empty());
  const Recording cut = Open(bag + Image(kStart + 9, 'x').substr(0, 50));
  ExpectContent(cut);
  EXPECT_THAT(cut.warnings, ElementsAre(HasSubstr("never closed")));
  // Of a packed chunk that was still being written, nothing can be unpacked.
  const Recording packed = Open(Bag({PlainChunk(kFirstChunk), PlainChunk(kSecondChunk),
                                     BagChunk("bz2", "", 0) + PackedByBzip2("unfinished")},
                                    0, ""));
  ExpectContent(packed);
  EXPECT_THAT(packed.warnings, ElementsAre(HasSubstr("never closed")));
}

TEST_F(Rosbag1Test, RefusesAClosedBagThatIsCutAnywhere) {
  const std::string bag =
      Bag({PlainChunk(kFirstChunk), PlainChunk(kSecondChunk)}, 2, kImageTopic + kImuTopic);
  for (size_t size = 0; size < bag.size() - kImageTopic.size() - kImuTopic.size(); ++size) {
    EXPECT_NE(ErrorOf(bag.substr(0, size)), "") << size;
  }
}

TEST_F(Rosbag1Test, MayHaveNoCamerasButNoDamagedOnes) {
  RecordingOptions options;
  options.cameras_may_be_missing = true;
  const std::string imus = kImuTopic + Imu(kStart) + Imu(kStart + 5);
  const Recording recording =
      OpenRecording(folder_.Write("imus", Bag({PlainChunk(imus)}, 1, kImuTopic)), options);
  EXPECT_TRUE(recording.cameras.empty());
  EXPECT_EQ(recording.imus.size(), 1U);
  EXPECT_THAT(ErrorOf(Bag({PlainChunk(imus)}, 1, kImuTopic)), HasSubstr("no images"));
  const std::string twins = kImageTopic + imus + Image(kStart, 'a') + Image(kStart, 'b');
  const std::string damaged =
      folder_.Write("twins", Bag({PlainChunk(twins)}, 1, kImageTopic + kImuTopic));
  EXPECT_THAT(InputErrorOf([&] { static_cast<void>(OpenRecording(damaged, options)); }),
              HasSubstr("two images of one stamp"));
}

TEST_F(Rosbag1Test, SaysWhatIsWrongAndWhere) {
  const std::string index = kImageTopic;
  EXPECT_THAT(ErrorOf(Bag({PlainChunk(kFirstChunk)}, 2, index)), HasSubstr("1 chunks"));
  EXPECT_THAT(ErrorOf(Bag({BagChunk("rar", kFirstChunk, 1)}, 1, index)),
              AllOf(HasSubstr("recording"), HasSubstr("'rar'")));
  EXPECT_THAT(
      ErrorOf(Bag({BagChunk("lz4", PackedByLz4(kFirstChunk), uint64_t{1} << 31)}, 1, index)),
      HasSubstr("claims to be 2147483648 bytes"));
  EXPECT_THAT(ErrorOf(Bag({PlainChunk(Image(kStart, 'a'))}, 1, index)),
              HasSubstr("belongs to no connection"));
  EXPECT_THAT(ErrorOf(Bag({PlainChunk(kOtherTopic)}, 1, index)), HasSubstr("no images"));
  EXPECT_THAT(ErrorOf(Bag({PlainChunk(kImageTopic + BagMessage(0, 5, "short"))}, 1, index)),
              HasSubstr("/cam0/image_raw"));
  EXPECT_THAT(ErrorOf(Bag({PlainChunk(kImageTopic + Image(0, 'a') + Image(0, 'b'))}, 1, index)),
              AllOf(HasSubstr("two images of one stamp"), HasSubstr("header.stamp")));
  EXPECT_THAT(ErrorOf("#ROSBAG V1.2\n"), HasSubstr("rosbag fix"));
}

TEST_F(Rosbag1Test, TakesSensorsOfAnImuFromTopicsOfTheirOwn) {
  const std::string gyro = BagConnection(1, "/imu/gyro", "sensor_msgs/Imu");
  const std::string accel = BagConnection(3, "/imu/accel", "sensor_msgs/Imu");
  // -1 as first number of a covariance: no value.
  std::string rates = Ros1Imu(kStart, {1, 2, 3, 0, 0, 0});
  rates.replace(rates.size() - 9 * 8, 8, F64(-1));
  std::string forces = Ros1Imu(kStart + 1, {0, 0, 0, 4, 5, 6});
  forces.replace(forces.size() - (9 + 3 + 9) * 8, 8, F64(-1));
  const Recording recording =
      Open(Bag({PlainChunk(kImageTopic + gyro + accel + Image(kStart, 'a') +
                           BagMessage(1, kStart, rates) + BagMessage(3, kStart, forces))},
               1, kImageTopic));
  ASSERT_EQ(recording.imus.size(), 1U);
  const ImuStream& stream = recording.imus[0].stream;
  ASSERT_EQ(stream.gyro.size(), 1U);
  ASSERT_EQ(stream.accel.size(), 1U);
  EXPECT_EQ(stream.gyro[0].value, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(stream.accel[0].value, Eigen::Vector3d(4, 5, 6));
  EXPECT_EQ(stream.accel[0].stamp.nanoseconds(), kStart + 1);
}

TEST_F(Rosbag1Test, IsFoundInAFolderOfItsOwn) {
  folder_.Write("recording.bag", Bag({PlainChunk(kFirstChunk + kSecondChunk)}, 1, kImageTopic));
  folder_.Write("notes.txt", "board: 7 x 6");
  ExpectContent(OpenRecording(folder_.path(), {}));
}

}  // namespace
}  // namespace calibrato
