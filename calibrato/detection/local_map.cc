#include "calibrato/detection/local_map.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>
#include <opencv2/calib3d.hpp>

namespace calibrato {
namespace {

constexpr Eigen::Index kMaxNeighbours = 24;  // of the point, besides itself
constexpr Eigen::Index kMinNeighbours = 7;   // for a quadratic polynomial
// For a cubic one, without which the second derivatives at a board's corners, where all neighbours
// are on one side, would be those of a place farther in.
constexpr Eigen::Index kMinNeighboursForCubic = 16;

Eigen::Matrix3d FitHomography(const Eigen::Matrix2Xd& board, const Eigen::Matrix2Xd& pixels) {
  std::vector<cv::Point2d> from;
  std::vector<cv::Point2d> to;
  for (Eigen::Index k = 0; k < board.cols(); ++k) {
    from.emplace_back(board(0, k), board(1, k));
    to.emplace_back(pixels(0, k), pixels(1, k));
  }
  const cv::Mat fitted = cv::findHomography(from, to, 0);
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
  if (fitted.empty()) return H;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) H(row, column) = fitted.at<double>(row, column);
  }
  return H;
}

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

std::vector<LocalMap> FitLocalMaps(const Eigen::Matrix2Xd& board, const Eigen::Matrix2Xd& pixels) {
  const Eigen::Index n = board.cols();
  assert(n >= 4 && pixels.cols() == n);
  const Eigen::Matrix3d H = FitHomography(board, pixels);
  Eigen::Matrix2Xd left_over(2, n);
  std::vector<LocalMap> maps;
  for (Eigen::Index k = 0; k < n; ++k) {
    maps.push_back(Expand(H, board.col(k)));
    left_over.col(k) = pixels.col(k) - maps.back().pixel;
  }
  std::vector<Eigen::Index> order(static_cast<size_t>(n));
  for (Eigen::Index k = 0; k < n; ++k) {
    LocalMap& map = maps[static_cast<size_t>(k)];
    map.pixel = pixels.col(k);
    const Eigen::Index count = std::min(n, kMaxNeighbours + 1);
    if (count < kMinNeighbours + 1) continue;
    const Eigen::RowVectorXd distances = (board.colwise() - board.col(k)).colwise().squaredNorm();
    std::iota(order.begin(), order.end(), 0);
    const auto is_nearer = [&](Eigen::Index a, Eigen::Index b) {
      return distances(a) != distances(b) ? distances(a) < distances(b) : a < b;
    };
    std::partial_sort(order.begin(), order.begin() + count, order.end(), is_nearer);
    const double scale = 1.0 / std::sqrt(distances(order[static_cast<size_t>(count - 1)]));
    Eigen::Matrix<double, kNumTerms, kNumTerms> normal =
        1e-9 * Eigen::Matrix<double, kNumTerms, kNumTerms>::Identity();
    if (count < kMinNeighboursForCubic + 1) {
      // So heavy that they stay at zero.
      normal.diagonal().tail<kNumTerms - kNumQuadratic>().setConstant(1e6);
    }
    Eigen::Matrix<double, kNumTerms, 2> right = Eigen::Matrix<double, kNumTerms, 2>::Zero();
    for (Eigen::Index i = 0; i < count; ++i) {
      const Eigen::Index neighbour = order[static_cast<size_t>(i)];
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
