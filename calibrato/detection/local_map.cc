#include "calibrato/detection/local_map.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "calibrato/detection/homography.h"
#include "calibrato/detection/lattice.h"

namespace calibrato {
namespace {

constexpr Eigen::Index kMaxNeighbours = 24;  // of the point, besides itself
constexpr Eigen::Index kMinNeighbours = 7;   // for a quadratic polynomial
// For a cubic one, without which the second derivatives at a board's corners, where all neighbours
// are on one side, would be those of a place farther in.
constexpr Eigen::Index kMinNeighboursForCubic = 16;

// The homography to second order around a point.
LocalMap Expand(const Eigen::Matrix3d& H, const Eigen::Vector2d& point) {
  const Eigen::Vector3d h = H * point.homogeneous();
  const Eigen::Vector2d pixel = h.head<2>() / h.z();
  const Eigen::RowVector2d g = H.block<1, 2>(2, 0) / h.z();
  LocalMap map;
  map.pixel = pixel;
  map.J_pixel_board = H.topLeftCorner<2, 2>() / h.z() - pixel * g;
  const Eigen::Matrix2d& J = map.J_pixel_board;
  // Differentiate J once more: -(J_i g_j + J_j g_i).
  map.second.col(0) = -2.0 * J.col(0) * g(0);
  map.second.col(1) = -(J.col(0) * g(1) + J.col(1) * g(0));
  map.second.col(2) = -2.0 * J.col(1) * g(1);
  return map;
}

// Finds a point's neighbours on the board without looking at all points.
class Neighbourhoods {
 public:
  // PointIndex thinks in pixels: the points are put about kSpacing apart.
  explicit Neighbourhoods(const Eigen::Matrix2Xd& board)
      : board_(board), points_(Spread(board)), index_(points_) {}

  // The `count` nearest ones, itself included, the nearest first; of equals the first.
  std::vector<Eigen::Index> Nearest(Eigen::Index k, Eigen::Index count) const {
    std::vector<Eigen::Index> near;
    const Eigen::Vector2d& here = points_[static_cast<size_t>(k)];
    // What lies within the radius is complete.
    for (double radius = kSpacing * std::sqrt(static_cast<double>(count) / 2.0);; radius *= 1.5) {
      near.clear();
      index_.VisitNear(here, radius, [&](int other) {
        if ((points_[static_cast<size_t>(other)] - here).norm() <= radius) near.push_back(other);
      });
      if (static_cast<Eigen::Index>(near.size()) >= count) break;
    }
    const auto is_nearer = [&](Eigen::Index a, Eigen::Index b) {
      const double to_a = (board_.col(a) - board_.col(k)).squaredNorm();
      const double to_b = (board_.col(b) - board_.col(k)).squaredNorm();
      return to_a != to_b ? to_a < to_b : a < b;
    };
    std::partial_sort(near.begin(), near.begin() + count, near.end(), is_nearer);
    near.resize(static_cast<size_t>(count));
    return near;
  }

 private:
  static constexpr double kSpacing = 10.0;

  static std::vector<Eigen::Vector2d> Spread(const Eigen::Matrix2Xd& board) {
    const Eigen::Vector2d extent = board.rowwise().maxCoeff() - board.rowwise().minCoeff();
    const double scale =
        kSpacing * std::sqrt(static_cast<double>(board.cols())) / extent.maxCoeff();
    std::vector<Eigen::Vector2d> points;
    for (Eigen::Index k = 0; k < board.cols(); ++k) points.emplace_back(scale * board.col(k));
    return points;
  }

