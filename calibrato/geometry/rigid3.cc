#include "calibrato/geometry/rigid3.h"

#include "calibrato/geometry/so3.h"

namespace calibrato {

Rigid3 Rigid3::Perturbed(const Eigen::Matrix<double, 6, 1>& delta) const {
  return {ExpSo3(delta.head<3>()) * R, t + delta.tail<3>()};
}

Eigen::Matrix<double, 6, 1> Rigid3::DifferenceTo(const Rigid3& from) const {
  Eigen::Matrix<double, 6, 1> delta;
  delta << LogSo3(R * from.R.transpose()), t - from.t;
  return delta;
}

Eigen::Matrix4d Rigid3::Matrix() const {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() = R;
  matrix.topRightCorner<3, 1>() = t;
  return matrix;
}

Eigen::Matrix<double, 3, 6> JacobianTransformedPointPose(const Rigid3& T,
                                                         const Eigen::Vector3d& p) {
  Eigen::Matrix<double, 3, 6> J;
  J << -Hat(T.R * p), Eigen::Matrix3d::Identity();
  return J;
}

Eigen::Matrix<double, 6, 6> JacobianProductSecond(const Rigid3& T_a_b) {
  Eigen::Matrix<double, 6, 6> J = Eigen::Matrix<double, 6, 6>::Zero();
  J.topLeftCorner<3, 3>() = T_a_b.R;
  J.bottomRightCorner<3, 3>() = T_a_b.R;
  return J;
}

Eigen::Matrix<double, 6, 6> JacobianProductFirst(const Rigid3& T_a_b, const Rigid3& T_b_c) {
  Eigen::Matrix<double, 6, 6> J = Eigen::Matrix<double, 6, 6>::Identity();
  J.bottomLeftCorner<3, 3>() = -Hat(T_a_b.R * T_b_c.t);
  return J;
}

Eigen::Matrix<double, 6, 6> JacobianInverse(const Rigid3& T_a_b) {
  const Eigen::Matrix3d R_b_a = T_a_b.R.transpose();
  Eigen::Matrix<double, 6, 6> J = Eigen::Matrix<double, 6, 6>::Zero();
  J.topLeftCorner<3, 3>() = -R_b_a;
  J.bottomLeftCorner<3, 3>() = -R_b_a * Hat(T_a_b.t);
  J.bottomRightCorner<3, 3>() = -R_b_a;
  return J;
}

}  // namespace calibrato
