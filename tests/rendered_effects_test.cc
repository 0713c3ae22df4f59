// What the effects of real lenses, stands, cameras and hands do to rendered images: the board is
// found where they put it.

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <variant>
#include <vector>

#include "calibrato/calibration/camera_calibration.h"
#include "calibrato/detection/detect.h"
#include "calibrato/motion/paper_scene.h"
#include "calibrato/simulation/fast_simulation.h"
#include "calibrato/simulation/frame_exposure.h"
#include "calibrato/simulation/rendered_camera.h"
#include "calibrato/simulation/swaying_board.h"

namespace calibrato {
namespace {

// As sharp as a real lens: corners of images that are sharper are found less well.
Rig SharpRig() {
  Rig rig = PaperRig();
  rig.image_disturbances.defocus_px = 0.5;
  return rig;
}

CarrierPath Path(Carrier carrier, Motion motion) {
  motion.carrier = carrier;
  return PlannedPath(std::get<TimedMotion>(PlanMotion(motion, PaperRig())));
}
CarrierPath Moving() { return Path(Carrier::kFree, HandcraftedMotion(Task::kExtrinsic)); }

// Root mean square, over corners, of found - expected at one instant [px].
template <typename Expected>
double ErrorAt(const Rig& rig, const BoardView& view, const Rigid3& T_c_g,
               const Expected& displacement) {
  double squares = 0.0;
  for (Eigen::Index k = 0; k < view.num_corners(); ++k) {
    const Eigen::Vector2d modelled = *rig.cameras[0].model.Project(T_c_g * view.points_g.col(k));
    squares += (view.pixels.col(k) - modelled - displacement(modelled)).squaredNorm();
  }
  return std::sqrt(squares / (2.0 * static_cast<double>(view.num_corners())));
}

const auto kNowhere = [](const Eigen::Vector2d&) -> Eigen::Vector2d {
  return Eigen::Vector2d::Zero();
};

TEST(RenderedLensResidual, DisplacesTheBoardByItsField) {
  Rig rig = SharpRig();
  rig.lens_residual = {.rms_px = 0.2, .seed = 4};
  const LensField field(rig.lens_residual, rig.cameras[0].resolution);
  const auto by_field = [&](const Eigen::Vector2d& pixel) { return field.At(pixel); };
  const CarrierPath path = Moving();
  const RenderedCamera camera(rig);
  Rng noise(1);
  for (const double t_s : {0.7, 2.2}) {
    const auto view = DetectBoard(camera.Take(path, t_s, noise), rig.board);
    ASSERT_TRUE(view);
    const Rigid3 T_c_g = BoardInCamera(rig, path.at(t_s).T_b_e);
    EXPECT_LT(ErrorAt(rig, *view, T_c_g, by_field), 0.01);
    EXPECT_GT(ErrorAt(rig, *view, T_c_g, kNowhere), 0.05);
  }
}

// The size is that of the field; a camera model takes up some of it, and can't take up most.
TEST(LensResidual, IsWhatNoModelFits) {
  for (const int64_t seed : {1, 2, 3}) {
    Rig rig = PaperRig();
    rig.corner_noise.stddev_px = 0.0;
    rig.lens_residual = {.rms_px = 0.1, .seed = seed};
    Rng rng(1);
    CameraProblem problem;
    problem.model = "pinhole-radtan5";
    problem.resolution = rig.cameras[0].resolution;
    problem.views =
        SimulateFrames(rig, Path(Carrier::kFree, HandcraftedMotion(Task::kIntrinsic)), Time(), rng)
            .views;
    const CameraCalibration calibration = CalibrateCamera(problem);
    ASSERT_EQ(calibration.termination, Termination::kConverged);
    EXPECT_GT(calibration.noise_stddev_px, 0.03);
    EXPECT_LT(calibration.noise_stddev_px, 0.12);
  }
}

TEST(RenderedStandMotion, TheBoardIsWhereItsStandIs) {
  Rig rig = SharpRig();
  rig.stand_motion_m = 2e-3;
  const CarrierPath path = Moving();
  const RenderedCamera camera(rig);
  Rng noise(1);
  const double t_s = 2.75;
  const auto view = DetectBoard(camera.Take(path, t_s, noise), rig.board);
  ASSERT_TRUE(view);
  EXPECT_LT(ErrorAt(rig, *view, BoardInCamera(rig, path, t_s), kNowhere), 0.01);
  EXPECT_GT(ErrorAt(rig, *view, BoardInCamera(rig, path.at(t_s).T_b_e), kNowhere), 0.2);
}

TEST(RenderedVaryingExposure, ImagesAreOfTheTrueMiddle) {
  Rig rig = SharpRig();
  rig.exposure_s = 0.02;
  rig.camera_rate_hz = 0.6;
  rig.image_disturbances.exposure_variation = 0.8;
  const CarrierPath path = Moving();
  const Time start = Time::FromNanoseconds(1'000'000'000);
  int num_found = 0;
  double longest_shift = 0.0;
  (void)SimulateImages(rig, path, start, Rng(1), [&](const SimulatedImage& frame) {
    const double stamp_s = (frame.stamp - start).seconds();
    EXPECT_NEAR(frame.t_s, ExposureOfFrame(rig, stamp_s).middle_s, 1e-9);
    longest_shift = std::max(longest_shift, std::abs(frame.t_s - stamp_s));
    const auto view = DetectBoard(frame.image, rig.board);
    if (!view) return;
    ++num_found;
    // Of a path that bends while it is exposed the blurred board is not quite that of the middle.
    EXPECT_LT(ErrorAt(rig, *view, BoardInCamera(rig, path.at(frame.t_s).T_b_e), kNowhere), 0.05);
  });
  EXPECT_GE(num_found, 7);
  EXPECT_GT(longest_shift, 0.006);
}

TEST(RenderedFinger, HidesTheBoardBehindIt) {
  Rig rig = SharpRig();
  Motion still;
  still.loops.resize(1);
  const CarrierPath path = Path(Carrier::kArm, still);
  // A finger of 0.2 m is in view from pixel 527 on: it hides a quarter of the board. (Of four
  // corners that are hidden the detector makes nothing.)
  const Rigid3 T_w_c = ArmBaseInWorld() * path.at(0.0).T_b_e * rig.T_e_c0;
  const Eigen::Vector3d middle_w = T_w_c * (1.44 * *rig.cameras[0].model.Unproject({530.0, 240.0}));
  rig.T_w_g.t = middle_w - rig.T_w_g.R * BoardCentre(rig.board);
  Rng noise(1);
  EXPECT_TRUE(DetectBoard(RenderedCamera(rig).Take(path, 0.0, noise), rig.board));
  rig.finger_reach_m = 0.2;
  EXPECT_FALSE(DetectBoard(RenderedCamera(rig).Take(path, 0.0, noise), rig.board));
}

}  // namespace
}  // namespace calibrato
