#include "calibrato/detection/corner_view.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cassert>

namespace calibrato {
namespace {

constexpr Eigen::Index kMinCorners = 8;

// Whether the points spread over a plane, the shorter way by at least a hundredth of the longer.
bool AreSpread(const Eigen::Matrix3Xd& points_g) {
  const Eigen::Matrix2Xd centred =
      points_g.topRows<2>().colwise() - points_g.topRows<2>().rowwise().mean();
  const Eigen::Matrix2d scatter = centred * centred.transpose();
  const Eigen::Vector2d squares =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(scatter, Eigen::EigenvaluesOnly).eigenvalues();
  return squares(0) > 1e-4 * squares(1);
}

}  // namespace

std::optional<BoardView> ViewOf(const std::vector<std::optional<Eigen::Vector2d>>& corners,
                                const Eigen::Matrix3Xd& points_g) {
  assert(points_g.cols() == static_cast<Eigen::Index>(corners.size()));
  BoardView view;
  for (size_t k = 0; k < corners.size(); ++k) {
    if (corners[k]) view.corner_ids.push_back(static_cast<int>(k));
  }
  const auto count = static_cast<Eigen::Index>(view.corner_ids.size());
  if (count < std::min(kMinCorners, points_g.cols())) return std::nullopt;
  view.pixels.resize(2, count);
  view.points_g.resize(3, count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const int id = view.corner_ids[static_cast<size_t>(k)];
    view.pixels.col(k) = *corners[static_cast<size_t>(id)];
    view.points_g.col(k) = points_g.col(id);
  }
  if (!AreSpread(view.points_g)) return std::nullopt;
  return view;
}

}  // namespace calibrato
