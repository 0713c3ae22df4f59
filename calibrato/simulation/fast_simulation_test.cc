#include "calibrato/simulation/fast_simulation.h"

#include <gtest/gtest.h>

#include <cmath>

#include "calibrato/motion/paper_scene.h"

namespace calibrato {
namespace {

TimedMotion Plan(const Motion& motion, const Rig& rig) {
  return std::get<TimedMotion>(PlanMotion(motion, rig));
}

TEST(SimulateFrames, TakesTenFramesASecond) {
  const Rig rig = PaperRig();
  Motion still;
  still.loops.resize(2);
  Rng rng(1);
  const SimulatedFrames frames =
      SimulateFrames(rig, Plan(still, rig), Time::FromNanoseconds(1'000'000'000), rng);
  EXPECT_EQ(frames.num_frames, 100);
  ASSERT_EQ(frames.views.size(), 100U);
  EXPECT_EQ(frames.views[0].stamp.nanoseconds(), 1'000'000'000);
  EXPECT_EQ(frames.views[13].stamp.nanoseconds(), 2'300'000'000);
}

TEST(SimulateFrames, TakesFramesAtTheRigsRate) {
  Rig rig = PaperRig();
  rig.camera_rate_hz = 30.0;
  Motion still;
  still.loops.resize(2);
  Rng rng(1);
  const SimulatedFrames frames =
      SimulateFrames(rig, Plan(still, rig), Time::FromNanoseconds(1'000'000'000), rng);
  EXPECT_EQ(frames.num_frames, 300);
  ASSERT_EQ(frames.views.size(), 300U);
  // Whole nanoseconds, whose rounding does not add up.
  EXPECT_EQ(frames.views[1].stamp.nanoseconds(), 1'033'333'333);
  EXPECT_EQ(frames.views[299].stamp.nanoseconds(), 1'000'000'000 + 9'966'666'667);
}

TEST(SimulateFrames, NoiseHasTheStatedSigmaAboutTheTrueProjection) {
  Rig rig = PaperRig();
  rig.corner_noise.stddev_px = 0.3;
  Motion still;
  still.loops.resize(1);
  Rng rng(2);
  const SimulatedFrames frames = SimulateFrames(rig, Plan(still, rig), Time(), rng);
  double sum = 0.0;
  double count = 0.0;
  for (size_t v = 0; v < frames.views.size(); ++v) {
    for (Eigen::Index k = 0; k < 42; ++k) {
      const auto pixel =
          rig.cameras[0].model.Project(frames.T_c0_g[v] * frames.views[v].points_g.col(k));
      sum += (*pixel - frames.views[v].pixels.col(k)).squaredNorm();
      count += 2.0;
    }
  }
  // Four standard errors of a variance from `count` draws.
  EXPECT_NEAR(sum / count, 0.09, 4.0 * 0.09 * std::sqrt(2.0 / count));
}

TEST(SimulateFrames, LosesTheBoardWhereItLeavesTheImage) {
  const Rig rig = PaperRig();
  Rng rng(3);
  const SimulatedFrames frames =
      SimulateFrames(rig, Plan(HandcraftedMotion(Task::kIntrinsic), rig), Time(), rng);
  EXPECT_EQ(frames.num_frames, static_cast<int>(frames.views.size()) + frames.num_out_of_image);
  for (const BoardView& view : frames.views) {
    EXPECT_GT(view.pixels.minCoeff(), -1.0);
    EXPECT_LT(view.pixels.row(0).maxCoeff(), 640.0);
  }
}

TEST(SimulateFrames, BlurRaisesTheNoiseAndLosesBoards) {
  Rig rig = PaperRig();
  const TimedMotion motion = Plan(HandcraftedMotion(Task::kExtrinsic), rig);
  const auto rms_of = [&](double exposure_s, int* num_lost) {
    rig.exposure_s = exposure_s;
    Rng rng(4);
    const SimulatedFrames frames = SimulateFrames(rig, motion, Time(), rng);
    *num_lost = frames.num_lost_to_blur;
    double sum = 0.0;
    for (size_t v = 0; v < frames.views.size(); ++v) {
      for (Eigen::Index k = 0; k < 42; ++k) {
        const auto pixel =
            rig.cameras[0].model.Project(frames.T_c0_g[v] * frames.views[v].points_g.col(k));
        sum += (*pixel - frames.views[v].pixels.col(k)).squaredNorm();
      }
    }
    return std::sqrt(sum / (84.0 * static_cast<double>(frames.views.size())));
  };
  int lost_sharp = 0;
  int lost_blurred = 0;
  int lost_smeared = 0;
  const double sharp = rms_of(0.0, &lost_sharp);
  const double blurred = rms_of(0.05, &lost_blurred);
  (void)rms_of(0.2, &lost_smeared);
  EXPECT_NEAR(sharp, 0.1, 0.005);
  EXPECT_GT(blurred, 1.2 * sharp);
  EXPECT_EQ(lost_sharp, 0);
  EXPECT_GT(lost_smeared, 10);
  EXPECT_LT(lost_blurred, lost_smeared);
}

TEST(SimulateFrames, IsTheSameForTheSameSeed) {
  const Rig rig = PaperRig();
  const TimedMotion motion = Plan(HandcraftedMotion(Task::kExtrinsic), rig);
  Rng a(5);
  Rng b(5);
  Rng c(6);
  const auto first = SimulateFrames(rig, motion, Time(), a);
  const auto second = SimulateFrames(rig, motion, Time(), b);
  const auto third = SimulateFrames(rig, motion, Time(), c);
  EXPECT_EQ(first.views[7].pixels, second.views[7].pixels);
  EXPECT_NE(first.views[7].pixels, third.views[7].pixels);
}

}  // namespace
}  // namespace calibrato
