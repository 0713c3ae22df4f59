#include "calibrato/evaluation/original_information.h"

#include <Eigen/LU>
#include <optional>

#include "calibrato/calibration/camera_imu_measurements.h"

namespace calibrato {
namespace {

// Of the pixel by the point, by central differences.
Eigen::Matrix<double, 2, 3> ProjectionJacobian(const CameraModel& camera,
                                               const Eigen::Vector3d& p_c) {
  constexpr double kStep = 1e-6;  // [m]
  Eigen::Matrix<double, 2, 3> J = Eigen::Matrix<double, 2, 3>::Zero();
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(k);
    const std::optional<Eigen::Vector2d> above = camera.Project(p_c + step);
    const std::optional<Eigen::Vector2d> below = camera.Project(p_c - step);
    if (above && below) J.col(k) = (*above - *below) / (2.0 * kStep);
  }
  return J;
}

}  // namespace

double OriginalAOptimality(const CameraImuProblem& problem, const CameraImuState& state) {
  const CameraCalibrationState& camera = state.cameras.front();
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d translation = Eigen::Matrix3d::Zero();
  for (const BoardView& view : problem.cameras.front().views) {
    const double t_s = TimeOfView(state, 0, view.stamp);
    if (!(t_s >= 0.0 && t_s <= state.T_g_i.duration_s())) continue;
    const Rigid3 T_i_g = state.T_g_i.PoseAt(t_s).Inverse();
    for (Eigen::Index k = 0; k < view.num_corners(); ++k) {
      const Eigen::Vector3d p_i = T_i_g * Eigen::Vector3d(view.points_g.col(k));
      const Eigen::Matrix<double, 2, 6> J = ProjectionJacobian(camera.model, camera.T_c_i * p_i) *
                                            JacobianTransformedPointPose(camera.T_c_i, p_i);
      rotation += J.leftCols<3>().transpose() * J.leftCols<3>();
      translation += J.rightCols<3>().transpose() * J.rightCols<3>();
    }
  }
  return rotation.inverse().trace() + translation.inverse().trace();
}

}  // namespace calibrato
