#include "calibrato/detection/local_map.h"

#include <gtest/gtest.h>

#include <cmath>

namespace calibrato {
namespace {

constexpr int kRows = 7;
constexpr int kColumns = 8;
constexpr double kSpacing = 0.05;

Eigen::Matrix2Xd Board() {
  Eigen::Matrix2Xd board(2, kRows * kColumns);
  for (int k = 0; k < board.cols(); ++k) {
    board.col(k) << kSpacing * (k / kColumns), kSpacing * (k % kColumns);
  }
  return board;
}

Eigen::Vector2d Perspective(const Eigen::Vector2d& x) {
  const double w = 1.0 + 0.6 * x.x() - 0.3 * x.y();
  return {100.0 + (500.0 * x.y() + 40.0 * x.x()) / w, 90.0 + (480.0 * x.x() - 30.0 * x.y()) / w};
}

Eigen::Vector2d ThroughALens(const Eigen::Vector2d& x) {
  const Eigen::Vector2d p = Perspective(x) - Eigen::Vector2d(200.0, 200.0);
  return p * (1.0 - 2e-6 * p.squaredNorm()) + Eigen::Vector2d(200.0, 200.0);
}

template <typename Map>
std::vector<LocalMap> MapsOf(const Map& map) {
  const Eigen::Matrix2Xd board = Board();
  Eigen::Matrix2Xd pixels(2, board.cols());
  for (Eigen::Index k = 0; k < board.cols(); ++k) pixels.col(k) = map(board.col(k));
  return FitLocalMaps(board, pixels);
}

// By differences of the map itself.
template <typename Map>
Eigen::Matrix<double, 2, 3> SecondDerivatives(const Map& map, const Eigen::Vector2d& x) {
  constexpr double h = 1e-4;
  const Eigen::Vector2d dx(h, 0.0);
  const Eigen::Vector2d dy(0.0, h);
  Eigen::Matrix<double, 2, 3> second;
  second << map(x + dx) - 2.0 * map(x) + map(x - dx),
      0.25 * (map(x + dx + dy) + map(x - dx - dy) - map(x + dx - dy) - map(x - dx + dy)),
      map(x + dy) - 2.0 * map(x) + map(x - dy);
  return second / (h * h);
}

TEST(LocalMap, IsExactInPerspective) {
  const Eigen::Matrix2Xd board = Board();
  const std::vector<LocalMap> maps = MapsOf(Perspective);
  for (const int k : {0, 7, 27, 55}) {
    const LocalMap& map = maps[static_cast<size_t>(k)];
    const Eigen::Matrix<double, 2, 3> second = SecondDerivatives(Perspective, board.col(k));
    EXPECT_LT((map.second - second).norm(), 1e-3 * second.norm()) << k;
    EXPECT_EQ(map.pixel, Perspective(board.col(k)));
  }
}

TEST(LocalMap, FollowsALensToATenthInsideTheBoard) {
  const Eigen::Vector2d middle = Board().col(27);
  const Eigen::Matrix<double, 2, 3> second = SecondDerivatives(ThroughALens, middle);
  EXPECT_LT((MapsOf(ThroughALens)[27].second - second).norm(), 0.1 * second.norm());
}

TEST(LocalMap, IsSurprisedByAPointThatIsOutOfPlace) {
  const Eigen::Matrix2Xd board = Board();
  Eigen::Matrix2Xd pixels(2, board.cols());
  for (Eigen::Index k = 0; k < board.cols(); ++k) pixels.col(k) = ThroughALens(board.col(k));
  for (const LocalMap& map : FitLocalMaps(board, pixels)) EXPECT_LT(map.surprise, 0.6);
  pixels.col(20) += Eigen::Vector2d(4.0, -3.0);
  EXPECT_NEAR(FitLocalMaps(board, pixels)[20].surprise, 5.0, 0.5);
}

TEST(LocalMap, KnowsHowAStraightLineBends) {
  // A line y = const whose image is a circle of radius 250 px about (0, 250), turning left of its
  // direction in (u, v): curvature +1/250.
  const auto circle = [](const Eigen::Vector2d& x) {
    const double angle = 2.0 * x.x();
    return Eigen::Vector2d((250.0 - 100.0 * x.y()) * std::sin(angle),
                           250.0 - (250.0 - 100.0 * x.y()) * std::cos(angle));
  };
  const std::vector<LocalMap> maps = MapsOf(circle);
  EXPECT_NEAR(maps[3 * kColumns].CurvatureAlong(Eigen::Vector2d::UnitX()), 1.0 / 250.0, 1e-4);
  EXPECT_NEAR(maps[3 * kColumns].CurvatureAlong(-Eigen::Vector2d::UnitX()), -1.0 / 250.0, 1e-4);
  EXPECT_NEAR(maps[27].CurvatureAlong(Eigen::Vector2d::UnitY()), 0.0, 1e-4);
}

TEST(LocalMap, KnowsTheCentroidOfADiscsImage) {
  // u = x + x^2/2, v = y over a disc of radius r: du dv = (1 + x) dx dy, so the mean of u is
  // (<x^2> + <x^2>/2) / 1 = 3/2 * r^2/4, since <x> = <x^3> = 0; that of v is 0.
  LocalMap map;
  map.J_pixel_board.setIdentity();
  map.second.col(0) = Eigen::Vector2d::UnitX();
  constexpr double kRadius = 0.2;
  EXPECT_NEAR(map.CentroidOffset(kRadius).x(), 0.375 * kRadius * kRadius, 1e-12);
  EXPECT_NEAR(map.CentroidOffset(kRadius).y(), 0.0, 1e-12);
}

TEST(LocalMap, FindsNeighboursOnAnyBoard) {
  // In one long row of pairs, and where there are hardly more points than neighbours asked for.
  for (const int length : {10, 300}) {
    Eigen::Matrix2Xd board(2, 2 * length);
    Eigen::Matrix2Xd pixels(2, 2 * length);
    for (int k = 0; k < 2 * length; ++k) {
      board.col(k) << 0.05 * (k % 2), 0.01 * (k / 2);
      pixels.col(k) = Perspective(board.col(k));
    }
    for (const LocalMap& map : FitLocalMaps(board, pixels)) EXPECT_LT(map.surprise, 1e-3);
    pixels(0, 7) += 3.0;
    EXPECT_NEAR(FitLocalMaps(board, pixels)[7].surprise, 3.0, 0.5);
  }
}

}  // namespace
}  // namespace calibrato
