#include "calibrato/recording/video.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/videoio.hpp>

#include "calibrato/base/files.h"
#include "calibrato/base/input_error_testing.h"
#include "calibrato/recording/test_folder.h"

namespace calibrato {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr int kNumFrames = 200;
constexpr double kRateHz = 20.0;

int LevelOf(size_t k) { return static_cast<int>(40 + 7 * k % 160); }

// Frame k is of one grey, LevelOf(k).
void WriteVideo(const std::string& path) {
  const cv::Size size(64, 48);
  cv::VideoWriter writer(path, cv::CAP_OPENCV_MJPEG, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'),
                         kRateHz, size);
  ASSERT_TRUE(writer.isOpened());
  for (size_t k = 0; k < kNumFrames; ++k) {
    writer.write(cv::Mat(size, CV_8UC3, cv::Scalar::all(LevelOf(k))));
  }
}

class VideoTest : public testing::Test {
 protected:
  VideoTest() : path_(folder_.path() + "/cam0.avi") { WriteVideo(path_); }
  std::string ErrorOf(const RecordingOptions& options = {}) const {
    return InputErrorOf([&] { static_cast<void>(OpenRecording(path_, options)); });
  }
  TestFolder folder_;
  std::string path_;
};

const CameraImages& Frames(const Recording& recording) {
  return std::get<CameraImages>(recording.cameras.at(0).data);
}

TEST_F(VideoTest, GivesEachFrameItsNumberInAnyOrder) {
  const Recording recording = OpenRecording(path_, {});
  const CameraImages& frames = Frames(recording);
  ASSERT_EQ(frames.list.size(), static_cast<size_t>(kNumFrames));
  // Two runs side by side, as two threads make them, then backwards.
  std::vector<size_t> order;
  for (size_t k = 0; k < 20; ++k) order.insert(order.end(), {k, 150 + k});
  order.insert(order.end(), {199, 75, 3});
  for (const size_t k : order) {
    const GreyImage grey = GreyOf(frames.reader->Read(k));
    EXPECT_EQ(grey.resolution, (Resolution{64, 48}));
    EXPECT_NEAR(grey.pixels.at(1000), LevelOf(k), 2.0) << k;
  }
}

TEST_F(VideoTest, TakesTheRateOfTheFileWithAWarningOrThatOfTheOptions) {
  const Recording recording = OpenRecording(path_, {});
  EXPECT_EQ(Frames(recording).list[3].stamp.nanoseconds(), 150'000'000);
  EXPECT_THAT(recording.warnings, ElementsAre(AllOf(HasSubstr("cam0.avi"), HasSubstr("20 Hz"))));
  RecordingOptions options;
  options.frame_rate_hz = 30.0;
  const Recording other = OpenRecording(path_, options);
  EXPECT_EQ(Frames(other).list[2].stamp.nanoseconds(), 66'666'667);
  EXPECT_TRUE(other.warnings.empty());
  options.frame_rate_hz = 0.0;
  EXPECT_THAT(ErrorOf(options), HasSubstr("--frame-rate"));
}

TEST_F(VideoTest, TakesStampsFromTheListBesideIt) {
  std::string list = "timestamp [ns],exposure\n";
  for (int k = 0; k < kNumFrames; ++k) list += std::to_string(1'000'000'000 + 7 * k) + ",5\n";
  folder_.Write("cam0.csv", list);
  EXPECT_EQ(Frames(OpenRecording(path_, {})).list[3].stamp.nanoseconds(), 1'000'000'021);
  folder_.Write("cam0.csv", list + "2000000000\n");
  EXPECT_THAT(ErrorOf(), AllOf(HasSubstr("201 stamps"), HasSubstr("200 frames")));
  folder_.Write("cam0.csv", "5\n5\n");
  EXPECT_THAT(ErrorOf(), AllOf(HasSubstr("cam0.csv line 2"), HasSubstr("ascend")));
  folder_.Write("cam0.csv", "5\n6.5\n");
  EXPECT_THAT(ErrorOf(), HasSubstr("'6.5'"));
}

TEST_F(VideoTest, StandsInAFolderBesideItsImu) {
  folder_.Write("imu0.csv", "5,1,2,3,4,5,6\n");
  const Recording recording = OpenRecording(folder_.path(), {});
  EXPECT_EQ(recording.cameras.at(0).name, "cam0");
  EXPECT_EQ(Frames(recording).list.size(), static_cast<size_t>(kNumFrames));
  EXPECT_EQ(recording.imus.size(), 1U);
  WriteVideo(folder_.path() + "/cam2.avi");
  EXPECT_THAT(InputErrorOf([&] { static_cast<void>(OpenRecording(folder_.path(), {})); }),
              AllOf(HasSubstr("cam2.avi"), HasSubstr("no video cam1")));
}

TEST_F(VideoTest, RefusesOptionsThatChooseNothing) {
  RecordingOptions options;
  options.image_globs = {"*.png"};
  EXPECT_THAT(ErrorOf(options), AllOf(HasSubstr("--images"), HasSubstr("a video")));
  TestFolder photos;
  photos.Write("left.png", "");
  RecordingOptions topics;
  topics.imu_globs = {"/imu"};
  EXPECT_THAT(InputErrorOf([&] { static_cast<void>(OpenRecording(photos.path(), topics)); }),
              AllOf(HasSubstr("--imu-topic"), HasSubstr("a folder")));
}

TEST_F(VideoTest, RefusesWhatIsNoVideo) {
  const std::string whole = ReadFile(path_);
  folder_.Write("cam0.avi", whole.substr(0, 100));
  EXPECT_THAT(ErrorOf(), AllOf(HasSubstr("cam0.avi"), HasSubstr("FFmpeg")));
  folder_.Write("cam0.avi", "RIFF....AVI ");
  EXPECT_NE(ErrorOf(), "");
}

}  // namespace
}  // namespace calibrato
