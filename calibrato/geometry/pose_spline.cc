#include "calibrato/geometry/pose_spline.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "calibrato/geometry/so3.h"
#include "calibrato/geometry/spline_basis.h"

namespace calibrato {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Exp(phi) and Jr(phi), which share their coefficients. Neighbouring control rotations are nearly
// always less than half a radian apart; there the series (to rounding) spares sine and cosine.
void ExpAndRightJacobian(const Vector3d& phi, double a2, Matrix3d* exp, Matrix3d* right_jacobian) {
  double sinc;
  double one_minus_cos;    // over a^2
  double angle_minus_sin;  // over a^3
  if (a2 < 0.25) {
    // The terms' ratios: (1 - cos a) / a^2 = 1/2 (1 - a^2/12 (1 - a^2/30 (..))), and so on.
    constexpr std::array<double, 6> kCosine = {12.0, 30.0, 56.0, 90.0, 132.0, 182.0};
    constexpr std::array<double, 6> kSine = {20.0, 42.0, 72.0, 110.0, 156.0, 210.0};
    one_minus_cos = 1.0;
    angle_minus_sin = 1.0;
    for (size_t i = kCosine.size(); i-- > 0;) {
      one_minus_cos = 1.0 - a2 * (1.0 / kCosine[i]) * one_minus_cos;
      angle_minus_sin = 1.0 - a2 * (1.0 / kSine[i]) * angle_minus_sin;
    }
    one_minus_cos *= 0.5;
    angle_minus_sin *= 1.0 / 6.0;
    sinc = 1.0 - a2 * angle_minus_sin;
  } else {
    const double angle = std::sqrt(a2);
    const double sine = std::sin(angle);
    const double half_sine = std::sin(0.5 * angle);
    sinc = sine / angle;
    one_minus_cos = 2.0 * half_sine * half_sine / a2;
    angle_minus_sin = (angle - sine) / (a2 * angle);
  }
  const Matrix3d hat = Hat(phi);
  Matrix3d hat2 = phi * phi.transpose();
  hat2.diagonal().array() -= a2;
  *exp = sinc * hat + one_minus_cos * hat2;
  exp->diagonal().array() += 1.0;
  if (right_jacobian != nullptr) {
    *right_jacobian = angle_minus_sin * hat2 - one_minus_cos * hat;
    right_jacobian->diagonal().array() += 1.0;
  }
}

}  // namespace

PoseSpline::PoseSpline(int order, double spacing_s, std::vector<Rigid3> control_points)
    : order_(order), spacing_s_(spacing_s), control_points_(std::move(control_points)) {
  assert(order >= kMinSplineOrder && order <= kMaxSplineOrder);
  assert(spacing_s > 0.0);
  assert(static_cast<int>(control_points_.size()) >= order);
  FindDifferences();
}

void PoseSpline::FindDifferences() {
  differences_.resize(control_points_.size());
  for (size_t j = 1; j < control_points_.size(); ++j) {
    Difference& difference = differences_[j];
    const Matrix3d R_j_a = control_points_[j].R.transpose();
    difference.d = LogSo3(control_points_[j - 1].R.transpose() * control_points_[j].R);
    difference.squared_norm = difference.d.squaredNorm();
    difference.J_d_control_rotations = RightJacobianInverseSo3(difference.d) * R_j_a;
  }
}

int PoseSpline::SegmentAt(double t_s) const {
  const double segment = std::floor(t_s / spacing_s_);
  return static_cast<int>(std::clamp(segment, 0.0, num_segments() - 1.0));
}

