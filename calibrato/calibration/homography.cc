#include "calibrato/calibration/homography.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>

#include "calibrato/geometry/so3.h"

namespace calibrato {
namespace {

// Shifts the centroid to the origin and scales the mean distance to sqrt(2).
Eigen::Matrix3d Normalisation(const Eigen::Matrix2Xd& points) {
  const Eigen::Vector2d centroid = points.rowwise().mean();
  const double distance = (points.colwise() - centroid).colwise().norm().mean();
  const double scale = distance > 0.0 ? std::sqrt(2.0) / distance : 1.0;
  Eigen::Matrix3d T;
  T << scale, 0.0, -scale * centroid.x(), 0.0, scale, -scale * centroid.y(), 0.0, 0.0, 1.0;
  return T;
}

}  // namespace

std::optional<Eigen::Matrix3d> EstimateHomography(const Eigen::Matrix2Xd& plane,
                                                  const Eigen::Matrix2Xd& image) {
  if (plane.cols() < 4 || plane.cols() != image.cols()) return std::nullopt;
  const Eigen::Matrix3d T_plane = Normalisation(plane);
  const Eigen::Matrix3d T_image = Normalisation(image);
  Eigen::Matrix<double, 9, 9> normal = Eigen::Matrix<double, 9, 9>::Zero();
  for (Eigen::Index k = 0; k < plane.cols(); ++k) {
    const Eigen::Vector3d p = T_plane * plane.col(k).homogeneous();
    const Eigen::Vector3d q = T_image * image.col(k).homogeneous();
    Eigen::Matrix<double, 2, 9> rows;
    rows << p.transpose(), Eigen::RowVector3d::Zero(), -q.x() * p.transpose(),
        Eigen::RowVector3d::Zero(), p.transpose(), -q.y() * p.transpose();
    normal += rows.transpose() * rows;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 9, 9>> solver(normal);
  // A second null direction means that the points lie on a line.
  if (!(solver.eigenvalues()(1) > 1e-12 * solver.eigenvalues()(8))) return std::nullopt;
  const Eigen::Matrix<double, 9, 1> h = solver.eigenvectors().col(0);
  Eigen::Matrix3d H;
  H << h(0), h(1), h(2), h(3), h(4), h(5), h(6), h(7), h(8);
  H = T_image.inverse() * H * T_plane;
  if (!H.allFinite()) return std::nullopt;
  return Eigen::Matrix3d(H / H.norm());
}

std::optional<Rigid3> PoseFromHomography(const Eigen::Matrix3d& H) {
  const double scale = 0.5 * (H.col(0).norm() + H.col(1).norm());
  if (!(scale > 1e-12) || std::abs(H(2, 2)) < 1e-12) return std::nullopt;
  const Eigen::Matrix3d scaled = H / (H(2, 2) > 0.0 ? scale : -scale);
  Eigen::Matrix3d R;
  R << scaled.col(0), scaled.col(1), scaled.col(0).cross(scaled.col(1));
  if (!(R.determinant() > 1e-9)) return std::nullopt;
  return Rigid3{NearestRotation(R), scaled.col(2)};
}

}  // namespace calibrato
