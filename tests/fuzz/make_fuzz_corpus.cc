// make_fuzz_corpus FOLDER: the small files that fuzzing begins with, one folder a target.

#include <sqlite3.h>

#include <cstdio>
#include <filesystem>
#include <string>

#include "calibrato/base/files.h"
#include "calibrato/recording/bag_for_test.h"
#include "calibrato/recording/test_folder.h"

namespace calibrato {
namespace {

namespace fs = std::filesystem;

constexpr int64_t kStart = 1'600'000'000'000'000'000;
constexpr char kPixels[] = "abcdefghijklmnop";

void Write(const fs::path& folder, const std::string& name, const std::string& bytes) {
  fs::create_directories(folder);
  WriteFileAtomically((folder / name).string(), bytes);
}

// A PGM of 2 x 2 pixels: an image file that takes few bytes.
std::string Pgm() { return "P5 2 2 255\nabcd"; }

std::string Rosbag1(const std::string& compression, const std::string& encoding) {
  const std::string records =
      BagConnection(0, "/cam0/image_raw", "sensor_msgs/Image") +
      BagConnection(1, "/imu0", "sensor_msgs/Imu") +
      BagConnection(2, "/cam1/image_raw", "sensor_msgs/CompressedImage") +
      BagMessage(0, kStart, Ros1Image(kStart, 4, 4, encoding, 4, kPixels)) +
      BagMessage(1, kStart, Ros1Imu(kStart, {1, 2, 3, 4, 5, 6})) +
      BagMessage(2, kStart + 2, Ros1CompressedImage(kStart + 2, "pgm", Pgm()));
  const std::string packed = compression == "bz2"   ? PackedByBzip2(records)
                             : compression == "lz4" ? PackedByLz4(records)
                                                    : records;
  return Bag({BagChunk(compression, packed, records.size())}, 1,
             BagConnection(0, "/cam0/image_raw", "x"));
}

std::string Mcap(const std::string& compression) {
  const std::string records = McapSchema(1, "sensor_msgs/msg/Image") +
                              McapSchema(2, "sensor_msgs/msg/Imu") +
                              McapChannel(0, 1, "/cam0/image_raw") + McapChannel(1, 2, "/imu0") +
                              McapMessage(0, 5, CdrImage(kStart, 4, 4, "mono8", 4, kPixels)) +
                              McapMessage(1, 6, CdrImu(kStart, {1, 2, 3, 4, 5, 6}));
  const std::string packed = compression == "lz4"    ? PackedByLz4(records)
                             : compression == "zstd" ? PackedByZstd(records)
                                                     : records;
  return McapFile(McapChunk(compression, packed, records.size()) +
                  McapMessage(0, 7, CdrImage(kStart + 1, 2, 2, "mono16", 4, "abcdefgh")));
}

// In small pages, so that the whole is small.
std::string Database(const fs::path& scratch) {
  const std::string path = (scratch / "corpus.db3").string();
  fs::remove(path);
  sqlite3* database = nullptr;
  sqlite3_open(path.c_str(), &database);
  sqlite3_exec(database,
               "PRAGMA page_size = 512;"
               "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT,"
               " serialization_format TEXT);"
               "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER,"
               " data BLOB);"
               "INSERT INTO topics VALUES(1, '/cam0/image_raw', 'sensor_msgs/msg/Image', 'cdr');"
               "INSERT INTO topics VALUES(2, '/imu0', 'sensor_msgs/msg/Imu', 'cdr');",
               nullptr, nullptr, nullptr);
  const auto insert = [&](int topic, const std::string& data) {
    sqlite3_stmt* statement = nullptr;
    sqlite3_prepare_v2(database, "INSERT INTO messages(topic_id, data) VALUES(?1, ?2)", -1,
                       &statement, nullptr);
    sqlite3_bind_int(statement, 1, topic);
    sqlite3_bind_blob(statement, 2, data.data(), static_cast<int>(data.size()), SQLITE_TRANSIENT);
    sqlite3_step(statement);
    sqlite3_finalize(statement);
  };
  insert(1, CdrImage(kStart, 4, 4, "mono8", 4, kPixels));
  insert(2, CdrImu(kStart, {1, 2, 3, 4, 5, 6}));
  sqlite3_close(database);
  const std::string bytes = ReadFile(path);
  fs::remove(path);
  return bytes;
}

void WriteMessages(const fs::path& folder) {
  const auto reader = [](int number, bool is_cdr) {
    return std::string(1, static_cast<char>(2 * number + (is_cdr ? 1 : 0)));
  };
  const std::string encodings[] = {"mono8", "bgr8", "rgba8", "mono16", "bayer_rggb8"};
  for (const std::string& encoding : encodings) {
    Write(folder, "ros1-" + encoding,
          reader(0, false) + Ros1Image(kStart, 2, 2, encoding, 8, kPixels));
    Write(folder, "cdr-" + encoding,
          reader(0, true) + CdrImage(kStart, 2, 2, encoding, 8, kPixels));
  }
  Write(folder, "ros1-compressed", reader(1, false) + Ros1CompressedImage(kStart, "pgm", Pgm()));
  Write(folder, "ros1-imu", reader(2, false) + Ros1Imu(kStart, {1, 2, 3, 4, 5, 6}));
  Write(folder, "cdr-imu", reader(2, true) + CdrImu(kStart, {1, 2, 3, 4, 5, 6}));
}

void WriteLists(const fs::path& folder) {
  const auto reader = [](int number) { return std::string(1, static_cast<char>('0' + number)); };
  const std::string corners =
      "#timestamp [ns],tag_id,tag_corner,u [px],v [px],x [m],y [m],z [m]\n"
      "1404733405732800000,0,0,175.9867,336.8253,0.0,0.0,0.0\n"
      "1404733405732800000,1,2,175.5,33e1,0.1,0.0,0.0\r\n";
  Write(folder, "corners", reader(0) + corners);
  Write(folder, "corners-gzip", reader(0) + Gzip(corners));
  Write(folder, "corners-of-board", reader(1) + "timestamp,tag_id,u,v\n17,3,1.5,2.5\n17,4,3,4\n");
  Write(folder, "imu",
        reader(2) +
            "#timestamp [ns],w_x [rad/s],w_y [rad/s],w_z [rad/s],a_x [m/s^2],a_y [m/s^2],"
            "a_z [m/s^2]\n17,0.1,nan,-0.3,9.8,-inf,1e-3\n");
  Write(folder, "imu-without-header", reader(2) + "17,1,2,3,4,5,6\n18,1,2,3,4,5,6\n");
  Write(folder, "gyro", reader(3) + "\xEF\xBB\xBFtimestamp,x,y,z\n17,1,2,3\n");
}

void WriteYaml(const fs::path& folder) {
  const auto reader = [](int number) {
    return std::string(1, static_cast<char>('0' + number + 2));
  };
  Write(folder, "board",
        reader(0) +
            "target_type: 'checkerboard'\ntargetCols: 7\ntargetRows: 6\n"
            "rowSpacingMeters: 0.06\ncolSpacingMeters: 0.06\n");
  Write(folder, "charuco",
        reader(0) +
            "{target_type: charuco, targetCols: 8, targetRows: 6, "
            "squareSizeMeters: .04, markerSizeMeters: .03, "
            "dictionary: DICT_5X5_100}\n");
  Write(folder, "camchain",
        reader(1) +
            "cam0:\n  camera_model: pinhole\n  intrinsics: [458.6, 457.2, 367.2, 248.3]\n"
            "  distortion_model: radtan\n  distortion_coeffs: [-0.2, 0.07, 1e-4, 1e-5]\n"
            "  resolution: [752, 480]\n  rostopic: /cam0/image_raw\n");
  Write(folder, "imu",
        reader(2) +
            "rostopic: /imu0\nupdate_rate: 200.0\n"
            "accelerometer_noise_density: 2.0e-3\n"
            "accelerometer_random_walk: 3.0e-3\n"
            "gyroscope_noise_density: 1.7e-4\n"
            "gyroscope_random_walk: 1.9e-5\n");
  Write(folder, "rig",
        reader(3) +
            "cameras: {cam0: {camera_model: ds}}\nimu: &i {update_rate: 200}\n"
            "board: *i\nT_e_c0: [[1, 0, 0, 0], [0, 1, 0, 0]]\n");
  Write(folder, "json", reader(4) + R"({"a": [1, 2.5e-3, null, true], "b": {"c": "d\u00e4"}})");
}

void WriteCorpus(const fs::path& folder) {
  Write(folder / "rosbag1", "plain", Rosbag1("none", "mono8"));
  Write(folder / "rosbag1", "bz2", Rosbag1("bz2", "mono8"));
  Write(folder / "rosbag1", "lz4", Rosbag1("lz4", "bayer_rggb8"));
  Write(folder / "mcap", "plain", Mcap(""));
  Write(folder / "mcap", "lz4", Mcap("lz4"));
  Write(folder / "mcap", "zstd", Mcap("zstd"));
  Write(folder / "sqlite", "database", Database(folder));
  WriteMessages(folder / "messages");
  WriteLists(folder / "lists");
  WriteYaml(folder / "yaml");
}

}  // namespace
}  // namespace calibrato

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: make_fuzz_corpus FOLDER\n");
    return 2;
  }
  calibrato::WriteCorpus(argv[1]);
  return 0;
}
