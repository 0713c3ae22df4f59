#include "calibrato/calibration/plane_pose.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>

#include "calibrato/geometry/so3.h"

namespace calibrato {
namespace {

using Vector9d = Eigen::Matrix<double, 9, 1>;
using Matrix9d = Eigen::Matrix<double, 9, 9>;

// Shifts the centroid to the origin and scales the mean distance to sqrt(2); nothing for points on
// a line.
std::optional<Eigen::Matrix3d> Normalisation(const Eigen::Matrix2Xd& points) {
  const Eigen::Vector2d centroid = points.rowwise().mean();
  const Eigen::Matrix2Xd centred = points.colwise() - centroid;
  const Eigen::Matrix2d scatter = centred * centred.transpose();
  if (!(scatter.determinant() > 1e-12 * scatter.trace() * scatter.trace())) return std::nullopt;
  const double scale = std::sqrt(2.0) / centred.colwise().norm().mean();
  Eigen::Matrix3d T;
  T << scale, 0.0, -scale * centroid.x(), 0.0, scale, -scale * centroid.y(), 0.0, 0.0, 1.0;
  return T;
}

// Whether the rays lie in a plane, so that the points are seen on a line.
bool AreCoplanar(const Eigen::Matrix3Xd& unit_rays) {
  const Eigen::Vector3d middle = unit_rays.rowwise().sum().normalized();
  if (!middle.allFinite()) return false;
  const Eigen::Matrix3Xd across = unit_rays - middle * (middle.transpose() * unit_rays);
  const Eigen::Matrix3d scatter = across * across.transpose();
  // Its third eigenvalue, along the middle, is zero: the product of the other two is this.
  const double trace = scatter.trace();
  const double product = 0.5 * (trace * trace - scatter.squaredNorm());
  return !(product > 1e-6 * trace * trace);
}

// The eigenvector of the least eigenvalue, by inverse iteration.
std::optional<Vector9d> NullVector(Matrix9d N) {
  const double size = N.trace();
  N.diagonal().array() += 1e-14 * size;
  const Eigen::LDLT<Matrix9d> ldlt(N);
  // Generic numbers: no symmetry of a board makes them orthogonal to the solution.
  Vector9d h;
  h << 0.83, -0.31, 0.22, 0.47, 0.91, -0.56, 0.13, 0.29, 1.07;
  for (int i = 0; i < 8; ++i) h = ldlt.solve(h).normalized();
  if (!h.allFinite()) return std::nullopt;
  return h;
}

}  // namespace

std::optional<Rigid3> PoseFromRays(const Eigen::Matrix2Xd& plane, const Eigen::Matrix3Xd& rays) {
  if (plane.cols() < 4 || plane.cols() != rays.cols()) return std::nullopt;
  const auto T = Normalisation(plane);
  const Eigen::Matrix3Xd unit_rays = rays.colwise().normalized();
  if (!T || AreCoplanar(unit_rays)) return std::nullopt;
  // |d x Hp|^2 = (Hp)' (I - d d') (Hp): block (a, b) of its matrix is the sum of
  // (I - d d')_ab p p'.
  Matrix9d N = Matrix9d::Zero();
  for (Eigen::Index k = 0; k < plane.cols(); ++k) {
    const Eigen::Vector3d p = *T * plane.col(k).homogeneous();
    const Eigen::Vector3d d = unit_rays.col(k);
    const Eigen::Matrix3d pp = p * p.transpose();
    for (int a = 0; a < 3; ++a) {
      for (int b = 0; b < 3; ++b) {
        N.block<3, 3>(3 * a, 3 * b) += ((a == b ? 1.0 : 0.0) - d(a) * d(b)) * pp;
      }
    }
  }
  const auto h = NullVector(N);
  if (!h) return std::nullopt;
  Eigen::Matrix3d H;
  H << h->segment<3>(0).transpose(), h->segment<3>(3).transpose(), h->segment<3>(6).transpose();
  H = H * *T;
  const double front = (H * plane.colwise().homogeneous()).cwiseProduct(rays).colwise().sum().sum();
  const double scale = 0.5 * (H.col(0).norm() + H.col(1).norm());
  if (!(scale > 0.0) || !(std::abs(front) > 0.0)) return std::nullopt;
  H /= front > 0.0 ? scale : -scale;
  Eigen::Matrix3d R;
  R << H.col(0), H.col(1), H.col(0).cross(H.col(1));
  if (!(R.determinant() > 1e-9)) return std::nullopt;
  return Rigid3{NearestRotation(R), H.col(2)};
}

std::optional<Rigid3> PoseFromView(const CameraModel& model, const BoardView& view) {
  Eigen::Matrix2Xd plane(2, view.num_corners());
  Eigen::Matrix3Xd rays(3, view.num_corners());
  Eigen::Index n = 0;
  for (Eigen::Index k = 0; k < view.num_corners(); ++k) {
    const auto ray = model.Unproject(view.pixels.col(k));
    if (!ray) continue;
    plane.col(n) = view.points_g.col(k).head<2>();
    rays.col(n) = ray->normalized();
    ++n;
  }
  return PoseFromRays(plane.leftCols(n), rays.leftCols(n));
}

Rigid3 MirroredPose(const Rigid3& T_c_g, const Eigen::Vector3d& middle_g) {
  const Eigen::Vector3d middle_c = T_c_g * middle_g;
  const Eigen::Vector3d sight = middle_c.normalized();
  const Eigen::Vector3d normal = T_c_g.R.col(2);
  const Eigen::Vector3d mirrored = 2.0 * sight * sight.dot(normal) - normal;
  // The shortest turn from one normal to the other.
  const Eigen::Vector3d axis = normal.cross(mirrored);
  const double sine = axis.norm();
  if (!(sine > 1e-9)) return T_c_g;
  const Eigen::Matrix3d R = ExpSo3(std::atan2(sine, normal.dot(mirrored)) / sine * axis) * T_c_g.R;
  return {R, middle_c - R * middle_g};
}

}  // namespace calibrato
