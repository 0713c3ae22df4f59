// A bag of 2 GB: read image by image, in a memory that does not grow with it. It says how fast it
// was; docs/performance.md has the figures.

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <string>

#include "calibrato/recording/bag_for_test.h"
#include "calibrato/recording/recording.h"
#include "calibrato/recording/test_folder.h"

namespace calibrato {
namespace {

constexpr int64_t kStart = 1'600'000'000'000'000'000;
constexpr int kWidth = 1280;
constexpr int kHeight = 1024;
constexpr int kNumImages = 1640;
constexpr int kImuPerImage = 10;

// An image whose bytes tell its number.
std::string PixelsOf(int number) {
  std::string pixels(size_t{kWidth} * kHeight, '\0');
  uint32_t state = 2463534242U + static_cast<uint32_t>(number);
  for (size_t k = 0; k + 4 <= pixels.size(); k += 4) {
    state ^= state << 13;
    state ^= state >> 17;
    state ^= state << 5;
    for (size_t i = 0; i < 4; ++i) pixels[k + i] = static_cast<char>(state >> (8 * i));
  }
  return pixels;
}

// One image and its IMU samples in each chunk.
uint64_t WriteBag(const std::string& path) {
  std::ofstream file(path, std::ios::binary);
  const std::string connections = BagConnection(0, "/cam0/image_raw", "sensor_msgs/Image") +
                                  BagConnection(1, "/imu0", "sensor_msgs/Imu");
  // The head of a bag that was never closed, as recording writes it.
  file << Bag({}, 0, "");
  for (int k = 0; k < kNumImages; ++k) {
    const int64_t stamp = kStart + int64_t{k} * 50'000'000;
    std::string records = k == 0 ? connections : "";
    records +=
        BagMessage(0, stamp, Ros1Image(stamp, kHeight, kWidth, "mono8", kWidth, PixelsOf(k)));
    for (int i = 0; i < kImuPerImage; ++i) {
      const int64_t at = stamp + int64_t{i} * 5'000'000;
      records += BagMessage(1, at, Ros1Imu(at, {0.1 * i, 0, 0, 0, 0, 9.81}));
    }
    file << BagChunk("none", records, records.size());
  }
  file.flush();
  return static_cast<uint64_t>(file.tellp());
}

double PeakMegabytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1e3;
}

TEST(LargeBag, IsReadInLittleMemory) {
  const TestFolder folder;
  const std::string path = folder.path() + "/large.bag";
  const auto bytes = static_cast<double>(WriteBag(path));
  ASSERT_GT(bytes, 2e9);
  const auto start = std::chrono::steady_clock::now();
  const Recording recording = OpenRecording(path, {});
  ASSERT_EQ(recording.cameras.size(), 1U);
  ASSERT_EQ(recording.imus.at(0).stream.gyro.size(), size_t{kNumImages} * kImuPerImage);
  const auto opened = std::chrono::steady_clock::now();
  const auto& images = std::get<CameraImages>(recording.cameras[0].data);
  ASSERT_EQ(images.list.size(), size_t{kNumImages});
  uint64_t sum = 0;
  for (size_t k = 0; k < images.list.size(); ++k) {
    const GreyImage image = GreyOf(images.reader->Read(k));
    ASSERT_EQ(image.pixels.size(), size_t{kWidth} * kHeight);
    sum += image.pixels[k];
  }
  const auto end = std::chrono::steady_clock::now();
  const GreyImage last = GreyOf(images.reader->Read(kNumImages - 1));
  const std::string pixels = PixelsOf(kNumImages - 1);
  EXPECT_TRUE(std::equal(pixels.begin(), pixels.end(), last.pixels.begin(),
                         [](char a, uint8_t b) { return static_cast<uint8_t>(a) == b; }));
  const double opening_s = std::chrono::duration<double>(opened - start).count();
  const double reading_s = std::chrono::duration<double>(end - opened).count();
  std::printf(
      "%.2f GB: opened in %.2f s (%.0f MB/s), all images read in %.2f s (%.0f MB/s), "
      "peak memory %.0f MB (checksum %llu)\n",
      bytes / 1e9, opening_s, bytes / 1e6 / opening_s, reading_s, bytes / 1e6 / reading_s,
      PeakMegabytes(), static_cast<unsigned long long>(sum));
  EXPECT_LT(PeakMegabytes(), 500.0);
}

}  // namespace
}  // namespace calibrato