template <int kOrder>
void PoseSpline::Evaluate(double t_s, Depth depth, SplinePoint* point, SplineJerk* jerk,
                          SplineJacobians* jacobians) const {
  const int first = SegmentAt(t_s);
  const SplineBasis<kOrder> basis = CumulativeBasis<kOrder>(t_s / spacing_s_ - first);
  const double rate = 1.0 / spacing_s_;
  const auto at = [&](int j) { return static_cast<size_t>(first + j); };

  // Forwards: the rotation and its derivatives, factor by factor; kept where the way back needs it.
  std::array<Matrix3d, kOrder> A;             // Exp(lambda_j d_j)
  std::array<Matrix3d, kOrder> Jr;            // Jr(lambda_j d_j)
  std::array<Matrix3d, kOrder> R;             // R_0 A_1 .. A_j
  std::array<Vector3d, kOrder> turned_omega;  // A_j^T omega_{j-1}
  std::array<Vector3d, kOrder> turned_alpha;  // A_j^T alpha_{j-1}
  std::array<Vector3d, kOrder> omega;
  Vector3d alpha = Vector3d::Zero();
  Vector3d third = Vector3d::Zero();
  omega[0].setZero();
  R[0] = control_points_[at(0)].R;
  const bool with_derivatives = depth != Depth::kPose || jerk != nullptr;
  for (int j = 1; j < kOrder; ++j) {
    const Difference& difference = differences_[at(j)];
    const Vector3d& d = difference.d;
    const double l0 = basis.value[j];
    ExpAndRightJacobian(l0 * d, l0 * l0 * difference.squared_norm, &A[j],
                        jacobians != nullptr ? &Jr[j] : nullptr);
    R[j].noalias() = R[j - 1] * A[j];
    // Rates are wanted at every depth: a pose's derivative to time is one of them.
    const double l1 = rate * basis.first[j];
    turned_omega[j].noalias() = A[j].transpose() * omega[j - 1];
    omega[j] = turned_omega[j] + l1 * d;
    if (!with_derivatives) continue;
    const double l2 = rate * rate * basis.second[j];
    const Vector3d turned_third = A[j].transpose() * third;
    turned_alpha[j].noalias() = A[j].transpose() * alpha;
    const Vector3d omega_cross_d = omega[j].cross(d);
    alpha = turned_alpha[j] + l1 * omega_cross_d + l2 * d;
    const double l3 = rate * rate * rate * basis.third[j];
    third = turned_third + l1 * (turned_alpha[j] + alpha).cross(d) + l2 * omega_cross_d + l3 * d;
  }

  Vector3d position = control_points_[at(0)].t;
  Vector3d velocity = Vector3d::Zero();
  Vector3d acceleration = Vector3d::Zero();
  Vector3d linear_third = Vector3d::Zero();
  for (int j = 1; j < kOrder; ++j) {
    const Vector3d step = control_points_[at(j)].t - control_points_[at(j - 1)].t;
    position += basis.value[j] * step;
    velocity += rate * basis.first[j] * step;
    acceleration += rate * rate * basis.second[j] * step;
    linear_third += rate * rate * rate * basis.third[j] * step;
  }
  *point = {{R[kOrder - 1], position}, omega[kOrder - 1], alpha, velocity, acceleration};
  if (jerk != nullptr) *jerk = {third, linear_third};
  if (jacobians == nullptr) return;

  jacobians->first = first;
  for (int j = 0; j < kOrder; ++j) {
    const auto weight = [&](const std::array<double, kOrder>& lambda) {
      return lambda[j] - (j + 1 < kOrder ? lambda[j + 1] : 0.0);
    };
    jacobians->weight[j] = weight(basis.value);
    jacobians->weight_velocity[j] = rate * weight(basis.first);
    jacobians->weight_acceleration[j] = rate * rate * weight(basis.second);
  }

  // Backwards: what a change of d_j does to the end, through all later factors; each d_j then moves
  // with dtheta_j - dtheta_{j-1}.
  auto& J_theta = jacobians->J_theta;
  auto& J_omega = jacobians->J_omega;
  auto& J_alpha = jacobians->J_alpha;
  const auto add_difference = [](auto& J, int j, const Matrix3d& G) {
    J.template middleCols<3>(3 * j) += G;
    J.template middleCols<3>(3 * (j - 1)) -= G;
  };
  J_theta.template leftCols<3 * kOrder>().setZero();
  J_theta.template leftCols<3>().setIdentity();
  if (depth >= Depth::kRate) J_omega.template leftCols<3 * kOrder>().setZero();
  if (depth >= Depth::kAcceleration) J_alpha.template leftCols<3 * kOrder>().setZero();
  Matrix3d later = Matrix3d::Identity();  // (A_{j+1} .. A_{k-1})^T
  Vector3d later_rates =
      Vector3d::Zero();  // sum over later factors of lambda' d, in the last frame
  for (int j = kOrder - 1; j >= 1; --j) {
    const Difference& difference = differences_[at(j)];
    const double l0 = basis.value[j];
    const double l1 = rate * basis.first[j];
    const Matrix3d Jr_d = l0 * (Jr[j] * difference.J_d_control_rotations);
    add_difference(J_theta, j, R[j] * Jr_d);
    if (depth >= Depth::kRate) {
      const Matrix3d& K = difference.J_d_control_rotations;
      const Matrix3d omega_j = Hat(turned_omega[j]) * Jr_d + l1 * K;
      const Matrix3d omega_end = later * omega_j;
      add_difference(J_omega, j, omega_end);
      if (depth >= Depth::kAcceleration) {
        const double l2 = rate * rate * basis.second[j];
        const Matrix3d alpha_j = Hat(turned_alpha[j]) * Jr_d +
                                 l1 * (Hat(omega[j]) * K - Hat(difference.d) * omega_j) + l2 * K;
        add_difference(J_alpha, j, later * alpha_j - Hat(later_rates) * omega_end);
        later_rates += l1 * (later * difference.d);
      }
      later = later * A[j].transpose();
    }
  }
}

