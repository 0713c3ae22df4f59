#include "calibrato/evaluation/filter_calibration.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "calibrato/evaluation/contestant.h"
#include "calibrato/evaluation/trial.h"
#include "calibrato/mdp/calibration_status.h"
#include "calibrato/motion/paper_scene.h"

namespace calibrato {
namespace {

FilterProblem Recorded(const Rig& rig, uint64_t seed) {
  const ExecutableMotion motion =
      MakeExecutable(HandcraftedMotion(Task::kExtrinsic), Carrier::kFree, rig);
  TrialRecording recording =
      RecordForTrial(Task::kExtrinsic, rig, motion, Fidelity::kFast, Rng(seed));
  return {rig.cameras.front().model,  recording.views,      recording.imu, rig.imu_noise,
          rig.corner_noise.stddev_px, PriorMeanExtrinsics()};
}

Rig TurnedRig() {
  Rig rig = PaperRig();
  Eigen::Matrix<double, 6, 1> off;
  off << 0.08, -0.1, 0.06, 0.01, -0.012, 0.008;
  rig.T_c0_i = rig.T_c0_i.Perturbed(off);
  return rig;
}

TEST(FilterCalibration, FindsAnImuThatSitsElsewhereThanGuessed) {
  const Rig rig = TurnedRig();
  double nees = 0.0;
  constexpr int kNumTrials = 4;
  for (int trial = 0; trial < kNumTrials; ++trial) {
    const auto made = CalibrateByFilter(Recorded(rig, static_cast<uint64_t>(trial)));
    ASSERT_TRUE(made.has_value());
    const Eigen::Matrix<double, 6, 1> error = rig.T_c0_i.DifferenceTo(made->T_c_i);
    // Guessed 0.14 rad and 17 mm off; a batch solve is good to about 0.8 mrad and 1.3 mm.
    EXPECT_LT(error.head<3>().norm(), 0.01);
    EXPECT_LT(error.tail<3>().norm(), 0.01);
    nees += error.dot(made->covariance.ldlt().solve(error)) / kNumTrials;
  }
  // Of six dimensions. It believes too firmly, some threefold in sigma: what was linearised far off
  // stays so.
  EXPECT_LT(nees, 150.0);
}

TEST(FilterCalibration, KnowsLessFromLess) {
  FilterProblem problem = Recorded(PaperRig(), 5);
  const auto whole = CalibrateByFilter(problem);
  problem.views.resize(problem.views.size() / 3);
  const auto third = CalibrateByFilter(problem);
  ASSERT_TRUE(whole && third);
  EXPECT_GT(third->covariance.trace(), 1.5 * whole->covariance.trace());
}

TEST(FilterCalibration, HasNoResultWithoutData) {
  FilterProblem problem = Recorded(PaperRig(), 6);
  FilterProblem blind = problem;
  blind.views.clear();
  EXPECT_FALSE(CalibrateByFilter(blind).has_value());
  problem.imu = {};
  EXPECT_FALSE(CalibrateByFilter(problem).has_value());
}

}  // namespace
}  // namespace calibrato
