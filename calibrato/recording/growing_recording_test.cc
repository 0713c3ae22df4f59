#include "calibrato/recording/growing_recording.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <string>
#include <variant>
#include <vector>

#include "calibrato/base/input_error_testing.h"
#include "calibrato/recording/recording.h"
#include "calibrato/recording/test_folder.h"

namespace calibrato {
namespace {

constexpr int64_t kEpoch = 1'700'000'000'000'000'000;

Time At(int k) { return Time::FromNanoseconds(kEpoch + k * 5'000'000); }

VectorSample Sample(int k) { return {At(k), Eigen::Vector3d(0.1 * k, -0.5, 1.0 / (k + 1))}; }

GreyImage Image(int k) {
  GreyImage image{{32, 24}, std::vector<uint8_t>(32 * 24)};
  for (size_t i = 0; i < image.pixels.size(); ++i) {
    image.pixels[i] = static_cast<uint8_t>(i * 7 + static_cast<size_t>(k));
  }
  return image;
}

BoardView View(int k) {
  BoardView view;
  view.stamp = At(k);
  view.corner_ids = {0, 1};
  view.pixels.resize(2, 2);
  view.pixels << 1.25, 2.5, 3.75 + k, 1.0 / 3.0;
  view.points_g.resize(3, 2);
  view.points_g << 0.0, 0.1, 0.0, 0.0, 0.0, 0.0;
  return view;
}

TEST(GrowingRecording, IsARecordingAfterEverySample) {
  const TestFolder folder;
  const std::string path = folder.path() + "/rec";
  GrowingRecording recording(path, {32, 24}, 1);
  for (int k = 0; k < 3; ++k) {
    recording.AddImage(At(k), Image(k));
    recording.AddImu(Sample(k), {At(k), Sample(k + 10).value});
    const Recording read = OpenRecording(path, {});
    const auto& images = std::get<CameraImages>(read.cameras.at(0).data);
    ASSERT_EQ(images.list.size(), static_cast<size_t>(k + 1));
    EXPECT_EQ(images.list.back().stamp, At(k));
    EXPECT_EQ(GreyOf(images.reader->Read(static_cast<size_t>(k))).pixels, Image(k).pixels);
    ASSERT_EQ(read.imus.at(0).stream.gyro.size(), static_cast<size_t>(k + 1));
    EXPECT_EQ(read.imus[0].stream.gyro.back().value, Sample(k).value);
    EXPECT_EQ(read.imus[0].stream.accel.back().value, Sample(k + 10).value);
  }
}

TEST(GrowingRecording, KeepsCornersToTheLastBit) {
  const TestFolder folder;
  const std::string path = folder.path() + "/rec";
  GrowingRecording recording(path, {640, 480}, 1);
  for (int k = 0; k < 4; ++k) recording.AddView(View(k));
  const Recording read = OpenRecording(path, {});
  const auto& views = std::get<std::vector<BoardView>>(read.cameras.at(0).data);
  ASSERT_EQ(views.size(), 4U);
  EXPECT_EQ(views[3].pixels, View(3).pixels);
  EXPECT_EQ(read.cameras[0].resolution, (Resolution{640, 480}));
}

TEST(GrowingRecording, RefusesAFolderWithSomethingInIt) {
  const TestFolder folder;
  std::ofstream(folder.path() + "/something") << "here";
  EXPECT_THROW(GrowingRecording(folder.path(), {32, 24}, 1), InputError);
  EXPECT_FALSE(std::filesystem::exists(folder.path() + "/sensor.yaml"));
}

// In a process of its own, which is killed in the middle of its work.
TEST(GrowingRecording, OutlivesItsProcess) {
  const TestFolder folder;
  for (int run = 0; run < 5; ++run) {
    const std::string path = folder.path() + "/rec" + std::to_string(run);
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      GrowingRecording recording(path, {32, 24}, 1);
      for (int k = 0;; ++k) {
        recording.AddImage(At(k), Image(k));
        recording.AddImu(Sample(k), Sample(k));
      }
    }
    const std::string fifth = path + "/cam0/" + std::to_string(At(4).nanoseconds()) + ".png";
    for (int k = 0; k < 3000 && !std::filesystem::exists(fifth); ++k) usleep(10'000);
    usleep(7'000 * static_cast<useconds_t>(run));
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    const Recording read = OpenRecording(path, {});
    const auto& images = std::get<CameraImages>(read.cameras.at(0).data);
    const size_t num_images = images.list.size();
    const size_t num_samples = read.imus.at(0).stream.gyro.size();
    EXPECT_GE(num_images, 5U);
    EXPECT_LE(num_images - num_samples, 1U);
    for (size_t k = 0; k < num_images; ++k) {
      EXPECT_EQ(GreyOf(images.reader->Read(k)).pixels, Image(static_cast<int>(k)).pixels);
    }
  }
}

// Writes an image, and then samples of an IMU onto a disk on which no file grows beyond this: a
// limit on the size of files is a disk that is full, without the disk. In a process of its own.
// @return whether the recording refused a sample for it.
bool RefusesOnAFullDisk(const std::string& path, rlim_t most_bytes) {
  const pid_t child = fork();
  if (child == 0) {
    signal(SIGXFSZ, SIG_IGN);
    GrowingRecording recording(path, {32, 24}, 1);
    recording.AddImage(At(0), Image(0));
    const rlimit limit{most_bytes, most_bytes};
    setrlimit(RLIMIT_FSIZE, &limit);
    try {
      for (int k = 0; k < 1000; ++k) recording.AddImu(Sample(k), Sample(k));
    } catch (const InputError&) {
      _exit(7);
    }
    _exit(0);
  }
  int status = 0;
  return child > 0 && waitpid(child, &status, 0) == child && WIFEXITED(status) &&
         WEXITSTATUS(status) == 7;
}

TEST(GrowingRecording, KeepsWholeRowsWhenTheDiskIsFull) {
  const TestFolder folder;
  const std::string path = folder.path() + "/rec";
  ASSERT_TRUE(RefusesOnAFullDisk(path, 4000));
  const Recording read = OpenRecording(path, {});
  const ImuStream& stream = read.imus.at(0).stream;
  ASSERT_GT(stream.gyro.size(), 20U);
  EXPECT_EQ(stream.gyro.back().value, Sample(static_cast<int>(stream.gyro.size()) - 1).value);
}

TEST(GrowingRecording, KeepsItsImagesWhereNotEvenOneRowFits) {
  const TestFolder folder;
  const std::string path = folder.path() + "/rec";
  ASSERT_TRUE(RefusesOnAFullDisk(path, 10));
  EXPECT_FALSE(std::filesystem::exists(path + "/imu0.csv"));
  const Recording read = OpenRecording(path, {});
  EXPECT_EQ(std::get<CameraImages>(read.cameras.at(0).data).list.size(), 1U);
  EXPECT_TRUE(read.imus.empty());
}

}  // namespace
}  // namespace calibrato
