#include "calibrato/calibration/board_bending.h"

#include <map>

namespace calibrato {
namespace {

Eigen::Vector3d Quadratic(const Eigen::Vector2d& p) {
  return {p.x() * p.x(), p.x() * p.y(), p.y() * p.y()};
}

}  // namespace

BendingShapes::BendingShapes(const std::vector<const BoardView*>& views) {
  std::map<int, Eigen::Vector3d> corners;
  for (const BoardView* view : views) {
    for (size_t k = 0; k < view->corner_ids.size(); ++k) {
      corners.emplace(view->corner_ids[k], view->points_g.col(static_cast<Eigen::Index>(k)));
    }
  }
  if (corners.empty()) return;
  corners_g_.resize(3, static_cast<Eigen::Index>(corners.size()));
  Eigen::Index next = 0;
  for (const auto& [id, point_g] : corners) corners_g_.col(next++) = point_g;
  const Eigen::Matrix2Xd plane = corners_g_.topRows<2>();
  middle_ = 0.5 * (plane.rowwise().minCoeff() + plane.rowwise().maxCoeff());
  for (Eigen::Index k = 0; k < plane.cols(); ++k) mean_ += Quadratic(plane.col(k) - middle_);
  mean_ /= static_cast<double>(plane.cols());
}

Eigen::Vector3d BendingShapes::At(const Eigen::Vector3d& point_g) const {
  return Quadratic(point_g.head<2>() - middle_) - mean_;
}

BoardView BendingShapes::Bent(const BoardView& view, const BoardBending& bending) const {
  BoardView bent = view;
  for (Eigen::Index k = 0; k < view.num_corners(); ++k) {
    bent.points_g(2, k) += bending.coefficients.dot(At(view.points_g.col(k)));
  }
  return bent;
}

double BendingShapes::Depth(const BoardBending& bending) const {
  if (corners_g_.cols() == 0) return 0.0;
  Eigen::VectorXd z(corners_g_.cols());
  for (Eigen::Index k = 0; k < z.size(); ++k)
    z(k) = bending.coefficients.dot(At(corners_g_.col(k)));
  return z.maxCoeff() - z.minCoeff();
}

}  // namespace calibrato
