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
    for (const uint8_t level : {20, 120, 220}) video.Add(Plain(level));
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

TEST(VideoWriter, SaysWhereItCannotWrite) {
  EXPECT_THROW(VideoWriter("/nowhere/clip.avi", {64, 48}, 10.0), InputError);
}

}  // namespace
}  // namespace calibrato
