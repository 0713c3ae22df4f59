#include "calibrato/diagnosis/recording_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <utility>

#include "calibrato/calibration/synthetic_camera_imu_for_test.h"
#include "calibrato/diagnosis/check_document.h"

namespace calibrato {
namespace {

using testing::HasSubstr;

// A list of corners and an IMU; what is known of them differs.
RecordingToCheck Shaken() {
  SyntheticCameraImu rig;
  Rng rng(2);
  CameraImuProblem problem = rig.Problem(rng);
  CameraToCheck camera;
  camera.name = "cam0";
  camera.has_images = false;
  camera.was_searched = true;
  camera.resolution = rig.resolution;
  camera.views = problem.cameras[0].views;
  for (const BoardView& view : camera.views) camera.stamps.push_back(view.stamp);
  camera.model = rig.model;
  RecordingToCheck recording;
  recording.cameras.push_back(std::move(camera));
  recording.imus.push_back({{"imu0", std::move(problem.imus[0].stream)}, rig.imu_noise});
  return recording;
}

TEST(CheckRecording, HasNothingToSayOfAGoodOne) {
  const RecordingCheck check = CheckRecording(Shaken());
  for (const Finding& finding : check.findings) ADD_FAILURE() << finding.what;
  EXPECT_EQ(check.streams.size(), 3U);
  EXPECT_EQ(check.clocks.size(), 1U);
  EXPECT_EQ(check.expected.size(), 7U);
  ASSERT_EQ(check.boards.size(), 1U);
  ASSERT_TRUE(check.boards[0].travel_m.has_value());
  // Sums of sines of 0.05, 0.025 and 0.017 m to either side.
  EXPECT_GT(check.boards[0].travel_m->minCoeff(), 0.08);
  EXPECT_LT(check.boards[0].travel_m->maxCoeff(), 0.19);
}

// Without --cameras the lens is to be calibrated from this recording as well.
TEST(CheckRecording, ExpectsIntrinsicsWhereTheyAreNotKnown) {
  RecordingToCheck recording = Shaken();
  recording.cameras[0].model = std::nullopt;
  const RecordingCheck check = CheckRecording(recording);
  ASSERT_EQ(check.expected.size(), 8U + 7U);
  EXPECT_EQ(check.expected[0].name, "cam0.fu");
  EXPECT_EQ(check.clocks.size(), 1U);
}

// A camera that stood still beside an IMU that was shaken: of another IMU's recording.
TEST(CheckRecording, ExpectsNothingWhereCameraAndImuDidNotMoveTogether) {
  RecordingToCheck recording = Shaken();
  SyntheticCameraImu other;
  other.slowest_rad_s = 3.1;
  other.rotation_of_axis = Eigen::Vector3d(-1.0, 0.3, 2.0);
  Rng rng(5);
  recording.imus[0].recording.stream = std::move(other.Problem(rng).imus[0].stream);
  const RecordingCheck check = CheckRecording(recording);
  ASSERT_EQ(check.clocks.size(), 1U);
  ASSERT_LT(check.clocks[0].comparison.correlation, 0.4);
  EXPECT_GE(VerdictOf(check.findings), Verdict::kInconclusive);
  EXPECT_TRUE(check.expected.empty());
}

TEST(CheckRecording, TakesCamerasAlone) {
  RecordingToCheck recording = Shaken();
  recording.imus.clear();
  const RecordingCheck check = CheckRecording(recording);
  EXPECT_TRUE(check.findings.empty());
  EXPECT_EQ(check.boards.size(), 1U);
  EXPECT_TRUE(check.expected.empty());
}

// Photos of a camera alone may be far apart in time.
TEST(CheckRecording, TakesFewPhotos) {
  RecordingToCheck recording = Shaken();
  recording.imus.clear();
  CameraToCheck& camera = recording.cameras[0];
  camera.model = std::nullopt;
  const std::vector<BoardView> all = std::exchange(camera.views, {});
  camera.stamps.clear();
  for (size_t k = 0; k < all.size(); k += 25) {
    camera.views.push_back(all[k]);
    camera.views.back().stamp = all[0].stamp + Duration::FromSeconds(0.2 * static_cast<double>(k));
    camera.stamps.push_back(camera.views.back().stamp);
  }
  EXPECT_LT(VerdictOf(CheckRecording(recording).findings), Verdict::kFail);
  camera.views.resize(2);
  const RecordingCheck two = CheckRecording(recording);
  EXPECT_EQ(VerdictOf(two.findings), Verdict::kFail);
  EXPECT_THAT(two.findings.front().what, HasSubstr("cam0 saw the board in 2 images only, 3 are"));
}

TEST(CheckRecording, TakesImusAlone) {
  RecordingToCheck recording = Shaken();
  recording.cameras.clear();
  const RecordingCheck check = CheckRecording(recording);
  EXPECT_TRUE(check.findings.empty());
  EXPECT_EQ(check.streams.size(), 2U);
  EXPECT_EQ(check.motions.size(), 1U);
}

// Images that were not searched have stamps all the same.
TEST(CheckRecording, TakesStampsWithoutABoard) {
  RecordingToCheck recording = Shaken();
  CameraToCheck& camera = recording.cameras[0];
  camera.has_images = true;
  camera.was_searched = false;
  camera.views.clear();
  camera.stamps.erase(camera.stamps.begin() + 50, camera.stamps.begin() + 70);
  const RecordingCheck check = CheckRecording(recording);
  ASSERT_EQ(check.findings.size(), 1U);
  EXPECT_THAT(check.findings[0].what, HasSubstr("cam0: about 20 images are missing"));
  EXPECT_EQ(check.VerdictOn("cam0"), Verdict::kWarn);
  EXPECT_EQ(check.VerdictOn("imu0"), Verdict::kPass);
}

// Of 200 images every fourth was searched, and the board found in ten of these fifty.
TEST(CheckRecording, CountsTheImagesThatWereSearched) {
  RecordingToCheck recording = Shaken();
  CameraToCheck& camera = recording.cameras[0];
  camera.has_images = true;
  const std::vector<BoardView> all = std::exchange(camera.views, {});
  for (size_t k = 0; k < all.size(); k += 4) {
    if (k < 40) {
      camera.views.push_back(all[k]);
    } else {
      camera.stamps_without_board.push_back(all[k].stamp);
    }
  }
  const RecordingCheck check = CheckRecording(recording);
  ASSERT_EQ(check.boards.size(), 1U);
  EXPECT_EQ(check.boards[0].num_images, 50U);
  EXPECT_THAT(check.findings.back().what + check.findings.front().what,
              HasSubstr("cam0: the board is in 10 of 50 images only"));
}

TEST(CheckRecording, PutsTheWorstFirst) {
  RecordingToCheck recording = Shaken();
  std::vector<VectorSample>& gyro = recording.imus[0].recording.stream.gyro;
  gyro[100].stamp = gyro[99].stamp;
  for (VectorSample& sample : recording.imus[0].recording.stream.accel) sample.value /= 9.80665;
  const RecordingCheck check = CheckRecording(recording);
  ASSERT_GE(check.findings.size(), 2U);
  EXPECT_THAT(check.findings.front().what, HasSubstr("it is in g"));
  EXPECT_THAT(check.findings.back().what, HasSubstr("repeat the stamp"));
  EXPECT_EQ(check.VerdictOn("imu0 gyroscope"), Verdict::kWarn);
  EXPECT_EQ(check.VerdictOn("imu0 accelerometer"), Verdict::kFail);
  EXPECT_EQ(check.VerdictOn("imu0"), Verdict::kFail);
  EXPECT_TRUE(check.expected.empty());
}

TEST(VerdictOn, KeepsImu1ApartFromImu10) {
  RecordingCheck check;
  check.findings = {{Severity::kFail, "imu10: broken", ""}};
  EXPECT_EQ(check.VerdictOn("imu1"), Verdict::kPass);
  EXPECT_EQ(check.VerdictOn("imu10"), Verdict::kFail);
}

TEST(CheckResult, HoldsWhatWasFound) {
  const RecordingToCheck recording = Shaken();
  const RecordingCheck check = CheckRecording(recording);
  const Value result = CheckResult(recording, check);
  EXPECT_EQ(result.At("kind").AsString(), "check");
  EXPECT_EQ(result.At("verdict").AsString(), "pass");
  EXPECT_NEAR(result.At("streams").elements()[1].At("rate_hz").AsDouble(), 200.0, 1e-6);
  EXPECT_EQ(result.At("boards").elements()[0].At("num_with_board").AsInt(),
            static_cast<int64_t>(recording.cameras[0].views.size()));
  EXPECT_TRUE(result.At("motions").elements()[0].Find("rest") == nullptr);
  EXPECT_EQ(result.At("expected").size(), 7U);
  const Value plots = CheckPlots(recording, check);
  EXPECT_EQ(plots.At("imus").size(), 1U);
  EXPECT_EQ(plots.At("intervals").size(), 3U);
  EXPECT_EQ(plots.At("cameras").elements()[0].At("time_s").size(),
            recording.cameras[0].stamps.size());
  const std::string text = CheckText(recording, check);
  EXPECT_THAT(text, HasSubstr("verdict: pass"));
  EXPECT_THAT(text, HasSubstr("cam0.rot_x"));
}

}  // namespace
}  // namespace calibrato
