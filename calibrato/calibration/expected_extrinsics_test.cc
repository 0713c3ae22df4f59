#include "calibrato/calibration/expected_extrinsics.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "calibrato/calibration/camera_imu_calibration.h"
#include "calibrato/calibration/planned_frame.h"
#include "calibrato/calibration/synthetic_camera_imu_for_test.h"
#include "calibrato/geometry/so3.h"

namespace calibrato {
namespace {

using Eigen::Vector3d;
using Vector6d = Eigen::Matrix<double, 6, 1>;

PlannedRig RigOf(const SyntheticCameraImu& truth) {
  return {truth.model,    PlannedView(truth.board), truth.corner_noise_px,
          truth.T_c_i[0], truth.imu_noise,          truth.gravity_g};
}

PlannedMotion MotionOf(const SyntheticCameraImu& truth, double imu_rate_hz) {
  PlannedMotion motion;
  motion.duration_s = truth.duration_s;
  for (int k = 0; k < truth.duration_s * imu_rate_hz; ++k) {
    const double t = k / imu_rate_hz;
    const ImuMotion at = truth.MotionAt(t);
    motion.imu.push_back(
        {t, 1.0 / imu_rate_hz, at.R_w_i, at.omega_i, SpecificForce(at, truth.gravity_g)});
  }
  for (int k = 0; k < truth.duration_s * truth.camera_rate_hz; ++k) {
    const double t = 0.0123 + k / truth.camera_rate_hz + truth.time_offset_s[0];
    if (t >= truth.duration_s) continue;
    const Vector3d velocity = (truth.PoseAt(t + 1e-6).t - truth.PoseAt(t - 1e-6).t) / 2e-6;
    motion.frames.push_back(
        {t, 1.0, truth.T_c_i[0] * truth.PoseAt(t).Inverse(), truth.MotionAt(t).omega_i, velocity});
  }
  return motion;
}

SyntheticCameraImu Truth() {
  SyntheticCameraImu truth;
  truth.duration_s = 6.0;
  truth.camera_rate_hz = 10.0;
  // A lens that sees the whole board all along.
  truth.model = CameraModel("pinhole-none", Eigen::Vector4d(300.0, 301.0, 320.5, 240.5));
  return truth;
}

// The solver's own information, with its splines, its bias knots and all its measurements.
TEST(ExpectExtrinsics, AgreesWithTheSolversInformation) {
  const SyntheticCameraImu truth = Truth();
  Rng rng(3);
  CameraImuProblem problem = truth.Problem(rng);
  problem.corner_noise_px = truth.corner_noise_px;
  const CameraImuState state = StateAlong(
      [&](double t) { return truth.PoseAt(t); }, truth.epoch, truth.duration_s - 0.005, 0.05, 6,
      truth.gravity_g, {{truth.model, truth.T_c_i[0], truth.time_offset_s[0]}}, 1);
  const CameraImuInformation solver = InformationAt(problem, state);
  for (const double imu_rate_hz : {200.0, 50.0}) {
    const auto expected =
        ExpectExtrinsics(RigOf(truth), MotionOf(truth, imu_rate_hz), DesignCriterion::kA, false);
    ASSERT_TRUE(expected.has_value());
    for (int k = 0; k < 7; ++k) {
      EXPECT_NEAR(std::sqrt(expected->covariance(k, k)), std::sqrt(solver.covariance(k, k)),
                  0.04 * std::sqrt(solver.covariance(k, k)))
          << k << " at " << imu_rate_hz << " Hz";
    }
  }
}

// The same as information, with the camera's parameters known and unknown; against the solver's.
TEST(ExtrinsicInformationOf, AgreesWithTheSolversInformation) {
  const SyntheticCameraImu truth = Truth();
  for (const bool camera_is_known : {true, false}) {
    Rng rng(3);
    CameraImuProblem problem = truth.Problem(rng);
    problem.corner_noise_px = truth.corner_noise_px;
    if (!camera_is_known) problem.cameras[0].intrinsics = IntrinsicsKnowledge::kUnknown;
    const CameraImuState state = StateAlong(
        [&](double t) { return truth.PoseAt(t); }, truth.epoch, truth.duration_s - 0.005, 0.05, 6,
        truth.gravity_g, {{truth.model, truth.T_c_i[0], truth.time_offset_s[0]}}, 1);
    const CameraImuInformation solver = InformationAt(problem, state);
    const Eigen::MatrixXd information =
        ExtrinsicInformationOf(RigOf(truth), MotionOf(truth, 200.0), camera_is_known);
    const int n = camera_is_known ? 0 : truth.model.num_parameters();
    ASSERT_EQ(information.rows(), 9 + n);
    const Eigen::MatrixXd covariance =
        information.ldlt().solve(Eigen::MatrixXd::Identity(9 + n, 9 + n));
    const auto sigma_of = [&](const std::string& name) {
      const auto found = std::find(solver.names.begin(), solver.names.end(), name);
      const auto place = found - solver.names.begin();
      return std::sqrt(solver.covariance(place, place));
    };
    const std::vector<std::string> names = {"cam0.rot_x",      "cam0.rot_y", "cam0.rot_z",
                                            "cam0.pos_x",      "cam0.pos_y", "cam0.pos_z",
                                            "cam0.time_offset"};
    for (int k = 0; k < 7; ++k) {
      const double sigma = sigma_of(names[static_cast<size_t>(k)]);
      EXPECT_NEAR(std::sqrt(covariance(k, k)), sigma, 0.04 * sigma) << k << camera_is_known;
    }
    // Gravity's two angles about axes of another choice: the sum of squares is of neither.
    EXPECT_NEAR(std::sqrt(covariance(7, 7) + covariance(8, 8)),
                std::hypot(sigma_of("gravity_1"), sigma_of("gravity_2")),
                0.04 * std::hypot(sigma_of("gravity_1"), sigma_of("gravity_2")));
    const auto parameters = CameraModel::ParameterNames(truth.model.name());
    for (int k = 0; k < n; ++k) {
      const double sigma = sigma_of("cam0." + parameters[static_cast<size_t>(k)]);
      EXPECT_NEAR(std::sqrt(covariance(9 + k, 9 + k)), sigma, 0.04 * sigma) << k;
    }
  }
}

// A hold leaves all but the camera open, and of the camera it says what its frames say: the IMU has
// no part in it.
TEST(ExtrinsicInformationOf, OfAHoldIsThatOfItsFrames) {
  const SyntheticCameraImu truth = Truth();
  const PlannedRig rig = RigOf(truth);
  // At one of its poses that sees the board from aside.
  const Rigid3 T_g_i = truth.PoseAt(1.3);
  PlannedMotion motion = MotionOf(truth, 50.0);
  for (PlannedImuInstant& instant : motion.imu) {
    instant.R_g_i = T_g_i.R;
    instant.omega_i.setZero();
    instant.force_i = -T_g_i.R.transpose() * truth.gravity_g;
  }
  for (PlannedFrame& frame : motion.frames) {
    frame.T_c_g = truth.T_c_i[0] * T_g_i.Inverse();
    frame.omega_i.setZero();
    frame.velocity_g.setZero();
  }
  const int n = truth.model.num_parameters();
  Eigen::MatrixXd of_frames = Eigen::MatrixXd::Zero(n, n);
  for (const PlannedFrame& frame : motion.frames) {
    const auto information = CameraInformationOfFrame(rig.camera, rig.points, frame.T_c_g);
    ASSERT_TRUE(information);
    of_frames += frame.weight / (rig.corner_noise_px * rig.corner_noise_px) * *information;
  }
  Eigen::MatrixXd known = ExtrinsicInformationOf(rig, motion, false);
  constexpr int kTimeOffset = 6;
  EXPECT_NEAR(known(kTimeOffset, kTimeOffset), 0.0, 1e-3);
  known.topLeftCorner<9, 9>() += Eigen::MatrixXd::Identity(9, 9);
  const Eigen::MatrixXd of_camera =
      known.bottomRightCorner(n, n) -
      known.bottomLeftCorner(n, 9) *
          known.topLeftCorner<9, 9>().ldlt().solve(known.topRightCorner(9, n));
  ASSERT_GT(of_frames.diagonal().minCoeff(), 1e-3);
  const Eigen::VectorXd scale = of_frames.diagonal().cwiseSqrt().cwiseInverse();
  EXPECT_LT((scale.asDiagonal() * (of_camera - of_frames) * scale.asDiagonal()).norm(), 1e-3);
}

// Each derivative of the gradient against central differences, at a few instants.
class ExpectExtrinsicsGradient : public testing::TestWithParam<DesignCriterion> {
 protected:
  double Value(const PlannedMotion& motion) const {
    return ExpectExtrinsics(rig_, motion, GetParam(), false).value().criterion;
  }
  // @param change  Moves the motion by a number.
  template <typename Change>
  void ExpectDerivative(double analytic, double step, const Change& change) const {
    const auto central = [&](double h) {
      PlannedMotion high = motion_;
      PlannedMotion low = motion_;
      change(high, h);
      change(low, -h);
      return (Value(high) - Value(low)) / (2.0 * h);
    };
    const double numeric = (4.0 * central(0.5 * step) - central(step)) / 3.0;
    EXPECT_NEAR(analytic, numeric, 2e-4 * std::abs(numeric) + noise_ / step);
  }

