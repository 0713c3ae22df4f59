#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace calibrato {

/// The rotation group, written with matrices R_a_b (v_a = R_a_b v_b) and rotation vectors phi
/// [rad]. Formulas and names as in Sola, Deray, Atchuthan, "A micro Lie theory for state estimation
/// in robotics", 2018, equations 132 to 146; near zero their Taylor series, exact to rounding.

/// The skew-symmetric matrix with Hat(a) b = a x b.
[[nodiscard]] Eigen::Matrix3d Hat(const Eigen::Vector3d& a);

/// exp([phi]x). Any |phi|.
[[nodiscard]] Eigen::Matrix3d ExpSo3(const Eigen::Vector3d& phi);

/// The rotation vector of smallest norm: |phi| <= pi. At exactly pi one of the two is returned.
[[nodiscard]] Eigen::Vector3d LogSo3(const Eigen::Matrix3d& R);

/// J_l with Exp(phi + d) = Exp(J_l(phi) d) Exp(phi) + O(d^2).
[[nodiscard]] Eigen::Matrix3d LeftJacobianSo3(const Eigen::Vector3d& phi);

/// J_l^-1. @pre |phi| < 2 pi, where it is singular.
[[nodiscard]] Eigen::Matrix3d LeftJacobianInverseSo3(const Eigen::Vector3d& phi);

/// J_r with Exp(phi + d) = Exp(phi) Exp(J_r(phi) d) + O(d^2); J_r(phi) = J_l(-phi).
[[nodiscard]] Eigen::Matrix3d RightJacobianSo3(const Eigen::Vector3d& phi);
[[nodiscard]] Eigen::Matrix3d RightJacobianInverseSo3(const Eigen::Vector3d& phi);

/// The nearest rotation in the Frobenius norm (by SVD), for matrices that were read from a file or
/// estimated linearly. @pre R is finite and det R > 0
[[nodiscard]] Eigen::Matrix3d NearestRotation(const Eigen::Matrix3d& R);

}  // namespace calibrato