void PoseSpline::Evaluate(double t_s, Depth depth, SplinePoint* point, SplineJerk* jerk,
                          SplineJacobians* jacobians) const {
  switch (order_) {
    case 4:
      return Evaluate<4>(t_s, depth, point, jerk, jacobians);
    case 5:
      return Evaluate<5>(t_s, depth, point, jerk, jacobians);
    default:
      return Evaluate<6>(t_s, depth, point, jerk, jacobians);
  }
}

Rigid3 PoseSpline::PoseAt(double t_s) const {
  SplinePoint point;
  Evaluate(t_s, Depth::kPose, &point, nullptr, nullptr);
  return point.T_a_b;
}

SplinePoint PoseSpline::At(double t_s) const {
  SplinePoint point;
  Evaluate(t_s, Depth::kAcceleration, &point, nullptr, nullptr);
  return point;
}

SplineJerk PoseSpline::JerkAt(double t_s) const {
  SplinePoint point;
  SplineJerk jerk;
  Evaluate(t_s, Depth::kAcceleration, &point, &jerk, nullptr);
  return jerk;
}

SplinePoint PoseSpline::At(double t_s, Depth depth, SplineJacobians* jacobians) const {
  SplinePoint point;
  Evaluate(t_s, depth, &point, nullptr, jacobians);
  return point;
}

void PoseSpline::Perturb(const Eigen::VectorXd& delta) {
  assert(delta.size() == 6 * num_control_points());
  for (size_t j = 0; j < control_points_.size(); ++j) {
    control_points_[j] =
        control_points_[j].Perturbed(delta.segment<6>(6 * static_cast<Eigen::Index>(j)));
    // Rounding adds up over many steps: one Newton step back to a rotation.
    Matrix3d& R = control_points_[j].R;
    R = 1.5 * R - 0.5 * R * (R.transpose() * R);
  }
  FindDifferences();
}

std::vector<Rigid3> QuasiInterpolant(const std::vector<Rigid3>& samples, int order) {
  assert(samples.size() >= 3);
  const double share = order / 24.0;
  std::vector<Rigid3> points;
  for (size_t j = 1; j + 1 < samples.size(); ++j) {
    const Rigid3& before = samples[j - 1];
    const Rigid3& here = samples[j];
    const Rigid3& after = samples[j + 1];
    const Vector3d turn =
        LogSo3(here.R.transpose() * after.R) + LogSo3(here.R.transpose() * before.R);
    points.push_back(
        {here.R * ExpSo3(-share * turn), here.t - share * (after.t - 2.0 * here.t + before.t)});
  }
  return points;
}

int NumSegments(double duration_s, double spacing_s) {
  assert(duration_s > 0.0 && spacing_s > 0.0);
  constexpr double kTolerance = 1e-9;
  return std::max(1, static_cast<int>(std::ceil(duration_s / spacing_s - kTolerance)));
}

}  // namespace calibrato