  PlannedRig rig_ = RigOf(Truth());
  PlannedMotion motion_ = MotionOf(Truth(), 50.0);
  ExpectedExtrinsics expected_ = ExpectExtrinsics(rig_, motion_, GetParam(), true).value();
  double noise_ = 1e-9 * std::abs(expected_.criterion);
};

TEST_P(ExpectExtrinsicsGradient, ByTheImusMotion) {
  for (const size_t i : {0U, 57U, 149U, 299U}) {
    const PlannedMotionGradient::Imu& gradient = expected_.gradient.imu[i];
    for (int k = 0; k < 3; ++k) {
      const Vector3d axis = Vector3d::Unit(k);
      ExpectDerivative(gradient.omega_i(k), 0.03,
                       [&](PlannedMotion& m, double h) { m.imu[i].omega_i += h * axis; });
      ExpectDerivative(gradient.force_i(k), 0.1,
                       [&](PlannedMotion& m, double h) { m.imu[i].force_i += h * axis; });
      ExpectDerivative(gradient.R_g_i(k), 0.01,
                       [&](PlannedMotion& m, double h) { m.imu[i].R_g_i *= ExpSo3(h * axis); });
    }
    ExpectDerivative(gradient.t_s, 0.001, [&](PlannedMotion& m, double h) { m.imu[i].t_s += h; });
    ExpectDerivative(gradient.duration_s, 0.001,
                     [&](PlannedMotion& m, double h) { m.imu[i].duration_s += h; });
  }
}

TEST_P(ExpectExtrinsicsGradient, ByTheFrames) {
  for (const size_t i : {1U, 30U, 58U}) {
    const PlannedMotionGradient::Frame& gradient = expected_.gradient.frames[i];
    for (int k = 0; k < 6; ++k) {
      const Vector6d axis = Vector6d::Unit(k);
      ExpectDerivative(gradient.T_c_g(k), 0.001, [&](PlannedMotion& m, double h) {
        m.frames[i].T_c_g = m.frames[i].T_c_g.Perturbed(h * axis);
      });
    }
    for (int k = 0; k < 3; ++k) {
      const Vector3d axis = Vector3d::Unit(k);
      ExpectDerivative(gradient.omega_i(k), 0.03,
                       [&](PlannedMotion& m, double h) { m.frames[i].omega_i += h * axis; });
      ExpectDerivative(gradient.velocity_g(k), 0.02,
                       [&](PlannedMotion& m, double h) { m.frames[i].velocity_g += h * axis; });
    }
    ExpectDerivative(gradient.t_s, 0.001,
                     [&](PlannedMotion& m, double h) { m.frames[i].t_s += h; });
    ExpectDerivative(gradient.weight, 0.05,
                     [&](PlannedMotion& m, double h) { m.frames[i].weight += h; });
  }
}

INSTANTIATE_TEST_SUITE_P(Criteria, ExpectExtrinsicsGradient,
                         testing::Values(DesignCriterion::kA, DesignCriterion::kD,
                                         DesignCriterion::kE));

TEST(ExpectExtrinsics, IsNothingWithoutFrames) {
  PlannedMotion motion = MotionOf(Truth(), 50.0);
  motion.frames.clear();
  EXPECT_FALSE(ExpectExtrinsics(RigOf(Truth()), motion, DesignCriterion::kA, false).has_value());
}

}  // namespace
}  // namespace calibrato
