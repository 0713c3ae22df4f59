#include "calibrato/recording/video_writer.h"

#include <gtest/gtest.h>

#include "calibrato/base/files.h"
#include "calibrato/base/input_error.h"
#include "calibrato/recording/recording.h"
#include "calibrato/recording/test_folder.h"
#include "calibrato/recording/video.h"

namespace calibrato {
namespace {

RgbImage Plain(uint8_t level) { return {{64, 48}, std::vector<uint8_t>(3 * 64 * 48, level)}; }

std::string Write(const std::string& path) {
  {
    VideoWriter video(path, {64, 48}, 10.0);
    double t_s = 0.0;
    for (const uint8_t level : {20, 120, 220}) {
      video.Add(Plain(level), t_s);
      t_s += 0.1;
    }
    video.Finish(t_s);
  }
  return ReadFile(path);
}

TEST(VideoWriter, WritesWhatTheReaderOfVideosReads) {
  const TestFolder folder;
  const std::string path = folder.path() + "/clip.avi";
  const std::string bytes = Write(path);
  std::vector<std::string> warnings;
  const CameraImages images = OpenVideo(path, {}, &warnings);
  ASSERT_EQ(images.list.size(), 3u);
  EXPECT_NEAR((images.list[1].stamp - images.list[0].stamp).seconds(), 0.1, 1e-6);
  EXPECT_EQ(bytes, Write(folder.path() + "/again.avi"));
}

// The grey of each picture of a video of pictures at these instants, the first darkest.
std::vector<int> Levels(double rate_hz, const std::vector<double>& instants, double end_s,
                        double* shown_rate_hz) {
  const TestFolder folder;
  const std::string path = folder.path() + "/clip.avi";
  VideoWriter video(path, {64, 48}, rate_hz);
  for (size_t k = 0; k < instants.size(); ++k) {
    video.Add(Plain(static_cast<uint8_t>(50 * (k + 1))), instants[k]);
  }
  video.Finish(end_s);
  std::vector<std::string> warnings;
  const CameraImages images = OpenVideo(path, {}, &warnings);
  *shown_rate_hz = 1.0 / (images.list[1].stamp - images.list[0].stamp).seconds();
  std::vector<int> levels;
  for (size_t k = 0; k < images.list.size(); ++k) {
    levels.push_back((GreyOf(images.reader->Read(k)).pixels[1000] + 25) / 50);
  }
  return levels;
}

TEST(VideoWriter, LeavesAPictureStandingWhereTheNextOneIsMissing) {
  double rate_hz = 0.0;
  EXPECT_EQ(Levels(10.0, {0.0, 0.3, 0.4}, 0.6, &rate_hz), (std::vector<int>{1, 1, 1, 2, 3, 3}));
  EXPECT_NEAR(rate_hz, 10.0, 1e-3);
}

TEST(VideoWriter, TakesAsLongAsWhatItShowsAtRatesThatAreNotWhole) {
  for (const double rate_hz : {0.2, 0.4, 7.5, 29.97, 45.5}) {
    const double period_s = 1.0 / rate_hz;
    double shown_hz = 0.0;
    const std::vector<int> levels =
        Levels(rate_hz, {0.0, period_s, 2.0 * period_s}, 3.0 * period_s, &shown_hz);
    EXPECT_NEAR(static_cast<double>(levels.size()) / shown_hz, 3.0 * period_s, 0.51 / shown_hz)
        << rate_hz;
    for (size_t k = 0; k < levels.size(); ++k) {
      const double t_s = (static_cast<double>(k) + 0.5) / shown_hz;
      // One picture more or less where one begins in the middle of another.
      EXPECT_NEAR(levels[k], 1.0 + t_s / period_s - 0.5, 0.5 + 0.51 / (shown_hz * period_s))
          << rate_hz << " " << k;
    }
  }
}

TEST(VideoWriter, SaysWhereItCannotWrite) {
  EXPECT_THROW(VideoWriter("/nowhere/clip.avi", {64, 48}, 10.0), InputError);
}

}  // namespace
}  // namespace calibrato
