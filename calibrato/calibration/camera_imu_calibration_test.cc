#include "calibrato/calibration/camera_imu_calibration.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <set>

#include "calibrato/base/full_sample_for_test.h"
#include "calibrato/base/input_error.h"
#include "calibrato/base/parallel.h"
#include "calibrato/calibration/arrowhead.h"
#include "calibrato/calibration/camera_imu_layout.h"
#include "calibrato/calibration/synthetic_camera_imu_for_test.h"

namespace calibrato {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

CameraImuOptions Spacing(double spacing_s) {
  CameraImuOptions options;
  options.knot_spacing_s = spacing_s;
  return options;
}

// Estimate against truth of camera 0: rotation, translation, time offset.
Eigen::Vector<double, 7> ErrorOf(const CameraImuCalibration& result,
                                 const SyntheticCameraImu& truth) {
  const CameraCalibrationState& camera = result.state->cameras.front();
  Eigen::Vector<double, 7> error;
  error << camera.T_c_i.DifferenceTo(truth.T_c_i[0]), camera.time_offset_s - truth.time_offset_s[0];
  return error;
}

double Nees(const CameraImuCalibration& result, const SyntheticCameraImu& truth) {
  const Eigen::Vector<double, 7> error = ErrorOf(result, truth);
  const Eigen::Matrix<double, 7, 7> covariance =
      result.information.covariance.topLeftCorner<7, 7>();
  return error.dot(covariance.ldlt().solve(error));
}

TEST(CalibrateCameraImu, FindsTheTruthFromExactMeasurementsAndNoGuess) {
  SyntheticCameraImu truth;
  truth.noise_scale = 0.0;
  truth.duration_s = 6.0;
  truth.time_offset_s = {-0.8137};
  Rng rng(1);
  CameraImuProblem problem = truth.Problem(rng);
  problem.corner_noise_px = 0.1;
  const CameraImuCalibration result = CalibrateCameraImu(problem);
  ASSERT_EQ(result.termination, Termination::kConverged);
  EXPECT_LT(ErrorOf(result, truth).head<6>().norm(), 1e-7);
  EXPECT_LT(std::abs(ErrorOf(result, truth)(6)), 1e-8);
  EXPECT_LT((result.state->gravity_g - truth.gravity_g).norm(), 1e-6);
  const ImuBias bias = result.state->BiasAt(0, 2.0);
  EXPECT_LT((bias.gyro - truth.gyro_bias).norm(), 1e-6);
  EXPECT_LT((bias.accel - truth.accel_bias).norm(), 1e-5);
}

TEST(CalibrateCameraImu, FindsTwoCamerasAndAnImuWithFaultsFromExactMeasurements) {
  SyntheticCameraImu truth;
  truth.noise_scale = 0.0;
  truth.duration_s = 8.0;
  truth.T_c_i.push_back({truth.T_c_i[0].R, {-0.05, -0.02, 0.03}});
  truth.time_offset_s.push_back(-0.0121);
  truth.intrinsics.M_accel << 1.01, 0.0, 0.0, 0.003, 0.99, 0.0, -0.004, 0.002, 1.005;
  truth.intrinsics.M_gyro << 0.995, 0.0, 0.0, 0.002, 1.004, 0.0, 0.001, -0.003, 1.002;
  truth.intrinsics.R_gyro_i = ExpSo3({0.01, -0.02, 0.015});
  truth.intrinsics.g_sensitivity(0, 1) = 2e-4;
  Rng rng(2);
  CameraImuProblem problem = truth.Problem(rng);
  problem.corner_noise_px = 0.1;
  problem.imus[0].model = ImuModelKind::kScaleMisalignment;
  const CameraImuCalibration result = CalibrateCameraImu(problem);
  ASSERT_EQ(result.termination, Termination::kConverged);
  for (size_t n = 0; n < 2; ++n) {
    const CameraCalibrationState& camera = result.state->cameras[n];
    EXPECT_LT(camera.T_c_i.DifferenceTo(truth.T_c_i[n]).norm(), 1e-6);
    EXPECT_NEAR(camera.time_offset_s, truth.time_offset_s[n], 1e-7);
  }
  const ImuIntrinsics& found = result.state->imus[0].intrinsics;
  EXPECT_LT((found.M_accel - truth.intrinsics.M_accel).norm(), 1e-6);
  EXPECT_LT((found.M_gyro - truth.intrinsics.M_gyro).norm(), 1e-6);
  EXPECT_LT((found.R_gyro_i - truth.intrinsics.R_gyro_i).norm(), 1e-6);
  EXPECT_LT((found.g_sensitivity - truth.intrinsics.g_sensitivity).norm(), 1e-6);
}

// The spread of re-solves with fresh noise, biases included, is what the covariance says.
TEST(CalibrateCameraImu, CovarianceIsTheSpreadOfReSolves) {
  SyntheticCameraImu truth;
  truth.duration_s = 3.0;
  truth.camera_rate_hz = 10.0;
  const int n = FullSample() ? 2000 : 200;
  Eigen::Vector<double, 7> squares = Eigen::Vector<double, 7>::Zero();
  Eigen::Vector<double, 7> variances = Eigen::Vector<double, 7>::Zero();
  double nees = 0.0;
  int covered = 0;
  double noise = 0.0;
  for (int i = 0; i < n; ++i) {
    Rng rng(static_cast<uint64_t>(1000 + i));
    const CameraImuCalibration result = CalibrateCameraImu(truth.Problem(rng), Spacing(0.08));
    ASSERT_EQ(result.termination, Termination::kConverged) << i;
    squares += ErrorOf(result, truth).cwiseAbs2();
    variances += result.information.covariance.diagonal().head<7>();
    nees += Nees(result, truth);
    covered += Nees(result, truth) < 14.067 ? 1 : 0;
    noise += result.weights.corner_noise_px;
  }
  // Bounds of 3.5 standard deviations of each statistic: sqrt(2 / n) of a variance's ratio.
  const double bound = 3.5 * std::sqrt(2.0 / n);
  for (int k = 0; k < 7; ++k) EXPECT_NEAR(squares(k) / variances(k), 1.0, bound) << k;
  EXPECT_NEAR(nees / (7 * n), 1.0, bound / std::sqrt(7.0));
  EXPECT_NEAR(static_cast<double>(covered) / n, 0.95, 3.5 * std::sqrt(0.95 * 0.05 / n));
  EXPECT_NEAR(noise / n, truth.corner_noise_px,
              0.003 * truth.corner_noise_px * std::sqrt(200.0 / n) + 2e-4);
}

TEST(CalibrateCameraImu, FinerKnotsChangeNothingButWhereTheyWereTooCoarse) {
  SyntheticCameraImu truth;
  truth.duration_s = 5.0;
  Rng rng(3);
  const CameraImuProblem problem = truth.Problem(rng);
  CameraImuOptions options;
  options.check_knot_spacing = true;
  const auto chosen = CalibrateCameraImu(problem, options).change_with_finer_knots;
  ASSERT_TRUE(chosen.has_value());
  EXPECT_LT(*chosen, 0.2);
  options.knot_spacing_s = 0.4;
  const auto coarse = CalibrateCameraImu(problem, options).change_with_finer_knots;
  ASSERT_TRUE(coarse.has_value());
  EXPECT_GT(*coarse, 1.0);
}

TEST(CalibrateCameraImu, BearsSpikesLateImagesAndWrongCorners) {
  SyntheticCameraImu truth;
  truth.duration_s = 20.0;
  Rng rng(4);
  CameraImuProblem problem = truth.Problem(rng);
  std::set<size_t> spikes;
  for (int k = 0; k < 16; ++k) {
    const size_t i = rng.UniformIndex(problem.imus[0].stream.gyro.size());
    spikes.insert(i);
    problem.imus[0].stream.gyro[i].value.array() += 3.0;
    problem.imus[0].stream.accel[i].value.array() -= 20.0;
  }
  std::set<size_t> late;
  std::vector<BoardView>& views = problem.cameras[0].views;
  for (const size_t v : {40U, 111U, 250U, 333U}) {
    late.insert(v);
    views[v].stamp = views[v].stamp + Duration::FromSeconds(0.03);
  }
  views[10].pixels(0, 5) += 13.0;
  const CameraImuCalibration result = CalibrateCameraImu(problem);
  ASSERT_EQ(result.termination, Termination::kConverged);
  EXPECT_LT(Nees(result, truth), 24.3);  // 99.9 % of chi-square with 7 degrees
  for (const size_t v : late) {
    EXPECT_EQ(
        std::count(result.inliers.corners[0][v].begin(), result.inliers.corners[0][v].end(), true),
        0)
        << v;
  }
  EXPECT_FALSE(result.inliers.corners[0][10][5]);
  for (const size_t i : spikes) {
    // Those at the very ends lie outside the trajectory and count as outliers as well.
    EXPECT_FALSE(result.inliers.gyro[0][i]) << i;
    EXPECT_FALSE(result.inliers.accel[0][i]) << i;
  }
  const auto all = static_cast<std::ptrdiff_t>(result.inliers.gyro[0].size());
  EXPECT_LE(std::count(result.inliers.gyro[0].begin(), result.inliers.gyro[0].end(), false),
            static_cast<std::ptrdiff_t>(spikes.size()) + all / 1000 + result.num_outside);
}

TEST(CalibrateCameraImu, IsTheSameToTheBitForAnyNumberOfThreads) {
  SyntheticCameraImu truth;
  truth.duration_s = 5.0;
  Rng rng(5);
  const CameraImuProblem problem = truth.Problem(rng);
  SetNumThreads(1);
  const CameraImuCalibration one = CalibrateCameraImu(problem);
  SetNumThreads(4);
  const CameraImuCalibration four = CalibrateCameraImu(problem);
  SetNumThreads(0);
  EXPECT_EQ(one.state->cameras[0].T_c_i.R, four.state->cameras[0].T_c_i.R);
  EXPECT_EQ(one.state->cameras[0].T_c_i.t, four.state->cameras[0].T_c_i.t);
  EXPECT_EQ(one.information.covariance, four.information.covariance);
}

TEST(CalibrateCameraImu, BridgesAGapOfBothSensors) {
  SyntheticCameraImu truth;
  truth.duration_s = 6.0;
  Rng rng(6);
  CameraImuProblem problem = truth.Problem(rng);
  const auto in_gap = [&](Time stamp) {
    const double t = (stamp - truth.epoch).seconds();
    return t > 2.0 && t < 3.2;
  };
  std::erase_if(problem.cameras[0].views, [&](const BoardView& v) { return in_gap(v.stamp); });
  std::erase_if(problem.imus[0].stream.gyro,
                [&](const VectorSample& s) { return in_gap(s.stamp); });
  std::erase_if(problem.imus[0].stream.accel,
                [&](const VectorSample& s) { return in_gap(s.stamp); });
  const CameraImuCalibration result = CalibrateCameraImu(problem, Spacing(0.07));
  ASSERT_EQ(result.termination, Termination::kConverged);
  EXPECT_LT(Nees(result, truth), 24.3);
}

TEST(CalibrateCameraImu, FindsASecondImu) {
  SyntheticCameraImu truth;
  truth.duration_s = 6.0;
  Rng rng(7);
  CameraImuProblem problem = truth.Problem(rng);
  const Rigid3 T_i_imu{ExpSo3({0.4, -1.0, 0.3}), {0.08, -0.03, 0.05}};
  const double offset = 0.0042;  // t_0 = t_1 + offset
  CameraImuImu second{{}, truth.imu_noise, ImuModelKind::kCalibrated};
  for (const VectorSample& sample : problem.imus[0].stream.gyro) {
    const double t = (sample.stamp - truth.epoch).seconds();
    const ImuMotion motion = MotionOfFrame(truth.MotionAt(t + offset), T_i_imu);
    const auto noise = [&](double density) -> Eigen::Vector3d {
      const double x = rng.Normal();
      const double y = rng.Normal();
      return density * std::sqrt(200.0) * Eigen::Vector3d(x, y, rng.Normal());
    };
    second.stream.gyro.push_back(
        {sample.stamp, PredictGyro(motion, truth.gravity_g, {}, {0.01, 0.0, -0.02}) +
                           noise(truth.imu_noise.gyro_noise_density)});
    second.stream.accel.push_back(
        {sample.stamp, PredictAccel(motion, truth.gravity_g, {}, {0.1, 0.0, -0.05}) +
                           noise(truth.imu_noise.accel_noise_density)});
  }
  problem.imus.push_back(second);
  const CameraImuCalibration result = CalibrateCameraImu(problem, Spacing(0.07));
  ASSERT_EQ(result.termination, Termination::kConverged);
  const ImuCalibrationState& imu = result.state->imus[1];
  const CameraImuLayout layout(problem, 6);
  Eigen::Vector<double, 7> error;
  error << imu.T_i_imu.DifferenceTo(T_i_imu), imu.time_offset_s - offset;
  const MatrixXd covariance =
      result.information.covariance.block<7, 7>(layout.imus[1].pose, layout.imus[1].pose);
  EXPECT_LT(error.dot(covariance.ldlt().solve(error)), 24.3);
  EXPECT_LT(error.head<3>().norm(), 1e-3);
  EXPECT_LT(error.segment<3>(3).norm(), 5e-3);
}

TEST(CalibrateCameraImu, EstimatesTheNoiseOfAllSensorsWhereAsked) {
  SyntheticCameraImu truth;
  truth.duration_s = 10.0;
  Rng rng(13);
  CameraImuProblem problem = truth.Problem(rng);
  problem.imus[0].noise.gyro_noise_density *= 4.0;
  problem.imus[0].noise.accel_noise_density *= 0.3;
  CameraImuOptions options = Spacing(0.05);
  options.estimate_imu_noise = true;
  const CameraImuCalibration result = CalibrateCameraImu(problem, options);
  ASSERT_EQ(result.termination, Termination::kConverged);
  const double root_rate = std::sqrt(truth.imu_noise.rate_hz);
  // 6000 numbers each: a stddev is known to 0.9 %.
  EXPECT_NEAR(result.weights.imus[0].gyro_stddev / (truth.imu_noise.gyro_noise_density * root_rate),
              1.0, 0.035);
  EXPECT_NEAR(
      result.weights.imus[0].accel_stddev / (truth.imu_noise.accel_noise_density * root_rate), 1.0,
      0.035);
  EXPECT_NEAR(result.weights.corner_noise_px / truth.corner_noise_px, 1.0, 0.02);
}

TEST(CalibrateCameraImu, FindsTheLineDelayOfARollingShutter) {
  SyntheticCameraImu truth;
  truth.duration_s = 5.0;
  truth.line_delay_s = 40e-6;
  const int n = FullSample() ? 200 : 6;
  double squared = 0.0;
  double nees = 0.0;
  for (int i = 0; i < n; ++i) {
    Rng rng(static_cast<uint64_t>(14 + i));
    CameraImuProblem problem = truth.Problem(rng);
    if (i == 0) {
      // As a global shutter's the images do not fit, and the result is off.
      const CameraImuCalibration global = CalibrateCameraImu(problem, Spacing(0.07));
      EXPECT_TRUE(global.termination != Termination::kConverged || Nees(global, truth) > 1e3);
    }
    problem.estimate_line_delays = true;
    const CameraImuCalibration result = CalibrateCameraImu(problem, Spacing(0.07));
    ASSERT_EQ(result.termination, Termination::kConverged);
    const int column = CameraImuLayout(problem, 6).cameras[0].line_delay;
    const double sigma = std::sqrt(result.information.covariance(column, column));
    EXPECT_LT(sigma, 1e-6);
    const double error = result.state->cameras[0].line_delay_s - truth.line_delay_s;
    squared += error * error / (sigma * sigma);
    nees += Nees(result, truth);
    EXPECT_NEAR(result.weights.corner_noise_px, truth.corner_noise_px,
                0.03 * truth.corner_noise_px);
  }
  EXPECT_NEAR(squared / n, 1.0, 3.5 * std::sqrt(2.0 / n));
  EXPECT_NEAR(nees / (7 * n), 1.0, 3.5 * std::sqrt(2.0 / (7.0 * n)));
}

TEST(CalibrateCameraImu, FindsTheSizeOfTheBoard) {
  SyntheticCameraImu truth;
  truth.duration_s = 5.0;
  Rng rng(15);
  CameraImuProblem problem = truth.Problem(rng);
  for (BoardView& view : problem.cameras[0].views) view.points_g /= 1.07;
  problem.estimate_board_scale = true;
  const CameraImuCalibration result = CalibrateCameraImu(problem, Spacing(0.07));
  ASSERT_EQ(result.termination, Termination::kConverged);
  const int column = CameraImuLayout(problem, 6).board_scale;
  const double sigma = std::sqrt(result.information.covariance(column, column));
  EXPECT_LT(sigma, 2e-3);
  EXPECT_NEAR(result.state->board_scale, 1.07, 4.0 * sigma);
  EXPECT_LT(Nees(result, truth), 24.3);
}

// One gyroscope reading in two, one accelerometer reading in four: densities are what they were.
TEST(CalibrateCameraImu, WeighsEachStreamByItsOwnRate) {
  SyntheticCameraImu truth;
  truth.duration_s = 5.0;
  Rng rng(16);
  CameraImuProblem problem = truth.Problem(rng);
  const auto keep_one_in = [](size_t n, std::vector<VectorSample>* samples) {
    std::vector<VectorSample> kept;
    for (size_t k = 0; k < samples->size(); k += n) kept.push_back((*samples)[k]);
    *samples = std::move(kept);
  };
  keep_one_in(2, &problem.imus[0].stream.gyro);
  keep_one_in(4, &problem.imus[0].stream.accel);
  const CameraImuCalibration result = CalibrateCameraImu(problem, Spacing(0.08));
  ASSERT_EQ(result.termination, Termination::kConverged);
  EXPECT_NEAR(result.weights.imus[0].gyro_rate_hz, 100.0, 1e-6);
  EXPECT_NEAR(result.weights.imus[0].accel_rate_hz, 50.0, 1e-6);
  EXPECT_DOUBLE_EQ(result.weights.imus[0].gyro_stddev,
                   truth.imu_noise.gyro_noise_density * std::sqrt(100.0));
  EXPECT_DOUBLE_EQ(result.weights.imus[0].accel_stddev,
                   truth.imu_noise.accel_noise_density * std::sqrt(50.0));
}

TEST(CalibrateCameraImu, UncertaintyOfIntrinsicsFlowsIntoExtrinsics) {
  SyntheticCameraImu truth;
  truth.duration_s = 5.0;
  Rng rng(8);
  CameraImuProblem problem = truth.Problem(rng);
  const auto sigma = [&] {
    const CameraImuCalibration result = CalibrateCameraImu(problem, Spacing(0.07));
    EXPECT_EQ(result.termination, Termination::kConverged);
    return result.information.covariance.diagonal().head<6>().cwiseSqrt().eval();
  };
  const auto exact = sigma();
  problem.cameras[0].intrinsics = IntrinsicsKnowledge::kPrior;
  VectorXd variances(8);
  variances << 1.0, 1.0, 1.0, 1.0, 1e-4, 1e-4, 1e-6, 1e-6;
  problem.cameras[0].intrinsics_covariance = variances.asDiagonal().toDenseMatrix();
  const auto with_prior = sigma();
  problem.cameras[0].intrinsics_covariance *= 1e-10;
  const auto with_certain_prior = sigma();
  problem.cameras[0].intrinsics = IntrinsicsKnowledge::kUnknown;
  const auto unknown = sigma();
  EXPECT_TRUE((with_prior.array() > exact.array()).all());
  EXPECT_TRUE((unknown.array() > with_prior.array()).all());
  EXPECT_LT((with_certain_prior - exact).cwiseQuotient(exact).norm(), 1e-2);
}

TEST(CalibrateCameraImu, APriorStandsForTheRecordingsItCameFrom) {
  SyntheticCameraImu truth;
  truth.duration_s = 5.0;
  Rng rng(9);
  CameraImuProblem first = truth.Problem(rng);
  CameraImuProblem second = truth.Problem(rng);
  first.corner_noise_px = second.corner_noise_px = 0.1;
  const CameraImuCalibration a = CalibrateCameraImu(first, Spacing(0.07));
  const CameraImuCalibration b = CalibrateCameraImu(second, Spacing(0.07));
  second.prior = CalibrationPrior{*a.state, a.information.information_matrix};
  const CameraImuCalibration both = CalibrateCameraImu(second, Spacing(0.07));
  ASSERT_EQ(both.termination, Termination::kConverged);
  const MatrixXd& A = a.information.information_matrix;
  const MatrixXd& B = b.information.information_matrix;
  const MatrixXd sum = A + B;
  const VectorXd unit = sum.diagonal().cwiseSqrt().cwiseInverse();
  const MatrixXd difference =
      unit.asDiagonal() * (both.information.information_matrix - sum) * unit.asDiagonal();
  EXPECT_LT(difference.cwiseAbs().maxCoeff(), 0.02);
  // The estimate is the mean of both, weighted by information.
  const CameraImuLayout layout(second, 6);
  const VectorXd from_a = CalibrationDifference(*b.state, *a.state, layout);
  const VectorXd expected = sum.ldlt().solve(B * from_a);
  const VectorXd found = CalibrationDifference(*both.state, *a.state, layout);
  const VectorXd sigma = both.information.covariance.diagonal().cwiseSqrt();
  EXPECT_LT((found - expected).cwiseQuotient(sigma).cwiseAbs().maxCoeff(), 0.1);
}

TEST(InformationAt, IsThatOfTheSolveAtItsResult) {
  SyntheticCameraImu truth;
  truth.duration_s = 4.0;
  Rng rng(10);
  CameraImuProblem problem = truth.Problem(rng);
  problem.corner_noise_px = 0.1;
  const CameraImuCalibration result = CalibrateCameraImu(problem, Spacing(0.07));
  const CameraImuInformation again = InformationAt(problem, *result.state);
  EXPECT_EQ(again.names, result.information.names);
  EXPECT_LT((again.covariance - result.information.covariance).norm(),
            1e-6 * result.information.covariance.norm());
  // What takes the rest as known claims to know more.
  const double marginal = again.covariance.topLeftCorner<6, 6>().trace();
  EXPECT_LT(again.a_optimality_conditional, marginal);
  EXPECT_NEAR(again.extrinsics.a_optimality, 1e6 * marginal, 1e-9);
}

TEST(CalibrateCameraImu, SaysWhatTheMotionDoesNotTell) {
  for (const double translation : {0.0, 1.0}) {
    SyntheticCameraImu truth;
    truth.duration_s = 4.0;
    truth.rotation = 0.0;
    truth.translation = translation;
    Rng rng(11);
    const CameraImuCalibration result = CalibrateCameraImu(truth.Problem(rng), Spacing(0.1));
    if (result.termination != Termination::kConverged) continue;
    // Without rotation no translation between the sensors can be told.
    EXPECT_GT(result.information.covariance.diagonal().segment<3>(3).cwiseSqrt().maxCoeff(), 0.02);
  }
}

// A weak motion, whose solves are damped on their way: what a damped step promises is small
// anywhere, and says nothing of how far the minimum is.
TEST(CalibrateCameraImu, IsConvergedOnlyWhereNothingIsLeftToGain) {
  int num_converged = 0;
  for (const uint64_t seed : {14, 19}) {
    SyntheticCameraImu truth;
    truth.duration_s = 3.0;
    truth.rotation = 0.04;
    truth.translation = 0.2;
    truth.corner_noise_px = 0.6;
    truth.camera_rate_hz = 10.0;
    truth.imu_noise.gyro_noise_density *= 40.0;
    truth.imu_noise.accel_noise_density *= 40.0;
    Rng rng(seed);
    CameraImuProblem problem = truth.Problem(rng);
    problem.cameras[0].intrinsics = IntrinsicsKnowledge::kUnknown;
    CameraImuOptions options = Spacing(0.1);
    options.max_iterations = 1000;
    const CameraImuCalibration result = CalibrateCameraImu(problem, options);
    if (result.termination != Termination::kConverged) continue;
    ++num_converged;
    const CameraImuLayout layout(problem, result.state->T_g_i.order());
    ArrowheadSystem system(result.state->num_blocks(), layout.block_size, layout.border_size);
    ASSERT_TRUE(Linearise(problem, *result.state, layout,
                          MeasurementsOf(problem, *result.state, result.inliers), result.weights,
                          &system));
    const auto factor = ArrowheadCholesky::Factor(system, 0.0);
    ASSERT_TRUE(factor.has_value());
    // The calibration's squared distance to the minimum in standard deviations.
    const VectorXd step = factor->Step().tail(layout.border_size);
    EXPECT_LT(step.dot(factor->BorderInformation() * step), 2.6e-3) << seed;
  }
  EXPECT_GE(num_converged, 2);
}

TEST(CalibrateCameraImu, SaysWhyThereIsNoStart) {
  using Reason = CameraImuNoStart::Reason;
  SyntheticCameraImu truth;
  truth.duration_s = 6.0;
  truth.T_c_i.push_back(truth.T_c_i[0]);
  truth.time_offset_s.push_back(0.0);
  Rng rng(13);
  const CameraImuProblem good = truth.Problem(rng);
  const auto expect = [](const CameraImuProblem& problem, Reason reason, size_t sensor) {
    const CameraImuCalibration result = CalibrateCameraImu(problem, Spacing(0.1));
    EXPECT_EQ(result.termination, Termination::kNoStart);
    ASSERT_TRUE(result.no_start.has_value());
    EXPECT_EQ(result.no_start->reason, reason);
    EXPECT_EQ(result.no_start->sensor, sensor);
  };
  CameraImuProblem sparse = good;
  std::vector<BoardView>& views = sparse.cameras[1].views;
  for (size_t v = views.size(); v-- > 0;) {
    if (v % 12 != 0) views.erase(views.begin() + static_cast<std::ptrdiff_t>(v));
  }
  expect(sparse, Reason::kViewsFarApart, 1);
  CameraImuProblem apart = good;
  for (BoardView& view : apart.cameras[1].views) {
    view.stamp = view.stamp + Duration::FromSeconds(1000.0);
  }
  expect(apart, Reason::kNoSharedTime, 1);
  CameraImuProblem few = good;
  few.cameras[0].views.resize(4);
  expect(few, Reason::kNoBoardPoses, 0);
  CameraImuProblem other = good;
  other.imus.push_back(other.imus[0]);
  for (auto* samples : {&other.imus[1].stream.gyro, &other.imus[1].stream.accel}) {
    for (VectorSample& sample : *samples) {
      sample.stamp = sample.stamp + Duration::FromSeconds(1000.0);
    }
  }
  expect(other, Reason::kOtherImu, 1);
  CameraImuProblem still = good;
  for (VectorSample& sample : still.imus[0].stream.gyro) sample.value.setZero();
  expect(still, Reason::kNoTurning, 0);
  // Some time offset covers each of many intervals, but none five of them.
  CameraImuProblem brief = good;
  brief.imus[0].stream.gyro.erase(brief.imus[0].stream.gyro.begin() + 40,
                                  brief.imus[0].stream.gyro.end());
  expect(brief, Reason::kNoSharedTime, 0);
}

TEST(CalibrateCameraImu, RefusesEmptyInputAndFindsNoStartWithoutOverlap) {
  SyntheticCameraImu truth;
  truth.duration_s = 3.0;
  Rng rng(12);
  const CameraImuProblem problem = truth.Problem(rng);
  CameraImuProblem blind = problem;
  blind.cameras[0].views.clear();
  EXPECT_THROW((void)CalibrateCameraImu(blind), InputError);
  CameraImuProblem silent = problem;
  silent.imus[0].stream.accel.clear();
  EXPECT_THROW((void)CalibrateCameraImu(silent), InputError);
  CameraImuProblem apart = problem;
  for (BoardView& view : apart.cameras[0].views) {
    view.stamp = view.stamp + Duration::FromSeconds(1000.0);
  }
  EXPECT_EQ(CalibrateCameraImu(apart).termination, Termination::kNoStart);
}

}  // namespace
}  // namespace calibrato
