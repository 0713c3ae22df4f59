#include "calibrato/calibration/bias_covariance.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "calibrato/calibration/arrowhead.h"
#include "calibrato/calibration/camera_imu_layout.h"
#include "calibrato/calibration/synthetic_camera_imu_for_test.h"

namespace calibrato {
namespace {

using Eigen::MatrixXd;

CameraImuCalibration Solved(const CameraImuProblem& problem) {
  CameraImuOptions options;
  options.knot_spacing_s = 0.1;
  return CalibrateCameraImu(problem, options);
}

// By the inverse of the whole matrix.
TEST(CovarianceWithBiases, IsThatOfTheDenseNormalEquations) {
  SyntheticCameraImu truth;
  truth.duration_s = 3.0;
  Rng rng(1);
  const CameraImuProblem problem = truth.Problem(rng);
  const CameraImuCalibration result = Solved(problem);
  ASSERT_EQ(result.termination, Termination::kConverged);
  const NamedCovariance covariance = CovarianceWithBiases(problem, result);

  const CameraImuLayout layout(problem, result.state->T_g_i.order());
  ArrowheadSystem system(result.state->num_blocks(), layout.block_size, layout.border_size);
  ASSERT_TRUE(Linearise(problem, *result.state, layout,
                        MeasurementsOf(problem, *result.state, result.inliers), result.weights,
                        &system));
  const MatrixXd whole = system.Dense().inverse();
  const Eigen::Index m = layout.border_size;
  MatrixXd pick = MatrixXd::Zero(whole.rows(), m + 6);
  pick.bottomLeftCorner(m, m).setIdentity();
  const auto num_knots = static_cast<double>(result.state->imus[0].biases.size());
  for (int c = 0; c < result.state->num_blocks(); ++c) {
    // A block's last six are the bias knot of its beginning.
    pick.block<6, 6>((c + 1) * layout.block_size - 6, m).diagonal().setConstant(1.0 / num_knots);
  }
  const MatrixXd expected = pick.transpose() * whole * pick;
  ASSERT_EQ(covariance.matrix.rows(), expected.rows());
  const Eigen::VectorXd sigma = expected.diagonal().cwiseSqrt();
  const MatrixXd error = covariance.matrix - expected;
  EXPECT_LT((sigma.cwiseInverse().asDiagonal() * error * sigma.cwiseInverse().asDiagonal())
                .cwiseAbs()
                .maxCoeff(),
            1e-6);
  ASSERT_EQ(covariance.names.size(), static_cast<size_t>(m) + 6);
  EXPECT_EQ(covariance.names[0], "cam0.rot_x");
  EXPECT_EQ(covariance.names[static_cast<size_t>(m)], "imu0.gyro_bias_x");
  EXPECT_EQ(covariance.names.back(), "imu0.accel_bias_z");
}

// Biases hardly walk here: their mean is the one they began with.
TEST(CovarianceWithBiases, CoversTheTruth) {
  constexpr int kNumSeeds = 30;
  double squared = 0.0;
  for (int seed = 0; seed < kNumSeeds; ++seed) {
    SyntheticCameraImu truth;
    truth.duration_s = 3.0;
    truth.imu_noise.gyro_random_walk = 1e-9;
    truth.imu_noise.accel_random_walk = 1e-8;
    Rng rng(static_cast<uint64_t>(seed));
    const CameraImuProblem problem = truth.Problem(rng);
    const CameraImuCalibration result = Solved(problem);
    ASSERT_EQ(result.termination, Termination::kConverged) << seed;
    const ImuBias bias = MeanBias(result.state->imus[0]);
    Eigen::Vector<double, 6> error;
    error << bias.gyro - truth.gyro_bias, bias.accel - truth.accel_bias;
    const Eigen::Matrix<double, 6, 6> covariance =
        CovarianceWithBiases(problem, result).matrix.bottomRightCorner<6, 6>();
    squared += error.dot(covariance.inverse() * error);
  }
  // Chi-square over its degrees of freedom, within 3.5 of its standard deviations.
  EXPECT_NEAR(squared / (6.0 * kNumSeeds), 1.0, 3.5 * std::sqrt(2.0 / (6.0 * kNumSeeds)));
}

TEST(CovarianceWithBiases, IsEmptyWhereSomethingIsUndetermined) {
  SyntheticCameraImu truth;
  truth.duration_s = 3.0;
  Rng rng(1);
  const CameraImuProblem problem = truth.Problem(rng);
  CameraImuCalibration result = Solved(problem);
  result.information.covariance.resize(0, 0);
  EXPECT_EQ(CovarianceWithBiases(problem, result).matrix.size(), 0);
}

}  // namespace
}  // namespace calibrato
