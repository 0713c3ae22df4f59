#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "calibrato/geometry/rigid3.h"

namespace calibrato {

/// Orders that a spline may have; degree = order - 1.
inline constexpr int kMinSplineOrder = 4;
inline constexpr int kMaxSplineOrder = 6;

/// What a pose spline T_a_b(t) is at one instant.
struct SplinePoint {
  Rigid3 T_a_b;
  Eigen::Vector3d omega_b;         ///< Angular velocity of b in a [rad/s].
  Eigen::Vector3d alpha_b;         ///< d omega_b / dt [rad/s^2].
  Eigen::Vector3d velocity_a;      ///< dt/dt of T_a_b [m/s].
  Eigen::Vector3d acceleration_a;  ///< [m/s^2]
};

/// What changes with time even faster: the derivatives to time of alpha_b and acceleration_a.
struct SplineJerk {
  Eigen::Vector3d angular_b;  ///< [rad/s^3]
  Eigen::Vector3d linear_a;   ///< [m/s^3]
};

/// Derivatives of a SplinePoint to the control points that it depends on: number `first` to
/// `first + order - 1`, each perturbed as every pose is, R = Exp(dtheta) R^, t = t^ + dt. Columns
/// 3 j .. 3 j + 2 belong to control point first + j; columns beyond 3 * order are not written.
///
/// Rotations depend on control rotations only, translations on control translations only, by one
/// number for each: d t / d t_j = weight[j] I.
struct SplineJacobians {
  using Matrix3Points = Eigen::Matrix<double, 3, 3 * kMaxSplineOrder>;
  int first = 0;
  Matrix3Points J_theta;  ///< Of the rotation's perturbation dtheta, in a.
  Matrix3Points J_omega;  ///< Of omega_b.
  Matrix3Points J_alpha;  ///< Of alpha_b.
  std::array<double, kMaxSplineOrder> weight;
  std::array<double, kMaxSplineOrder> weight_velocity;      ///< [1/s]
  std::array<double, kMaxSplineOrder> weight_acceleration;  ///< [1/s^2]
};

/// A path of poses T_a_b(t): a uniform cumulative B-spline on SO(3) x R^3. In segment s, between
/// the knots s * spacing and (s + 1) * spacing, with u = t / spacing - s and k = order,
///
///     R(t) = R_s Exp(lambda_1(u) d_1) .. Exp(lambda_{k-1}(u) d_{k-1}),  d_j = Log(R_{s+j-1}^T
///     R_{s+j}) t(t) = t_s + sum over j of lambda_j(u) (t_{s+j} - t_{s+j-1}),
///
/// lambda_j(u) being the cumulative basis, a polynomial of degree k - 1. It is k - 2 times
/// continuously differentiable, does not depend on the choice of frame a, and has no singularity
/// while neighbouring control rotations are less than pi apart.
///
/// Derivatives and their Jacobians by the recursions of Sommer, Usenko, Schubert, Demmel, Cremers,
/// "Efficient derivative computation for cumulative B-splines on Lie groups", CVPR 2020, linear in
/// the order; ours perturb on the left and are written out in docs/spline.md.
///
/// Times are seconds since the spline's first knot. Outside [0, duration_s()] the first or last
/// segment's polynomial goes on: smooth, but to be trusted for a small part of the spacing only.
class PoseSpline {
 public:
  /// @pre order in 4 .. 6, spacing_s > 0, at least `order` control points
  PoseSpline(int order, double spacing_s, std::vector<Rigid3> control_points);

  int order() const { return order_; }
  double spacing_s() const { return spacing_s_; }
  int num_control_points() const { return static_cast<int>(control_points_.size()); }
  int num_segments() const { return num_control_points() - order_ + 1; }
  double duration_s() const { return num_segments() * spacing_s_; }
  const std::vector<Rigid3>& control_points() const { return control_points_; }

  /// The segment of time t_s, which is also its first control point; the nearest one outside.
  int SegmentAt(double t_s) const;

  Rigid3 PoseAt(double t_s) const;
  SplinePoint At(double t_s) const;
  SplineJerk JerkAt(double t_s) const;

  /// What a caller needs of the Jacobians; each includes the one before it.
  enum class Depth { kPose, kRate, kAcceleration };
  /// Also fills jacobians: at kPose J_theta and weight, at kRate also J_omega and the other
  /// weights, at kAcceleration J_alpha too.
  SplinePoint At(double t_s, Depth depth, SplineJacobians* jacobians) const;

  /// Perturbs every control point. @param delta  6 numbers each, [dtheta, dt].
  void Perturb(const Eigen::VectorXd& delta);

 private:
  // What segments need of a control point and the one before it.
  struct Difference {
    Eigen::Vector3d d;                      // Log(R_{j-1}^T R_j)
    double squared_norm = 0.0;              // of d
    Eigen::Matrix3d J_d_control_rotations;  // Jr^-1(d) R_j^T: of d to dtheta_j - dtheta_{j-1}
  };
  void FindDifferences();
  template <int kOrder>
  void Evaluate(double t_s, Depth depth, SplinePoint* point, SplineJerk* jerk,
                SplineJacobians* jacobians) const;
  void Evaluate(double t_s, Depth depth, SplinePoint* point, SplineJerk* jerk,
                SplineJacobians* jacobians) const;

  int order_;
  double spacing_s_;
  std::vector<Rigid3> control_points_;
  std::vector<Difference> differences_;
};

/// A spline through poses that are given at any time: its control points are what a path must have
/// at the middle of each basis function so that the spline reproduces it to fourth order in the
/// spacing (a quasi-interpolant: c_j = f_j - k/24 (f_{j+1} - 2 f_j + f_{j-1})). No system is
/// solved.
/// @param pose  Called with times from -order * spacing to duration_s + order * spacing.
/// @param duration_s  > 0; rounded up to whole segments.
template <typename PoseFunction>
[[nodiscard]] PoseSpline SplineAlong(const PoseFunction& pose, int order, double spacing_s,
                                     double duration_s);

/// The quasi-interpolant's control points from samples of the path at their middles, with one more
/// sample at either end.
[[nodiscard]] std::vector<Rigid3> QuasiInterpolant(const std::vector<Rigid3>& samples, int order);

/// How many segments of the spacing cover a duration (with a tolerance of 1e-9 segments).
[[nodiscard]] int NumSegments(double duration_s, double spacing_s);

template <typename PoseFunction>
PoseSpline SplineAlong(const PoseFunction& pose, int order, double spacing_s, double duration_s) {
  // The basis function of control point j is centred on (j + 1 - order / 2) spacings.
  const int num_points = NumSegments(duration_s, spacing_s) + order - 1;
  std::vector<Rigid3> samples;
  for (int j = -1; j <= num_points; ++j) {
    samples.push_back(pose((j + 1 - 0.5 * order) * spacing_s));
  }
  return {order, spacing_s, QuasiInterpolant(samples, order)};
}

}  // namespace calibrato
