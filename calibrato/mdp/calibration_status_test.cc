#include "calibrato/mdp/calibration_status.h"

#include <gtest/gtest.h>

#include <cmath>

#include "calibrato/mdp/frames_that_count.h"
#include "calibrato/mdp/recorded_loop.h"
#include "calibrato/motion/carrier.h"
#include "calibrato/motion/paper_scene.h"

namespace calibrato {
namespace {

RecordedLoop HandcraftedRecording(const Rig& rig, Fidelity fidelity, Carrier carrier) {
  Motion motion = HandcraftedMotion(Task::kExtrinsic);
  motion.carrier = carrier;
  const TimedMotion timed = std::get<TimedMotion>(PlanMotion(motion, rig));
  return RecordLoop(rig, timed, fidelity, Time::FromNanoseconds(1'000'000'000'000), Rng(1),
                    /*want_imu=*/true);
}

TEST(IntrinsicStatus, OfNothingIsThePriors) {
  const Camera camera = PaperRig().cameras.front();
  const IntrinsicStatus status = CalibrateIntrinsics({}, camera, DesignCriterion::kA, 50);
  EXPECT_FALSE(status.model.has_value());
  EXPECT_NEAR(status.information, -0.5 * std::log(2.0 * 34.8 * 34.8 + 200.0), 1e-12);
  EXPECT_EQ(status.reprojection_px, 1.0);
  EXPECT_LT(status.relative_error, 1e-4);  // The scene's camera is the mean one.
}

// The spread of the prior is that of the field of view: f = 320 / tan(hfov / 2).
TEST(IntrinsicStatus, ThePriorIsThePapersTableFour) {
  const auto f = [](double hfov) { return 320.0 / std::tan(hfov / 2.0); };
  EXPECT_NEAR(PriorIntrinsicsSigma()(0), (f(0.95) - f(1.05)) / 2.0, 0.5);
}

TEST(IntrinsicStatus, GrowsWithTheViews) {
  const Rig rig = PaperRig();
  const Camera& camera = rig.cameras.front();
  std::vector<BoardView> views = FramesThatCount(
      HandcraftedRecording(rig, Fidelity::kFast, Carrier::kFree).views, camera.resolution);
  const IntrinsicStatus all = CalibrateIntrinsics(views, camera, DesignCriterion::kA, 100);
  ASSERT_TRUE(all.model.has_value());
  EXPECT_EQ(all.model_covariance.rows(), 9);
  EXPECT_NEAR(all.reprojection_px, 0.1 * std::sqrt(2.0), 0.01);
  // A weak motion for intrinsics: the error is large, but no larger than it claims.
  EXPECT_LT((all.estimate - camera.model.focal_and_centre()).norm(),
            3.0 * std::sqrt(all.covariance.trace()));
  views.resize(views.size() / 2);
  const IntrinsicStatus half = CalibrateIntrinsics(views, camera, DesignCriterion::kA, 100);
  const IntrinsicStatus none = PriorIntrinsicStatus(camera, DesignCriterion::kA);
  EXPECT_GT(all.information, half.information);
  EXPECT_GE(half.information, none.information);
}

// The same scene by formulas, by the arm's dynamics and by rendered images: one estimate.
TEST(ExtrinsicStatus, IsNearTheTruthAtEveryFidelity) {
  const Rig rig = PaperRig();
  for (const Fidelity fidelity : {Fidelity::kFast, Fidelity::kPhysical}) {
    const RecordedLoop loop = HandcraftedRecording(rig, fidelity, Carrier::kArm);
    EXPECT_TRUE(loop.last_frame_has_board);
    EXPECT_EQ(static_cast<int>(loop.views.size()), loop.num_frames);
    const auto status = CalibrateExtrinsics(rig, loop.views, loop.imu, rig.T_c0_i, {});
    ASSERT_TRUE(status.has_value());
    EXPECT_LT((status->estimate.t - rig.T_c0_i.t).norm(), 0.006);
    EXPECT_GT(status->conditional_trace, 0.0);
    EXPECT_LT(status->conditional_trace, status->covariance.trace());
  }
}

TEST(ExtrinsicStatus, IsNothingWithoutEnoughFrames) {
  const Rig rig = PaperRig();
  RecordedLoop loop = HandcraftedRecording(rig, Fidelity::kFast, Carrier::kFree);
  loop.views.resize(2);
  EXPECT_FALSE(CalibrateExtrinsics(rig, loop.views, loop.imu, rig.T_c0_i, {}).has_value());
}

// What the camera's own uncertainty adds.
TEST(ExtrinsicStatus, KnowsLessWhereTheCameraIsOnlyEstimated) {
  const Rig rig = PaperRig();
  const RecordedLoop loop = HandcraftedRecording(rig, Fidelity::kFast, Carrier::kFree);
  const auto exact = CalibrateExtrinsics(rig, loop.views, loop.imu, rig.T_c0_i, {});
  ExtrinsicSolve solve;
  const IntrinsicStatus camera =
      CalibrateIntrinsics(loop.views, rig.cameras.front(), DesignCriterion::kA, 100);
  solve.camera = camera.model;
  solve.camera_covariance = camera.model_covariance;
  const auto estimated = CalibrateExtrinsics(rig, loop.views, loop.imu, rig.T_c0_i, solve);
  ASSERT_TRUE(exact && estimated);
  EXPECT_LT(estimated->information, exact->information);
}

TEST(RecordLoop, DetectsInRenderedImagesWhatFormulasSee) {
  const Rig rig = PaperRig();
  Motion motion;
  motion.loops.push_back({ScaledAction(LoopCoefficients::Constant(0.004)), 1.0});
  const TimedMotion timed = std::get<TimedMotion>(PlanMotion(motion, rig));
  const Time start = Time::FromNanoseconds(1'000'000'000);
  const RecordedLoop fast = RecordLoop(rig, timed, Fidelity::kFast, start, Rng(1), false);
  EXPECT_TRUE(fast.imu.gyro.empty());
  const RecordedLoop rendered = RecordLoop(rig, timed, Fidelity::kRendered, start, Rng(1), true);
  EXPECT_GT(rendered.imu.gyro.size(), 100U);
  ASSERT_EQ(fast.views.size(), rendered.views.size());
  for (size_t k = 0; k < fast.views.size(); ++k) {
    EXPECT_EQ(fast.views[k].stamp, rendered.views[k].stamp);
    EXPECT_EQ(fast.views[k].corner_ids, rendered.views[k].corner_ids);
    EXPECT_LT((fast.views[k].pixels - rendered.views[k].pixels).cwiseAbs().maxCoeff(), 1.0);
  }
}

}  // namespace
}  // namespace calibrato
