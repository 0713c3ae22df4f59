// What the effects of real cameras and stands do to corners at fidelity `fast`: each of the size
// that was asked for.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <variant>

#include "calibrato/motion/paper_scene.h"
#include "calibrato/simulation/fast_simulation.h"
#include "calibrato/simulation/frame_exposure.h"
#include "calibrato/simulation/swaying_board.h"

namespace calibrato {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

const Time kStart = Time::FromNanoseconds(1'000'000'000'000);

Rig NoiselessRig() {
  Rig rig = PaperRig();
  rig.corner_noise.stddev_px = 0.0;
  rig.corner_noise.blur_factor = 0.0;
  return rig;
}

CarrierPath Path(Carrier carrier, Motion motion) {
  motion.carrier = carrier;
  return PlannedPath(std::get<TimedMotion>(PlanMotion(motion, PaperRig())));
}
CarrierPath Moving() { return Path(Carrier::kFree, HandcraftedMotion(Task::kExtrinsic)); }
CarrierPath Hovering() {
  Motion still;
  still.loops.resize(1);
  return Path(Carrier::kFree, still);
}

SimulatedFrames Frames(const Rig& rig, const CarrierPath& path, uint64_t seed = 1) {
  Rng rng(seed);
  return SimulateFrames(rig, path, kStart, rng);
}

Vector2d Projected(const Rig& rig, const Rigid3& T_c_g, const Vector3d& p_g) {
  return *rig.cameras[0].model.Project(T_c_g * p_g);
}

TEST(PhaseError, IsASineOfThePlaceWithinThePixel) {
  Rig rig = NoiselessRig();
  rig.corner_noise.phase_error_px = 0.05;
  const SimulatedFrames frames = Frames(rig, Moving());
  double squares = 0.0;
  double n = 0.0;
  for (size_t v = 0; v < frames.views.size(); ++v) {
    for (Eigen::Index k = 0; k < frames.views[v].num_corners(); ++k) {
      const Vector2d truth = Projected(rig, frames.T_c0_g[v], frames.views[v].points_g.col(k));
      const Vector2d error = frames.views[v].pixels.col(k) - truth;
      for (int axis = 0; axis < 2; ++axis) {
        EXPECT_NEAR(error[axis], 0.05 * std::sin(2.0 * std::numbers::pi * truth[axis]), 1e-9);
      }
      squares += error.squaredNorm();
      n += 2.0;
    }
  }
  EXPECT_GT(n, 10'000.0);
  EXPECT_NEAR(std::sqrt(squares / n), 0.05 / std::numbers::sqrt2, 0.001);
}

TEST(PhaseError, IsTheSameInEveryFrameOfACameraThatHovers) {
  Rig rig = NoiselessRig();
  rig.corner_noise.phase_error_px = 0.05;
  const SimulatedFrames frames = Frames(rig, Hovering());
  for (const BoardView& view : frames.views) EXPECT_EQ(view.pixels, frames.views[0].pixels);
}

TEST(LensResidual, DisplacesCornersByItsField) {
  Rig rig = NoiselessRig();
  rig.lens_residual = {.rms_px = 0.2, .seed = 4};
  const LensField field(rig.lens_residual, rig.cameras[0].resolution);
  const SimulatedFrames frames = Frames(rig, Moving());
  double largest = 0.0;
  for (size_t v = 0; v < frames.views.size(); ++v) {
    for (Eigen::Index k = 0; k < frames.views[v].num_corners(); ++k) {
      const Vector2d truth = Projected(rig, frames.T_c0_g[v], frames.views[v].points_g.col(k));
      const Vector2d error = frames.views[v].pixels.col(k) - truth;
      EXPECT_LT((error - field.At(truth)).norm(), 1e-9);
      largest = std::max(largest, error.norm());
    }
  }
  EXPECT_GT(largest, 0.2);
}

// Beginning at its place, and as far away as it should be over a long time.
TEST(StandMotion, HasTheStatedRootMeanSquareAndBeginsAtItsPlace) {
  Rig rig = PaperRig();
  rig.stand_motion_m = 2e-4;
  EXPECT_EQ(BoardInWorld(rig, 0.0).t, rig.T_w_g.t);
  double squares = 0.0;
  // All three periods in whole: 11 * 17 * 23 s.
  constexpr int kNumSamples = 43'010;
  for (int k = 0; k < kNumSamples; ++k) {
    const Rigid3 T_w_g = BoardInWorld(rig, 0.1 * k);
    EXPECT_EQ(T_w_g.R, rig.T_w_g.R);
    squares += (T_w_g.t - rig.T_w_g.t).squaredNorm();
  }
  EXPECT_NEAR(std::sqrt(squares / kNumSamples), 2e-4, 1e-9);
}

TEST(StandMotion, MovesTheCornersOfACameraThatHovers) {
  Rig rig = NoiselessRig();
  rig.stand_motion_m = 2e-4;
  const CarrierPath path = Hovering();
  const SimulatedFrames frames = Frames(rig, path);
  // 0.2 mm in 1.44 m at f = 586 px: 0.08 px.
  double largest = 0.0;
  for (size_t v = 0; v < frames.views.size(); ++v) {
    const Rigid3 T_c0_g = (ArmBaseInWorld() * path.at(0.0).T_b_e * rig.T_e_c0).Inverse() *
                          BoardInWorld(rig, 0.1 * static_cast<double>(v));
    EXPECT_LT(frames.T_c0_g[v].DifferenceTo(T_c0_g).norm(), 1e-12);
    largest =
        std::max(largest, (frames.views[v].pixels - frames.views[0].pixels).cwiseAbs().maxCoeff());
  }
  EXPECT_GT(largest, 0.04);
  EXPECT_LT(largest, 0.16);
}

TEST(VaryingExposure, LengthensByTheStatedShareAndShiftsTheMiddleByHalfOfThat) {
  Rig rig = PaperRig();
  rig.exposure_s = 0.006;
  rig.image_disturbances.exposure_variation = 0.5;
  double shortest = 1.0;
  double longest = 0.0;
  for (int k = 0; k < 700; ++k) {
    const double stamp_s = 0.01 * k;
    const FrameExposure exposure = ExposureOfFrame(rig, stamp_s);
    shortest = std::min(shortest, exposure.length_s);
    longest = std::max(longest, exposure.length_s);
    // It begins where an exposure of the rig's length would.
    EXPECT_NEAR(exposure.middle_s - 0.5 * exposure.length_s, stamp_s - 0.003, 1e-12);
  }
  EXPECT_NEAR(shortest, 0.003, 1e-6);
  EXPECT_NEAR(longest, 0.009, 1e-6);
  rig.image_disturbances.exposure_variation = 0.0;
  EXPECT_EQ(ExposureOfFrame(rig, 1.3).middle_s, 1.3);
  EXPECT_EQ(ExposureOfFrame(rig, 1.3).length_s, 0.006);
}

TEST(VaryingExposure, CornersAreThoseOfTheTrueMiddleUnderTheStampOfTheOther) {
  Rig rig = NoiselessRig();
  rig.exposure_s = 0.02;
  rig.image_disturbances.exposure_variation = 0.8;
  const CarrierPath path = Moving();
  const SimulatedFrames frames = Frames(rig, path);
  double latest = 0.0;
  for (size_t v = 0; v < frames.views.size(); ++v) {
    const double stamp_s = (frames.views[v].stamp - kStart).seconds();
    const double middle_s = ExposureOfFrame(rig, stamp_s).middle_s;
    const Rigid3 T_c_g = BoardInCamera(rig, path.at(middle_s).T_b_e);
    EXPECT_LT(
        (frames.views[v].pixels.col(7) - Projected(rig, T_c_g, frames.views[v].points_g.col(7)))
            .norm(),
        1e-9);
    latest = std::max(latest, middle_s - stamp_s);
  }
  EXPECT_NEAR(latest, 0.008, 1e-4);
}

// A quick shutter, and the slowest that is done with an image before the next one begins.
TEST(RollingShutter, EachCornerIsWhereItsRowSeesIt) {
  for (const double line_delay_s : {5e-5, 2e-4}) {
    Rig rig = NoiselessRig();
    rig.image_disturbances.line_delay_s = line_delay_s;
    const CarrierPath path = Moving();
    const SimulatedFrames frames = Frames(rig, path);
    double farthest = 0.0;
    for (size_t v = 0; v < frames.views.size(); v += 5) {
      const BoardView& view = frames.views[v];
      const double stamp_s = (view.stamp - kStart).seconds();
      for (Eigen::Index k = 0; k < view.num_corners(); k += 10) {
        const Vector2d pixel = view.pixels.col(k);
        const Rigid3 T_c_g = BoardInCamera(rig, path.at(stamp_s + line_delay_s * pixel.y()).T_b_e);
        EXPECT_LT((Projected(rig, T_c_g, view.points_g.col(k)) - pixel).norm(), 1e-5);
        farthest = std::max(
            farthest, (Projected(rig, frames.T_c0_g[v], view.points_g.col(k)) - pixel).norm());
      }
    }
    EXPECT_GT(farthest, 0.5);
  }
}

TEST(JitterAndDrops, HaveTheStatedSizesAndChangeNoCorner) {
  const CarrierPath path = Moving();
  Rig rig = PaperRig();
  rig.camera_rate_hz = 100.0;
  const SimulatedFrames plain = Frames(rig, path);
  rig.image_disturbances.stamp_jitter_s = 5e-4;
  rig.image_disturbances.drop_probability = 0.1;
  const SimulatedFrames disturbed = Frames(rig, path);
  const int n = plain.num_frames;
  ASSERT_EQ(n, 1500);
  EXPECT_EQ(disturbed.num_frames, n);
  EXPECT_EQ(static_cast<int>(disturbed.views.size()) + disturbed.num_dropped, n);
  // Four standard deviations of a binomial.
  EXPECT_NEAR(disturbed.num_dropped, 0.1 * n, 4.0 * std::sqrt(0.09 * n));
  double squares = 0.0;
  size_t before = 0;
  for (const BoardView& view : disturbed.views) {
    while (plain.views[before].pixels != view.pixels) ASSERT_LT(++before, plain.views.size());
    const double late_s = (view.stamp - plain.views[before].stamp).seconds();
    squares += late_s * late_s;
  }
  const auto m = static_cast<double>(disturbed.views.size());
  EXPECT_NEAR(squares / m, 2.5e-7, 4.0 * 2.5e-7 * std::sqrt(2.0 / m));
}

TEST(Jitter, LeavesStampsInTheOrderOfTheirFrames) {
  Rig rig = PaperRig();
  rig.camera_rate_hz = 100.0;
  rig.image_disturbances.stamp_jitter_s = 0.1;
  const SimulatedFrames frames = Frames(rig, Moving());
  ASSERT_GT(frames.views.size(), 100u);
  for (size_t v = 1; v < frames.views.size(); ++v) {
    EXPECT_LT(frames.views[v - 1].stamp, frames.views[v].stamp) << v;
  }
}

// The finger stands right of the camera's axis: a board on the left is seen whole, one on the right
// is not. By hand, along the axis: its near side is 0.066 - 0.011 m to the right, its tip 0.045 m +
// 0.2 - 0.1 m before the lens, so that it begins at pixel 320 + 586 * 0.055 / 0.156 = 527.
TEST(Finger, HidesWhatIsBehindIt) {
  Rig rig = NoiselessRig();
  rig.finger_reach_m = 0.2;
  Motion still;
  still.loops.resize(1);
  CarrierPath path = Path(Carrier::kArm, still);
  const auto num_seen_at = [&](double u) {
    // The board's middle on the ray of this pixel.
    Rig moved = rig;
    const Rigid3 T_w_c = ArmBaseInWorld() * path.at(0.0).T_b_e * rig.T_e_c0;
    const Vector3d middle_w = T_w_c * (1.44 * *rig.cameras[0].model.Unproject({u, 240.0}));
    moved.T_w_g.t = middle_w - moved.T_w_g.R * BoardCentre(moved.board);
    return Frames(moved, path).views.size();
  };
  EXPECT_EQ(num_seen_at(320.0), 50u);
  EXPECT_EQ(num_seen_at(440.0), 50u);
  EXPECT_EQ(num_seen_at(500.0), 0u);
  path.joints = nullptr;  // no arm, no finger
  EXPECT_EQ(num_seen_at(500.0), 50u);
}

TEST(AprilGridFrames, ShowTheTagsThatAreInside) {
  Rig rig = NoiselessRig();
  rig.board = AprilGrid{6, 6, 0.088, 0.3};
  rig.T_w_g.t -= rig.T_w_g.R * (BoardCentre(rig.board) - BoardCentre(PaperRig().board));
  // 0.66 m at 1.44 m and f = 586 px: 268 px, whole in the first image.
  const SimulatedFrames whole = Frames(rig, Hovering());
  ASSERT_EQ(whole.views.size(), 50u);
  EXPECT_EQ(whole.views[0].num_corners(), 144);
  // Its middle on the image's right edge: some tags are outside, and of a tag all corners or none.
  const Rigid3 T_w_c = ArmBaseInWorld() * Hovering().at(0.0).T_b_e * rig.T_e_c0;
  rig.T_w_g.t += T_w_c.R.col(0) * (1.44 * 320.0 / 586.0);
  const SimulatedFrames parts = Frames(rig, Hovering());
  ASSERT_EQ(parts.views.size(), 50u);
  const BoardView& view = parts.views[0];
  EXPECT_GE(view.num_corners(), 4 * 12);
  EXPECT_LE(view.num_corners(), 4 * 24);
  EXPECT_EQ(view.num_corners() % 4, 0);
  for (Eigen::Index k = 0; k < view.num_corners(); ++k) {
    EXPECT_EQ(view.corner_ids[k] / 4, view.corner_ids[k - k % 4] / 4);
    EXPECT_GE(view.pixels(0, k), 0.0);
    EXPECT_LE(view.pixels(0, k), 639.0);
    EXPECT_EQ(Vector3d(view.points_g.col(k)),
              Vector3d(BoardPoints(rig.board).col(view.corner_ids[k])));
  }
}

// 1 / (1 + e) at one slope beyond the half, whatever the squares' size.
TEST(CornerNoise, LosesBoardsByTheLengthOfTheBlur) {
  const CornerNoise noise{
      .blur_at_half = 10.0, .blur_slope = 0.05, .lost_at_half_px = 10.0, .lost_slope_px = 0.5};
  EXPECT_NEAR(noise.DetectionProbability(10.0, 20.0), 0.5, 1e-12);
  EXPECT_NEAR(noise.DetectionProbability(10.5, 60.0), 1.0 / (1.0 + std::exp(1.0)), 1e-12);
  EXPECT_NEAR(noise.DetectionProbability(9.5, 60.0), 1.0 / (1.0 + std::exp(-1.0)), 1e-12);
  const CornerNoise smeared;
  EXPECT_NEAR(smeared.DetectionProbability(10.0, 20.0), 0.5, 1e-12);
  EXPECT_NEAR(smeared.DetectionProbability(11.0, 20.0), 1.0 / (1.0 + std::exp(1.0)), 1e-12);
}

}  // namespace
}  // namespace calibrato
