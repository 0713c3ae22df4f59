#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <filesystem>
#include <stdexcept>

#include "calibrato/base/input_error_testing.h"
#include "calibrato/recording/bag_for_test.h"
#include "calibrato/recording/recording.h"
#include "calibrato/recording/test_folder.h"

namespace calibrato {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr int64_t kStart = 1'600'000'000'000'000'000;

const std::string kTables =
    "CREATE TABLE schema(schema_version INTEGER PRIMARY KEY, ros_distro TEXT NOT NULL);"
    "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL,"
    " serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);"
    "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL,"
    " timestamp INTEGER NOT NULL, data BLOB NOT NULL);"
    "CREATE INDEX timestamp_idx ON messages (timestamp ASC);"
    "INSERT INTO topics VALUES(1, '/cam0/image_raw', 'sensor_msgs/msg/Image', 'cdr', '');"
    "INSERT INTO topics VALUES(2, '/imu0', 'sensor_msgs/msg/Imu', 'cdr', '');"
    "INSERT INTO topics VALUES(3, '/chatter', 'std_msgs/msg/String', 'cdr', '');";

std::string Insert(int topic, int64_t stamp, const std::string& data) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string hex;
  for (const char c : data) {
    hex += kDigits[static_cast<unsigned char>(c) >> 4];
    hex += kDigits[static_cast<unsigned char>(c) & 15];
  }
  return "INSERT INTO messages(topic_id, timestamp, data) VALUES(" + std::to_string(topic) + "," +
         std::to_string(stamp) + ",x'" + hex + "');";
}

std::string Image(int64_t stamp, char first) {
  return Insert(1, stamp + 99, CdrImage(stamp, 1, 2, "mono8", 2, {first, first}));
}

std::string Imu(int64_t stamp) { return Insert(2, stamp, CdrImu(stamp, {1, 2, 3, 4, 5, 6})); }

void MakeDatabase(const std::string& path, const std::string& commands) {
  std::filesystem::remove(path);
  sqlite3* database = nullptr;
  const bool is_made =
      sqlite3_open(path.c_str(), &database) == SQLITE_OK &&
      sqlite3_exec(database, commands.c_str(), nullptr, nullptr, nullptr) == SQLITE_OK;
  const std::string why = sqlite3_errmsg(database);
  sqlite3_close(database);
  if (!is_made) throw std::runtime_error(why);
}

class Rosbag2Test : public testing::Test {
 protected:
  std::string ErrorOf(const std::string& commands) const {
    MakeDatabase(folder_.path() + "/bag", commands);
    return InputErrorOf([&] { static_cast<void>(OpenRecording(folder_.path() + "/bag", {})); });
  }
  static void ExpectContent(const Recording& recording) {
    ASSERT_EQ(recording.cameras.size(), 1U);
    const auto& images = std::get<CameraImages>(recording.cameras[0].data);
    ASSERT_EQ(images.list.size(), 2U);
    EXPECT_EQ(images.list[0].stamp.nanoseconds(), kStart + 3);
    EXPECT_THAT(GreyOf(images.reader->Read(0)).pixels, ElementsAre('a', 'a'));
    EXPECT_THAT(GreyOf(images.reader->Read(1)).pixels, ElementsAre('k', 'k'));
    ASSERT_EQ(recording.imus.size(), 1U);
    ASSERT_EQ(recording.imus[0].stream.gyro.size(), 2U);
    EXPECT_EQ(recording.imus[0].stream.gyro[1].stamp.nanoseconds(), kStart + 5);
    EXPECT_EQ(recording.imus[0].stream.accel[1].value, Eigen::Vector3d(4, 5, 6));
  }
  TestFolder folder_;
};

TEST_F(Rosbag2Test, ReadsADatabase) {
  const std::string path = folder_.path() + "/anything";
  MakeDatabase(path, kTables + Imu(kStart) + Insert(3, 5, "hello") + Image(kStart + 7, 'k') +
                         Image(kStart + 3, 'a') + Imu(kStart + 5));
  ExpectContent(OpenRecording(path, {}));
}

TEST_F(Rosbag2Test, ReadsAFolderOfSeveralParts) {
  folder_.Write("metadata.yaml", "rosbag2_bagfile_information: {version: 5}\n");
  MakeDatabase(folder_.path() + "/bag_10.db3", kTables + Image(kStart + 3, 'a') + Imu(kStart + 5));
  MakeDatabase(folder_.path() + "/bag_2.db3", kTables + Imu(kStart) + Image(kStart + 7, 'k'));
  ExpectContent(OpenRecording(folder_.path(), {}));
  folder_.Write("bag_11.db3.zstd", "\x28\xb5\x2f\xfd...");
  EXPECT_THAT(InputErrorOf([&] { static_cast<void>(OpenRecording(folder_.path(), {})); }),
              HasSubstr("zstd -d"));
}

TEST_F(Rosbag2Test, RefusesOtherDatabases) {
  EXPECT_THAT(ErrorOf("CREATE TABLE a(b);"), HasSubstr("no table 'topics'"));
  EXPECT_THAT(ErrorOf("CREATE TABLE topics(a); CREATE TABLE messages(a);"),
              HasSubstr("no such column"));
  EXPECT_THAT(ErrorOf(kTables), HasSubstr("no images"));
  EXPECT_THAT(ErrorOf(kTables + "UPDATE topics SET serialization_format = 'xml';"),
              HasSubstr("/cam0/image_raw are not in CDR"));
  EXPECT_THAT(ErrorOf(kTables + Insert(1, 5, "short")), HasSubstr("/cam0/image_raw"));
}

TEST_F(Rosbag2Test, RefusesAViewThatWouldNeverEnd) {
  EXPECT_THAT(ErrorOf("CREATE TABLE topics(id, name, type, serialization_format);"
                      "CREATE VIEW messages AS WITH RECURSIVE n(id) AS (SELECT 1 UNION ALL SELECT "
                      "id + 1 FROM n) SELECT id, 1 AS topic_id, x'00' AS data FROM n;"),
              HasSubstr("no table 'messages'"));
}

}  // namespace
}  // namespace calibrato
