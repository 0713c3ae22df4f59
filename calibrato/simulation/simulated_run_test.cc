#include "calibrato/simulation/simulated_run.h"

#include <gtest/gtest.h>

#include <cmath>
#include <variant>

#include "calibrato/base/input_error.h"
#include "calibrato/base/parallel.h"
#include "calibrato/motion/paper_scene.h"
#include "calibrato/sensors/effects.h"

namespace calibrato {
namespace {

const Time kStart = Time::FromNanoseconds(1'600'000'000'000'000'000);

TimedMotion Handcrafted(Carrier carrier) {
  Motion motion = HandcraftedMotion(Task::kExtrinsic);
  motion.carrier = carrier;
  return std::get<TimedMotion>(PlanMotion(motion, PaperRig()));
}

TEST(SimulateRun, PhysicalCornersAndSamplesAreThoseOfTheExecutedPath) {
  Rig rig = PaperRig();
  rig.corner_noise = {
      .stddev_px = 0.0, .blur_factor = 0.0, .blur_at_half = 0.5, .blur_slope = 0.05};
  rig.imu_noise = {200.0, 0.0, 0.0, 0.0, 0.0};
  const SimulatedRun run =
      SimulateRun(rig, Handcrafted(Carrier::kArm), Fidelity::kPhysical, kStart, Rng(3));
  ASSERT_EQ(run.frames.views.size(), 150u);
  const Eigen::Matrix3Xd points_g = BoardPoints(rig.board);
  for (const BoardView& view : run.frames.views) {
    const CarrierState state = run.path.at((view.stamp - kStart).seconds());
    const Rigid3 T_c0_g = BoardInCamera(rig, state.T_b_e);
    for (Eigen::Index k = 0; k < points_g.cols(); ++k) {
      EXPECT_LT(
          (view.pixels.col(k) - *rig.cameras[0].model.Project(T_c0_g * points_g.col(k))).norm(),
          1e-9);
    }
  }
  for (size_t k = 0; k < run.imu.stream.gyro.size(); k += 50) {
    const ImuMotion motion = ImuMotionAt(rig, run.path, 0.005 * static_cast<double>(k));
    EXPECT_LT((run.imu.stream.gyro[k].value - motion.omega_i).norm(), 1e-12);
  }
}

TEST(SimulateRun, ThePhysicalArmComesCloseToItsPlanButNotExactly) {
  const TimedMotion motion = Handcrafted(Carrier::kArm);
  const SimulatedRun run = SimulateRun(PaperRig(), motion, Fidelity::kPhysical, kStart, Rng(3));
  ASSERT_TRUE(run.tracking);
  EXPECT_LT(run.tracking->max_position_error_m, 0.005);
  EXPECT_GT(run.tracking->max_position_error_m, 1e-6);
  EXPECT_LT(run.tracking->max_torque_share, 1.0);
  EXPECT_GT(run.tracking->max_torque_share, 0.1);
  EXPECT_FALSE(SimulateRun(PaperRig(), motion, Fidelity::kFast, kStart, Rng(3)).tracking);
}

// Everything that a run draws and moves, at once on two threads and one after the other.
TEST(SimulateRun, TheNumberOfThreadsChangesNoByte) {
  Rig rig = PaperRig();
  rig.camera_rate_hz = 0.4;
  Motion one_loop = HandcraftedMotion(Task::kExtrinsic);
  one_loop.carrier = Carrier::kArm;
  one_loop.loops.resize(1);
  SwitchOnEffects("all", &rig);
  const TimedMotion motion = std::get<TimedMotion>(PlanMotion(one_loop, rig));
  for (const Fidelity fidelity : {Fidelity::kPhysical, Fidelity::kRendered}) {
    const auto run_all = [&](int num_threads) {
      SetNumThreads(num_threads);
      return ParallelMap<SimulatedRun>(
          2, [&](size_t i) { return SimulateRun(rig, motion, fidelity, kStart, Rng(i)); });
    };
    const std::vector<SimulatedRun> one = run_all(1);
    const std::vector<SimulatedRun> two = run_all(2);
    SetNumThreads(0);
    for (size_t i = 0; i < one.size(); ++i) {
      ASSERT_EQ(one[i].images.size(), two[i].images.size());
      for (size_t k = 0; k < one[i].images.size(); ++k) {
        EXPECT_EQ(one[i].images[k].stamp, two[i].images[k].stamp);
        EXPECT_TRUE(one[i].images[k].png == two[i].images[k].png) << i << " " << k;
      }
      ASSERT_EQ(one[i].frames.views.size(), two[i].frames.views.size());
      for (size_t k = 0; k < one[i].frames.views.size(); ++k) {
        EXPECT_EQ(one[i].frames.views[k].pixels, two[i].frames.views[k].pixels);
      }
      ASSERT_EQ(one[i].imu.stream.gyro.size(), two[i].imu.stream.gyro.size());
      EXPECT_EQ(one[i].imu.stream.gyro.back().value, two[i].imu.stream.gyro.back().value);
      EXPECT_EQ(one[i].imu.stream.accel.back().value, two[i].imu.stream.accel.back().value);
    }
    EXPECT_NE(two[0].imu.stream.gyro.back().value, two[1].imu.stream.gyro.back().value);
  }
}

TEST(SimulateRun, RefusesDynamicsWithoutAnArm) {
  EXPECT_THROW((void)SimulateRun(PaperRig(), Handcrafted(Carrier::kFree), Fidelity::kPhysical,
                                 kStart, Rng(3)),
               InputError);
}

TEST(Fidelity, HasNamesAndKnowsThem) {
  for (const Fidelity fidelity : {Fidelity::kFast, Fidelity::kPhysical, Fidelity::kRendered}) {
    EXPECT_EQ(FidelityFromName(FidelityName(fidelity)), fidelity);
  }
  EXPECT_THROW((void)FidelityFromName("quick"), InputError);
}

}  // namespace
}  // namespace calibrato
