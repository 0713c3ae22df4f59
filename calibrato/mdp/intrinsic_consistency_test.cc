// Are the stated sigmas of a calibration true? Rigs, motions and noise are drawn, calibrated from
// nothing, and the truth is looked for in the stated ellipsoid.

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <cstdio>

#include "calibrato/base/full_sample_for_test.h"
#include "calibrato/base/parallel.h"
#include "calibrato/calibration/camera_calibration.h"
#include "calibrato/mdp/intrinsic_environment.h"
#include "calibrato/simulation/fast_simulation.h"

namespace calibrato {
namespace {

// 95 % point of chi-square with four degrees of freedom.
constexpr double kChiSquare4 = 9.487729;

TEST(IntrinsicCovariance, CoversTheTruth) {
  const int num_rigs = FullSample() ? 2000 : 200;
  const Rng rng(20);
  struct Outcome {
    bool converged = false;
    double squared_distance = 0.0;
  };
  const auto outcomes = ParallelMap<Outcome>(static_cast<size_t>(num_rigs), [&](size_t i) {
    Rng rigs = rng.Stream("rig", i);
    Rng motions = rng.Stream("motion", i);
    Rng noise = rng.Stream("noise", i);
    const Rig rig = DrawRig(RigDistribution::kPaper, rigs);
    const Camera& camera = rig.cameras.front();
    // One random motion in some thousand leaves the carrier's reach.
    const TimedMotion motion = PlanScaledToFit(RandomMotion(Task::kIntrinsic, motions), rig);
    CameraProblem problem;
    problem.model = kIntrinsicTaskModel;
    problem.resolution = camera.resolution;
    problem.views = FramesThatCount(SimulateFrames(rig, motion, Time(), noise).views,
                                    camera.resolution, rig.board);
    const CameraCalibration calibration = CalibrateCamera(problem);
    if (calibration.termination != Termination::kConverged) return Outcome{};
    const Eigen::Vector4d error =
        calibration.model->focal_and_centre() - camera.model.focal_and_centre();
    const Eigen::Matrix4d covariance = calibration.covariance.topLeftCorner<4, 4>();
    return Outcome{true, error.dot(covariance.ldlt().solve(error))};
  });
  int num_converged = 0;
  int num_covered = 0;
  double squared_distance = 0.0;
  for (const Outcome& outcome : outcomes) {
    num_converged += outcome.converged ? 1 : 0;
    num_covered += outcome.converged && outcome.squared_distance <= kChiSquare4 ? 1 : 0;
    squared_distance += outcome.squared_distance;
  }
  const double coverage = static_cast<double>(num_covered) / num_rigs;
  const double error_over_bound = std::sqrt(squared_distance / (4.0 * num_converged));
  std::printf(
      "n = %d, seed 20: %d converged, 95 %% ellipsoid covers %.2f %% +- %.2f %%, "
      "error over bound %.3f\n",
      num_rigs, num_converged, 100.0 * coverage,
      196.0 * std::sqrt(coverage * (1.0 - coverage) / num_rigs), error_over_bound);
  EXPECT_EQ(num_converged, num_rigs);
  if (FullSample()) {
    EXPECT_GE(coverage, 0.93);
    EXPECT_LE(coverage, 0.97);
  } else {
    EXPECT_GE(coverage, 0.90);
    EXPECT_LE(coverage, 0.99);
  }
  EXPECT_LE(error_over_bound, 1.1);
}

}  // namespace
}  // namespace calibrato