  const Eigen::Matrix2Xd& board_;
  const std::vector<Eigen::Vector2d> points_;
  const PointIndex index_;
};

constexpr int kNumQuadratic = 6;
constexpr int kNumTerms = 10;
using Terms = Eigen::Matrix<double, kNumTerms, 1>;

Terms CubicTerms(const Eigen::Vector2d& position) {
  const double x = position.x();
  const double y = position.y();
  Terms terms;
  terms << 1.0, x, y, 0.5 * x * x, x * y, 0.5 * y * y, x * x * x, x * x * y, x * y * y, y * y * y;
  return terms;
}

}  // namespace

double LocalMap::CurvatureAlong(const Eigen::Vector2d& direction) const {
  const Eigen::Vector2d tangent = J_pixel_board * direction;
  const double squared_length = tangent.squaredNorm();
  const Eigen::Vector2d normal = Eigen::Vector2d(-tangent.y(), tangent.x()).normalized();
  const Eigen::Vector2d bend = second.col(0) * (direction.x() * direction.x()) +
                               second.col(1) * (2.0 * direction.x() * direction.y()) +
                               second.col(2) * (direction.y() * direction.y());
  return normal.dot(bend) / squared_length;
}

Eigen::Vector2d LocalMap::CentroidOffset(double radius) const {
  const Eigen::Matrix2d inverse = J_pixel_board.inverse();
  Eigen::Matrix2d J_x;
  J_x << second.col(0), second.col(1);
  Eigen::Matrix2d J_y;
  J_y << second.col(1), second.col(2);
  const Eigen::Vector2d gradient((inverse * J_x).trace(), (inverse * J_y).trace());
  const double r2 = radius * radius;
  return r2 / 8.0 * (second.col(0) + second.col(2)) + r2 / 4.0 * (J_pixel_board * gradient);
}

std::vector<LocalMap> FitLocalMaps(const Eigen::Matrix2Xd& board, const Eigen::Matrix2Xd& pixels) {
  const Eigen::Matrix3d H = FitHomography(board, pixels);
  std::vector<LocalMap> maps;
  for (Eigen::Index k = 0; k < board.cols(); ++k) maps.push_back(Expand(H, board.col(k)));
  return WithLeftOver(board, pixels, std::move(maps));
}

std::vector<LocalMap> WithLeftOver(const Eigen::Matrix2Xd& board, const Eigen::Matrix2Xd& pixels,
                                   std::vector<LocalMap> maps) {
  const Eigen::Index n = board.cols();
  assert(n >= 4 && pixels.cols() == n && maps.size() == static_cast<size_t>(n));
  Eigen::Matrix2Xd left_over(2, n);
  for (Eigen::Index k = 0; k < n; ++k) {
    left_over.col(k) = pixels.col(k) - maps[static_cast<size_t>(k)].pixel;
  }
  const Neighbourhoods neighbourhoods(board);
  const Eigen::Index count = std::min(n, kMaxNeighbours + 1);
  for (Eigen::Index k = 0; k < n; ++k) {
    LocalMap& map = maps[static_cast<size_t>(k)];
    map.pixel = pixels.col(k);
    if (count < kMinNeighbours + 1) continue;
    const std::vector<Eigen::Index> nearest = neighbourhoods.Nearest(k, count);
    const double scale = 1.0 / (board.col(nearest.back()) - board.col(k)).norm();
    Eigen::Matrix<double, kNumTerms, kNumTerms> normal =
        1e-9 * Eigen::Matrix<double, kNumTerms, kNumTerms>::Identity();
    if (count < kMinNeighboursForCubic + 1) {
      // So heavy that they stay at zero.
      normal.diagonal().tail<kNumTerms - kNumQuadratic>().setConstant(1e6);
    }
    Eigen::Matrix<double, kNumTerms, 2> right = Eigen::Matrix<double, kNumTerms, 2>::Zero();
    for (const Eigen::Index neighbour : nearest) {
      const Terms terms = CubicTerms(scale * (board.col(neighbour) - board.col(k)));
      normal += terms * terms.transpose();
      right += terms * left_over.col(neighbour).transpose();
    }
    const auto factors = normal.ldlt();
    const Eigen::Matrix<double, kNumTerms, 2> fitted = factors.solve(right);
    // Leaving the point itself out of the fit would leave its residual larger by this.
    const double leverage = factors.solve(Terms::Unit(0))(0);
    map.surprise =
        (left_over.col(k) - fitted.row(0).transpose()).norm() / std::max(1e-3, 1.0 - leverage);
    map.J_pixel_board += scale * fitted.middleRows<2>(1).transpose();
    map.second += scale * scale * fitted.middleRows<3>(3).transpose();
  }
  return maps;
}

}  // namespace calibrato
