// From images to extrinsics as a user goes, with nothing handed over but what the stage before
// found: rendered images, corners by the detector, intrinsics from the images of one recording,
// extrinsics from those of another with the intrinsics' covariance as prior.

#include <gtest/gtest.h>

#include <numbers>

#include "calibrato/base/full_sample_for_test.h"
#include "calibrato/calibration/camera_calibration.h"
#include "calibrato/calibration/camera_imu_calibration.h"
#include "calibrato/calibration/synthetic_camera_imu_for_test.h"
#include "calibrato/detection/detect.h"
#include "calibrato/rendering/render_board.h"
#include "honesty.h"
#include "rendered_boards.h"

namespace calibrato {
namespace {

constexpr size_t kNumPhotos = 20;
// Of 8-bit grey levels: enough that errors of corners are those of noise, as in a dim room.
constexpr SensorNoise kSensorNoise{3.0, 0.05};

// A small camera with a lens that distorts, on an IMU that is shaken before a board.
SyntheticCameraImu DrawRig(Rng& rng) {
  SyntheticCameraImu rig;
  const double focal = rng.Uniform(230.0, 290.0);
  rig.model =
      CameraModel("pinhole-radtan", (Eigen::VectorXd(8) << focal, focal * rng.Uniform(0.99, 1.01),
                                     159.5 + rng.Uniform(-5.0, 5.0), 119.5 + rng.Uniform(-5.0, 5.0),
                                     rng.Uniform(-0.25, 0.05), rng.Uniform(-0.02, 0.06),
                                     rng.Uniform(-1e-3, 1e-3), rng.Uniform(-1e-3, 1e-3))
                                        .finished());
  rig.resolution = {320, 240};
  Eigen::Vector<double, 6> mount;
  for (double& entry : mount) entry = rng.Uniform(-1.0, 1.0);
  mount.head<3>() *= 0.1;
  mount.tail<3>() *= 0.03;
  rig.T_c_i[0] = rig.T_c_i[0].Perturbed(mount);
  rig.time_offset_s[0] = rng.Uniform(-0.02, 0.02);
  rig.duration_s = 8.0;
  rig.camera_rate_hz = 10.0;
  rig.rotation = 0.8;
  return rig;
}

BoardPlace DrawPlace(Rng& rng) {
  BoardPlace place;
  place.pixel = {rng.Uniform(95.0, 225.0), rng.Uniform(75.0, 165.0)};
  place.distance_m = rng.Uniform(0.5, 0.9);
  place.tilt = rng.Uniform(0.0, 0.7);
  place.tilt_axis = rng.Uniform(0.0, 2.0 * std::numbers::pi);
  place.roll = rng.Uniform(-0.6, 0.6);
  return place;
}

// What the detector finds in the image of a board.
std::optional<BoardView> Seen(const SyntheticCameraImu& rig, const BoardPattern& pattern,
                              const Camera& camera, const Rigid3& T_c_g, Rng& rng) {
  return DetectBoard(
      Digitised(RenderBoard(pattern, camera, T_c_g, SceneForTest()), kSensorNoise, rng), rig.board);
}

// Photos of the board, without those in which the detector misses it.
CameraProblem PhotosBy(const SyntheticCameraImu& rig, const BoardPattern& pattern,
                       const Camera& camera, Rng& rng) {
  CameraProblem problem;
  problem.model = "pinhole-radtan";
  problem.resolution = rig.resolution;
  for (size_t photo = 0; photo < 3 * kNumPhotos && problem.views.size() < kNumPhotos; ++photo) {
    const Rigid3 T_c_g = PoseOf(rig.board, camera, DrawPlace(rng));
    if (auto view = Seen(rig, pattern, camera, T_c_g, rng)) problem.views.push_back(*view);
  }
  return problem;
}

CameraImuProblem RecordedBy(const SyntheticCameraImu& rig, const BoardPattern& pattern,
                            const Camera& camera, Rng& rng) {
  CameraImuProblem problem = rig.Problem(rng);
  std::vector<BoardView>& views = problem.cameras[0].views;
  views.clear();
  for (int k = 0; k < rig.duration_s * rig.camera_rate_hz; ++k) {
    const double t_c = 0.0123 + k / rig.camera_rate_hz;
    const Rigid3 T_c_g = rig.T_c_i[0] * rig.PoseAt(t_c + rig.time_offset_s[0]).Inverse();
    auto view = Seen(rig, pattern, camera, T_c_g, rng);
    if (!view) continue;
    view->stamp = rig.epoch + Duration::FromSeconds(t_c);
    views.push_back(*view);
  }
  return problem;
}

TEST(CalibrateCameraImu, IsHonestFromRenderedImages) {
  const int n = FullSample() ? 400 : 6;
  Honesty honesty;
  for (int i = 0; i < n; ++i) {
    Rng rng(static_cast<uint64_t>(200'000 + i));
    const SyntheticCameraImu rig = DrawRig(rng);
    const Camera camera{rig.model, rig.resolution, "", std::nullopt};
    const BoardPattern pattern = PatternOf(rig.board);
    const CameraProblem photos = PhotosBy(rig, pattern, camera, rng);
    ASSERT_EQ(photos.views.size(), kNumPhotos) << i;
    const CameraCalibration intrinsics = CalibrateCamera(photos);
    ASSERT_EQ(intrinsics.termination, Termination::kConverged) << i;
    CameraImuProblem problem = RecordedBy(rig, pattern, camera, rng);
    ASSERT_GT(problem.cameras[0].views.size(), 40U) << i;
    problem.cameras[0].model = *intrinsics.model;
    problem.cameras[0].intrinsics = IntrinsicsKnowledge::kPrior;
    problem.cameras[0].intrinsics_covariance = intrinsics.covariance;
    CameraImuOptions options;
    options.knot_spacing_s = 0.05;
    const CameraImuCalibration result = CalibrateCameraImu(problem, options);
    ASSERT_EQ(result.termination, Termination::kConverged) << i;
    honesty.Add(result, rig.T_c_i[0], rig.time_offset_s[0]);
  }
  honesty.Expect();
}

}  // namespace
}  // namespace calibrato
