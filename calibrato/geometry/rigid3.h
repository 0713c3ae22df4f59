#pragma once

#include <Eigen/Core>

namespace calibrato {

/// A rigid motion T_a_b of 3-D space: p_a = T_a_b * p_b = R p_b + t. The frames are in the
/// variable's name, and inner letters cancel: T_a_c = T_a_b * T_b_c.
///
/// Perturbation, everywhere in calibrato: R = Exp(dtheta) R^, t = t^ + dt, order [dtheta, dt], both
/// in frame a. It is that of SO(3) x R^3, not of SE(3): a shift does not depend on a turn, as for
/// the sigmas that a person reads (docs/formats.md section 2).
struct Rigid3 {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d t = Eigen::Vector3d::Zero();  ///< [m]

  [[nodiscard]] Eigen::Vector3d operator*(const Eigen::Vector3d& p) const { return R * p + t; }
  [[nodiscard]] Rigid3 operator*(const Rigid3& other) const {
    return {R * other.R, R * other.t + t};
  }
  /// T_b_a.
  [[nodiscard]] Rigid3 Inverse() const { return {R.transpose(), -(R.transpose() * t)}; }

  /// @param delta  [dtheta, dt], [rad, m].
  [[nodiscard]] Rigid3 Perturbed(const Eigen::Matrix<double, 6, 1>& delta) const;
  /// The delta with from.Perturbed(delta) == *this.
  [[nodiscard]] Eigen::Matrix<double, 6, 1> DifferenceTo(const Rigid3& from) const;

  /// 4x4, row by row as in Kalibr's T_cn_cnm1.
  [[nodiscard]] Eigen::Matrix4d Matrix() const;
};

/// d(T * p) / d[dtheta, dt] = [-[R p]x, I].
[[nodiscard]] Eigen::Matrix<double, 3, 6> JacobianTransformedPointPose(const Rigid3& T,
                                                                       const Eigen::Vector3d& p);
/// Perturbation of T_a_b * T_b_c as the second factor is perturbed:
///     J = [R_a_b, 0; 0, R_a_b].
[[nodiscard]] Eigen::Matrix<double, 6, 6> JacobianProductSecond(const Rigid3& T_a_b);
/// ... and as the first is perturbed: J = [I, 0; -[R_a_b t_b_c]x, I].
[[nodiscard]] Eigen::Matrix<double, 6, 6> JacobianProductFirst(const Rigid3& T_a_b,
                                                               const Rigid3& T_b_c);
/// Perturbation of T_a_b^-1: J = [-R^T, 0; -R^T [t]x, -R^T] with R, t of T_a_b.
[[nodiscard]] Eigen::Matrix<double, 6, 6> JacobianInverse(const Rigid3& T_a_b);

}  // namespace calibrato
