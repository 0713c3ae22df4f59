// Bags that are truncated, lie about lengths, or have bytes flipped: an error that names the file,
// or what can still be read, and nothing else. The sanitizer build looks for the rest.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>
#include <sys/resource.h>

#include <optional>
#include <string_view>

#include "calibrato/base/files.h"
#include "calibrato/base/full_sample_for_test.h"
#include "calibrato/base/input_error.h"
#include "calibrato/base/input_error_testing.h"
#include "calibrato/base/rng.h"
#include "calibrato/recording/bag_for_test.h"
#include "calibrato/recording/corner_list.h"
#include "calibrato/recording/imu_list.h"
#include "calibrato/recording/recording.h"
#include "calibrato/recording/test_folder.h"

namespace calibrato {
namespace {

using testing::HasSubstr;

constexpr int64_t kStart = 1'600'000'000'000'000'000;

std::string Rosbag1(const std::string& compression) {
  const std::string first =
      BagConnection(0, "/cam0/image_raw", "sensor_msgs/Image") +
      BagConnection(1, "/imu0", "sensor_msgs/Imu") +
      BagMessage(0, kStart, Ros1Image(kStart, 4, 4, "mono8", 4, "abcdefghijklmnop")) +
      BagMessage(1, kStart, Ros1Imu(kStart, {1, 2, 3, 4, 5, 6}));
  const std::string second =
      BagConnection(2, "/cam1/image_raw", "sensor_msgs/CompressedImage") +
      BagMessage(0, kStart + 1, Ros1Image(kStart + 1, 3, 2, "bgr8", 6, "abcdefghijklmnopqr")) +
      BagMessage(2, kStart + 2, Ros1CompressedImage(kStart + 2, "png", "\x89PNG\r\n\x1a\n"));
  const auto chunk = [&](const std::string& records) {
    if (compression == "bz2") {
      return BagChunk(compression, PackedByBzip2(records), records.size());
    }
    if (compression == "lz4") return BagChunk(compression, PackedByLz4(records), records.size());
    return BagChunk(compression, records, records.size());
  };
  return Bag({chunk(first), chunk(second)}, 2, BagConnection(0, "/cam0/image_raw", "x"));
}

std::string Mcap(const std::string& compression) {
  const std::string records =
      McapSchema(1, "sensor_msgs/msg/Image") + McapSchema(2, "sensor_msgs/msg/Imu") +
      McapChannel(0, 1, "/cam0/image_raw") + McapChannel(1, 2, "/imu0") +
      McapMessage(0, 5, CdrImage(kStart, 4, 4, "mono8", 4, "abcdefghijklmnop")) +
      McapMessage(1, 6, CdrImu(kStart, {1, 2, 3, 4, 5, 6}));
  const std::string packed = compression == "lz4"    ? PackedByLz4(records)
                             : compression == "zstd" ? PackedByZstd(records)
                                                     : records;
  return McapFile(McapChunk(compression, packed, records.size()) +
                  McapMessage(0, 7, CdrImage(kStart + 1, 3, 2, "bgr8", 6, "abcdefghijklmnopqr")));
}

std::string Database() {
  const TestFolder folder;
  const std::string path = folder.path() + "/a.db3";
  sqlite3* database = nullptr;
  sqlite3_open(path.c_str(), &database);
  sqlite3_exec(database,
               "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT,"
               " serialization_format TEXT);"
               "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER,"
               " data BLOB);"
               "INSERT INTO topics VALUES(1, '/cam0/image_raw', 'sensor_msgs/msg/Image', 'cdr');",
               nullptr, nullptr, nullptr);
  sqlite3_stmt* insert = nullptr;
  sqlite3_prepare_v2(database, "INSERT INTO messages(topic_id, data) VALUES(1, ?1)", -1, &insert,
                     nullptr);
  for (int k = 0; k < 3; ++k) {
    const std::string data = CdrImage(kStart + k, 4, 4, "mono8", 4, "abcdefghijklmnop");
    sqlite3_bind_blob(insert, 1, data.data(), static_cast<int>(data.size()), SQLITE_TRANSIENT);
    sqlite3_step(insert);
    sqlite3_reset(insert);
  }
  sqlite3_finalize(insert);
  sqlite3_close(database);
  return ReadFile(path);
}

// Reads all that there is; returns how many images, or nothing after an error that must name what
// was read. Any other exception, or worse, fails the test.
std::optional<size_t> NumImagesRead(const TestFolder& folder, const std::string& content) {
  const std::string path = folder.Write("damaged", content);
  size_t num_images = 0;
  try {
    const Recording recording = OpenRecording(path, {});
    for (const CameraRecording& camera : recording.cameras) {
      const auto& images = std::get<CameraImages>(camera.data);
      for (size_t k = 0; k < images.list.size(); ++k) {
        try {
          const GreyImage grey = GreyOf(images.reader->Read(k));
          EXPECT_EQ(grey.pixels.size(), static_cast<size_t>(grey.resolution.width) *
                                            static_cast<size_t>(grey.resolution.height));
        } catch (const InputError& error) {
          EXPECT_THAT(error.what(), HasSubstr("damaged"));
        }
        ++num_images;
      }
    }
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("damaged"));
    EXPECT_EQ(std::string_view(error.what()).find('\n'), std::string_view::npos);
    return std::nullopt;
  }
  return num_images;
}

// From one damaged byte to the next: every byte in the full sample. A database has pages of 4096
// bytes that are mostly empty.
size_t Step(const std::string& bytes) {
  if (FullSample()) return 1;
  return bytes.size() > 8000 ? 97 : 10;
}

struct Sample {
  std::string name;
  std::string bytes;
  size_t num_images = 0;
};

std::vector<Sample> Samples() {
  return {{"rosbag1", Rosbag1("none"), 3},    {"rosbag1_bz2", Rosbag1("bz2"), 3},
          {"rosbag1_lz4", Rosbag1("lz4"), 3}, {"mcap", Mcap(""), 2},
          {"mcap_lz4", Mcap("lz4"), 2},       {"mcap_zstd", Mcap("zstd"), 2},
          {"database", Database(), 3}};
}

class DamagedBags : public testing::TestWithParam<Sample> {
 protected:
  TestFolder folder_;
};

TEST_P(DamagedBags, AreReadWhole) {
  EXPECT_EQ(NumImagesRead(folder_, GetParam().bytes), GetParam().num_images);
}

// What the process has ever held in memory [bytes].
double PeakMemory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

TEST_P(DamagedBags, TruncatedAnywhereAreRefusedOrReadInPart) {
  const std::string& bytes = GetParam().bytes;
  const double memory_before = PeakMemory();
  size_t num_refused = 0;
  size_t num_cuts = 0;
  const size_t step = Step(bytes);
  for (size_t size = 0; size < bytes.size(); size += step) {
    const std::optional<size_t> num_images = NumImagesRead(folder_, bytes.substr(0, size));
    ++num_cuts;
    if (!num_images) {
      ++num_refused;
    } else {
      EXPECT_LE(*num_images, GetParam().num_images);
    }
  }
  EXPECT_GT(num_refused, num_cuts * 8 / 10);
#ifdef __SANITIZE_ADDRESS__
  constexpr double kKept = 512e6;  // It keeps what was freed.
#else
  constexpr double kKept = 0.0;
#endif
  EXPECT_LT(PeakMemory() - memory_before, 64e6 + 10.0 * static_cast<double>(bytes.size()) + kKept);
}

TEST_P(DamagedBags, WithHugeNumbersAnywhereAreRefusedOrReadInPart) {
  const std::string& bytes = GetParam().bytes;
  const size_t step = Step(bytes);
  // Each number begins at places of its own, so that together they meet every field.
  size_t first = 0;
  for (const std::string& huge : {U32(0xffffffff), U64(0x7fffffffffffffff), U32(0x7fffffff),
                                  U64(0xffffffffffffffff), U32(0), U32(0x01000000)}) {
    for (size_t k = first++ % step; k + huge.size() <= bytes.size(); k += step) {
      std::string damaged = bytes;
      damaged.replace(k, huge.size(), huge);
      NumImagesRead(folder_, damaged);
    }
  }
}

TEST_P(DamagedBags, WithBytesFlippedAreRefusedOrReadInPart) {
  const int num_trials = FullSample() ? 20'000 : 250;
  const std::string& bytes = GetParam().bytes;
  Rng rng = Rng(6).Stream("flipped bytes of " + GetParam().name);
  for (int trial = 0; trial < num_trials; ++trial) {
    std::string damaged = bytes;
    const uint64_t num_flips = 1 + rng.UniformIndex(8);
    for (uint64_t flip = 0; flip < num_flips; ++flip) {
      damaged[rng.UniformIndex(damaged.size())] = static_cast<char>(rng.UniformIndex(256));
    }
    NumImagesRead(folder_, damaged);
  }
}

// Lists end where they are cut: after a whole line they are shorter, within one they are refused or
// end in a number that is shorter.
TEST(DamagedList, TruncatedAnywhereIsRefusedOrReadInPart) {
  const TestFolder folder;
  const std::string corners =
      "#timestamp [ns],tag_id,tag_corner,u [px],v [px],x [m],y [m],z [m]\n"
      "1404733405732800000,0,0,175.9867,336.8253,0.0,0.0,0.0\n"
      "1404733405732800000,1,2,175.5,33e1,0.1,0.0,0.0\n";
  const std::string imu =
      "#timestamp [ns],w_x,w_y,w_z,a_x,a_y,a_z\n17,1,2,3,4,5,6\n18,1,2,3,4,5,6\n";
  const auto read_all = [&](const std::string& content, const auto& read) {
    size_t num_refused = 0;
    for (size_t size = 0; size < content.size(); ++size) {
      const std::string path = folder.Write("damaged", content.substr(0, size));
      try {
        EXPECT_LE(read(path), 2U);
      } catch (const InputError& error) {
        EXPECT_THAT(error.what(), HasSubstr("damaged"));
        ++num_refused;
      }
    }
    return num_refused;
  };
  const auto num_corners = [](const std::string& path) {
    size_t count = 0;
    for (const BoardView& view : ReadCornerList(path, std::nullopt))
      count += view.corner_ids.size();
    return count;
  };
  const auto num_samples = [](const std::string& path) { return ReadImuList(path).gyro.size(); };
  EXPECT_GT(read_all(corners, num_corners), 100U);
  EXPECT_GT(read_all(imu, num_samples), 50U);
  // Of a gzip file nothing is believed that is not whole.
  const std::string packed = Gzip(corners);
  EXPECT_EQ(read_all(packed, num_corners), packed.size());
}

TEST(DamagedBag, OfMoreMessagesThanBytesIsRefused) {
  // 120,000 times the same message, in a file of a few kilobytes.
  std::string records = BagConnection(0, "/cam0/image_raw", "sensor_msgs/Image");
  const std::string message = BagMessage(0, kStart, Ros1Image(kStart, 1, 1, "mono8", 1, "a"));
  for (int k = 0; k < 120'000; ++k) records += message;
  const TestFolder folder;
  const std::string bag = Bag({BagChunk("bz2", PackedByBzip2(records), records.size())}, 1,
                              BagConnection(0, "/a", "b"));
  ASSERT_LT(bag.size(), 30'000U);
  const std::string path = folder.Write("bomb", bag);
  EXPECT_THAT(InputErrorOf([&] { static_cast<void>(OpenRecording(path, {})); }),
              HasSubstr("more messages"));
}

INSTANTIATE_TEST_SUITE_P(Kinds, DamagedBags, testing::ValuesIn(Samples()),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace calibrato
