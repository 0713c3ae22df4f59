#include "calibrato/geometry/pose_spline.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "calibrato/base/rng.h"
#include "calibrato/geometry/expect_jacobian.h"
#include "calibrato/geometry/so3.h"

namespace calibrato {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Depth = PoseSpline::Depth;

constexpr double kSpacing = 0.1;

// @param step_rad  How far apart neighbouring control rotations are: below and above half a radian
// other formulas are used.
PoseSpline RandomSpline(int order, double step_rad, uint64_t seed, int num_points = 9) {
  Rng rng(seed);
  const auto vector = [&](double size) {
    return Vector3d(rng.Uniform(-size, size), rng.Uniform(-size, size), rng.Uniform(-size, size));
  };
  std::vector<Rigid3> points = {{ExpSo3(vector(2.0)), vector(1.0)}};
  for (int j = 1; j < num_points; ++j) {
    points.push_back({points.back().R * ExpSo3(vector(step_rad)), vector(1.0)});
  }
  return {order, kSpacing, points};
}

PoseSpline Perturbed(PoseSpline spline, const VectorXd& delta) {
  spline.Perturb(delta);
  return spline;
}

TEST(PoseSpline, TurnsAtAConstantRateWhereControlRotationsDo) {
  const Vector3d step(0.05, -0.1, 0.2);
  for (int order = kMinSplineOrder; order <= kMaxSplineOrder; ++order) {
    std::vector<Rigid3> points;
    for (int j = 0; j < 10; ++j) points.push_back({ExpSo3(j * step), Vector3d::Zero()});
    const PoseSpline spline(order, kSpacing, points);
    for (const double t : {0.0, 0.031, 0.1, 0.27}) {
      const SplinePoint point = spline.At(t);
      // The control point in the middle of its basis function is passed: t = (j + 1 - k/2) spacing.
      const double j = t / kSpacing - 1.0 + 0.5 * order;
      EXPECT_LT((point.T_a_b.R - ExpSo3(j * step)).norm(), 1e-12);
      EXPECT_LT((point.omega_b - step / kSpacing).norm(), 1e-11);
      EXPECT_LT(point.alpha_b.norm(), 1e-9);
      EXPECT_LT(spline.JerkAt(t).angular_b.norm(), 1e-7);
    }
  }
}

TEST(SplineAlong, ReproducesACubicExactly) {
  const auto pose = [](double t) {
    return Rigid3{Matrix3d::Identity(), {1.0 + t, 2.0 * t * t - t, t * t * t}};
  };
  for (int order = kMinSplineOrder; order <= kMaxSplineOrder; ++order) {
    const PoseSpline spline = SplineAlong(pose, order, kSpacing, 0.95);
    EXPECT_EQ(spline.num_segments(), 10);
    for (const double t : {0.0, 0.05, 0.52, 0.95}) {
      const SplinePoint point = spline.At(t);
      EXPECT_LT((point.T_a_b.t - pose(t).t).norm(), 1e-12);
      EXPECT_LT((point.velocity_a - Vector3d(1.0, 4.0 * t - 1.0, 3.0 * t * t)).norm(), 1e-11);
      EXPECT_LT((point.acceleration_a - Vector3d(0.0, 4.0, 6.0 * t)).norm(), 1e-9);
      EXPECT_LT((spline.JerkAt(t).linear_a - Vector3d(0.0, 0.0, 6.0)).norm(), 1e-7);
    }
  }
}

TEST(SplineAlong, ErrorFallsWithTheFourthPowerOfTheSpacing) {
  const auto pose = [](double t) {
    return Rigid3{ExpSo3({0.3 * std::sin(5.0 * t), 0.4 * std::cos(3.0 * t), 0.2 * t}),
                  {std::sin(4.0 * t), std::cos(6.0 * t), t}};
  };
  const auto worst = [&](double spacing) {
    const PoseSpline spline = SplineAlong(pose, 6, spacing, 2.0);
    double error = 0.0;
    for (double t = 0.0; t < 2.0; t += 0.0137) {
      error = std::max(error, spline.PoseAt(t).DifferenceTo(pose(t)).norm());
    }
    return error;
  };
  const double coarse = worst(0.1);
  const double fine = worst(0.05);
  EXPECT_LT(coarse, 1e-2);
  EXPECT_NEAR(coarse / fine, 16.0, 4.0);
}

TEST(PoseSpline, DerivativesToTimeAreThoseOfItsValue) {
  for (const double step : {0.1, 0.8}) {
    for (int order = kMinSplineOrder; order <= kMaxSplineOrder; ++order) {
      const PoseSpline spline = RandomSpline(order, step, 1);
      for (const double t : {0.0123, 0.25, 0.291}) {
        const SplinePoint point = spline.At(t);
        const SplineJerk jerk = spline.JerkAt(t);
        const Matrix3d R_b_a = point.T_a_b.R.transpose();
        VectorXd expected(18);
        expected << point.omega_b, point.alpha_b, jerk.angular_b, point.velocity_a,
            point.acceleration_a, jerk.linear_a;
        const auto f = [&](const VectorXd& dt) -> VectorXd {
          const SplinePoint moved = spline.At(t + dt(0));
          VectorXd value(18);
          value << LogSo3(R_b_a * moved.T_a_b.R), moved.omega_b, moved.alpha_b, moved.T_a_b.t,
              moved.velocity_a, moved.acceleration_a;
          return value;
        };
        ExpectJacobian(f, VectorXd::Zero(1), expected, 1e-6, 1e-4);
      }
    }
  }
}

TEST(PoseSpline, JacobiansToControlPointsAgreeWithDifferences) {
  for (const double step : {0.1, 0.8}) {
    for (int order = kMinSplineOrder; order <= kMaxSplineOrder; ++order) {
      const PoseSpline spline = RandomSpline(order, step, 2);
      const int n = spline.num_control_points();
      for (const double t : {0.0, 0.137, 0.299, spline.duration_s()}) {
        SplineJacobians J;
        const SplinePoint point = spline.At(t, Depth::kAcceleration, &J);
        MatrixXd expected = MatrixXd::Zero(18, 6 * n);
        for (int j = 0; j < order; ++j) {
          const int column = 6 * (J.first + j);
          expected.block<3, 3>(0, column) = J.J_theta.middleCols<3>(3 * j);
          expected.block<3, 3>(3, column) = J.J_omega.middleCols<3>(3 * j);
          expected.block<3, 3>(6, column) = J.J_alpha.middleCols<3>(3 * j);
          const auto at = static_cast<size_t>(j);
          expected.block<3, 3>(9, column + 3) = J.weight[at] * Matrix3d::Identity();
          expected.block<3, 3>(12, column + 3) = J.weight_velocity[at] * Matrix3d::Identity();
          expected.block<3, 3>(15, column + 3) = J.weight_acceleration[at] * Matrix3d::Identity();
        }
        const auto f = [&](const VectorXd& delta) -> VectorXd {
          const SplinePoint moved = Perturbed(spline, delta).At(t);
          VectorXd value(18);
          value << LogSo3(moved.T_a_b.R * point.T_a_b.R.transpose()), moved.omega_b, moved.alpha_b,
              moved.T_a_b.t, moved.velocity_a, moved.acceleration_a;
          return value;
        };
        ExpectJacobian(f, VectorXd::Zero(6 * n), expected, 1e-7, 1e-3);
      }
    }
  }
}

TEST(PoseSpline, DepthChangesNothingButWhatIsFilled) {
  const PoseSpline spline = RandomSpline(6, 0.3, 3);
  SplineJacobians deep;
  SplineJacobians shallow;
  const SplinePoint a = spline.At(0.17, Depth::kAcceleration, &deep);
  const SplinePoint b = spline.At(0.17, Depth::kPose, &shallow);
  EXPECT_EQ(a.T_a_b.R, b.T_a_b.R);
  EXPECT_EQ(a.omega_b, b.omega_b);
  EXPECT_EQ(a.velocity_a, b.velocity_a);
  EXPECT_EQ(deep.J_theta, shallow.J_theta);
  EXPECT_EQ(deep.weight, shallow.weight);
  EXPECT_EQ(spline.PoseAt(0.17).R, a.T_a_b.R);
}

TEST(PoseSpline, DoesNotDependOnTheFrameItIsWrittenIn) {
  const PoseSpline spline = RandomSpline(5, 0.4, 4);
  const Rigid3 T_c_a{ExpSo3({1.0, -2.0, 0.5}), {0.3, 0.1, -2.0}};
  std::vector<Rigid3> moved;
  for (const Rigid3& point : spline.control_points()) moved.push_back(T_c_a * point);
  const PoseSpline other(5, kSpacing, moved);
  const SplinePoint a = spline.At(0.22);
  const SplinePoint c = other.At(0.22);
  EXPECT_LT((c.T_a_b.Matrix() - (T_c_a * a.T_a_b).Matrix()).norm(), 1e-12);
  EXPECT_LT((c.omega_b - a.omega_b).norm(), 1e-11);
  EXPECT_LT((c.alpha_b - a.alpha_b).norm(), 1e-9);
  EXPECT_LT((c.acceleration_a - T_c_a.R * a.acceleration_a).norm(), 1e-9);
}

TEST(PoseSpline, GoesOnSmoothlyBeyondItsEnds) {
  const PoseSpline spline = RandomSpline(6, 0.2, 5);
  const double end = spline.duration_s();
  EXPECT_EQ(spline.SegmentAt(-1.0), 0);
  EXPECT_EQ(spline.SegmentAt(end + 1.0), spline.num_segments() - 1);
  for (const double t : {0.0, end}) {
    const Rigid3 inside = spline.PoseAt(t + (t > 0.0 ? -1e-6 : 1e-6));
    const Rigid3 outside = spline.PoseAt(t + (t > 0.0 ? 1e-6 : -1e-6));
    EXPECT_LT(outside.DifferenceTo(inside).norm(), 1e-3);
    EXPECT_LT(
        (outside.DifferenceTo(spline.PoseAt(t)) + inside.DifferenceTo(spline.PoseAt(t))).norm(),
        1e-8);
  }
}

}  // namespace
}  // namespace calibrato
