#include "calibrato/guide/live_estimate.h"

#include <gtest/gtest.h>

#include <cmath>

#include "calibrato/calibration/planned_frame.h"
#include "calibrato/calibration/synthetic_camera_imu_for_test.h"
#include "calibrato/guide/gesture_choice.h"

namespace calibrato {
namespace {

GuideProblem ProblemOf(const SyntheticCameraImu& truth, bool camera_is_known) {
  GuideProblem problem;
  problem.points = PlannedView(truth.board);
  problem.resolution = truth.resolution;
  if (camera_is_known) problem.known_camera = truth.model;
  problem.imu = truth.imu_noise;
  return problem;
}

GuideData DataOf(const SyntheticCameraImu& truth) {
  Rng rng(4);
  const CameraImuProblem problem = truth.Problem(rng);
  return {problem.cameras[0].views, problem.imus[0].stream};
}

TEST(GuessBefore, IsThereForEveryModelAndReachesNothing) {
  const SyntheticCameraImu truth;
  for (const std::string_view model : kCameraModelNames) {
    GuideProblem problem = ProblemOf(truth, false);
    problem.model = model;
    const LiveEstimate guess = GuessBefore(problem);
    EXPECT_EQ(guess.progress.size(), 11U) << model;
    EXPECT_FALSE(guess.is_reached()) << model;
    for (const ParameterProgress& parameter : guess.progress) {
      EXPECT_TRUE(std::isfinite(parameter.sigma)) << model << " " << parameter.name;
      EXPECT_GT(parameter.sigma, parameter.wanted) << model << " " << parameter.name;
    }
    // Where planning begins: a board before the camera is seen.
    EXPECT_TRUE(guess.camera.Project({0.05, -0.02, 1.0})) << model;
  }
}

TEST(EstimateSoFar, FindsTheRigWithinWhatItStates) {
  SyntheticCameraImu truth;
  truth.duration_s = 8.0;
  for (const bool camera_is_known : {true, false}) {
    const LiveEstimate estimate = EstimateSoFar(ProblemOf(truth, camera_is_known), DataOf(truth));
    ASSERT_TRUE(estimate.extrinsics_are_measured);
    EXPECT_EQ(estimate.camera_is_measured, !camera_is_known);
    const auto error = estimate.T_c_i.DifferenceTo(truth.T_c_i[0]);
    const size_t first = camera_is_known ? 0 : 4;
    for (size_t k = 0; k < 6; ++k) {
      EXPECT_LT(std::abs(error(static_cast<Eigen::Index>(k))),
                4.5 * estimate.progress[first + k].sigma)
          << k;
    }
    EXPECT_LT(std::abs(estimate.time_offset_s - truth.time_offset_s[0]),
              4.5 * estimate.progress[first + 6].sigma);
  }
}

TEST(EstimateSoFar, StaysWithTheGuessWhereNothingIsTold) {
  SyntheticCameraImu truth;
  truth.rotation = 0.0;
  truth.translation = 0.0;
  truth.duration_s = 4.0;
  const GuideProblem problem = ProblemOf(truth, true);
  EXPECT_FALSE(EstimateSoFar(problem, DataOf(truth)).extrinsics_are_measured);
  EXPECT_FALSE(EstimateSoFar(problem, {}).is_reached());
}

TEST(PlanGestures, NamesTheFewThatReachWhatIsWanted) {
  SyntheticCameraImu truth;
  truth.duration_s = 4.0;
  const GuideProblem problem = ProblemOf(truth, true);
  const LiveEstimate estimate = EstimateSoFar(problem, DataOf(truth));
  GuideProblem stricter = problem;
  stricter.wanted = {1e-4, 2e-5, 5e-5, 2e-6};
  LiveEstimate wanted = estimate;
  wanted.progress =
      ProgressOf(estimate.information, LayoutOf(stricter), estimate.camera, stricter.wanted);
  const Rigid3 T_g_c = FacingBoard(problem.points, truth.PoseAt(0.0) * truth.T_c_i[0].Inverse());
  const auto gestures =
      GesturesFor({estimate.camera, problem.resolution, problem.points, T_g_c, {}});
  ASSERT_GT(gestures.size(), 8U);
  const GuidePlan plan = PlanGestures(stricter, wanted, gestures, {});
  ASSERT_FALSE(plan.gestures.empty());
  EXPECT_GT(plan.time_left_s, 4.0);
  // What is planned first adds more a second than any other gesture.
  const auto rate = [&](const Gesture& gesture) {
    const Eigen::MatrixXd after =
        wanted.information + ExpectFromGesture(stricter, wanted, gesture, 20.0);
    return (DistanceFromWanted(wanted.progress) -
            DistanceFromWanted(
                ProgressOf(after, LayoutOf(stricter), wanted.camera, stricter.wanted))) /
           (gesture.duration_s + 1.5);
  };
  const double best = rate(plan.gestures.front());
  for (const Gesture& gesture : gestures) EXPECT_LE(rate(gesture), best * (1.0 + 1e-9));
  // Once all is reached there is nothing left to do.
  GuideProblem lax = problem;
  lax.wanted = {1.0, 1.0, 1.0, 1.0};
  LiveEstimate done = estimate;
  done.progress = ProgressOf(estimate.information, LayoutOf(lax), estimate.camera, lax.wanted);
  EXPECT_TRUE(PlanGestures(lax, done, gestures, {}).is_reached);
}

}  // namespace
}  // namespace calibrato
