#include "calibrato/detection/lattice.h"

#include <gtest/gtest.h>

namespace calibrato {
namespace {

// A grid seen in perspective and through a lens that bends it.
std::vector<Eigen::Vector2d> BentGrid(int rows, int columns) {
  std::vector<Eigen::Vector2d> points;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const double w = 1.0 + 0.04 * row + 0.02 * column;
      const Eigen::Vector2d p(100.0 + 30.0 * column / w, 80.0 + 28.0 * row / w);
      points.emplace_back(p * (1.0 + 4e-7 * p.squaredNorm()));
    }
  }
  return points;
}

std::vector<LatticeNode> Grow(const std::vector<Eigen::Vector2d>& points, int seed,
                              const Eigen::Matrix2d& steps) {
  return GrowLattice(points, PointIndex(points), {seed, steps}, [](int, int) { return true; });
}

const Eigen::Matrix2d kSteps = (Eigen::Matrix2d() << 0.0, 26.0, 26.0, 0.0).finished();

TEST(Lattice, GrowsOverABentGridAndOverNothingElse) {
  std::vector<Eigen::Vector2d> points = BentGrid(6, 8);
  points.emplace_back(20.0, 20.0);
  points.emplace_back(400.0, 30.0);
  const std::vector<LatticeNode> nodes = Grow(points, 21, kSteps);
  ASSERT_EQ(nodes.size(), 48u);
  for (const LatticeNode& node : nodes) {
    // Point 21 is at row 2, column 5 of the grid.
    EXPECT_EQ(node.point, (node.row + 2) * 8 + node.column + 5);
  }
}

TEST(Lattice, AsksWhetherPointsCanBeNeighbours) {
  const std::vector<Eigen::Vector2d> points = BentGrid(3, 4);
  const auto same_row = [](int from, int to) { return from / 4 == to / 4; };
  EXPECT_EQ(GrowLattice(points, PointIndex(points), {5, kSteps}, same_row).size(), 4u);
}

TEST(Lattice, IsTheBoardWhicheverWayItWasCounted) {
  const std::vector<Eigen::Vector2d> points = BentGrid(4, 6);
  std::vector<int> expected(24);
  for (int k = 0; k < 24; ++k) expected[static_cast<size_t>(k)] = k;
  EXPECT_EQ(BlockOfLattice(Grow(points, 9, kSteps), 4, 6), expected);
  const Eigen::Matrix2d turned = kSteps.rowwise().reverse();
  EXPECT_EQ(BlockOfLattice(Grow(points, 9, turned), 4, 6), expected);
}

TEST(Lattice, IsNoBoardOfAnotherSize) {
  const std::vector<LatticeNode> nodes = Grow(BentGrid(4, 6), 9, kSteps);
  EXPECT_TRUE(BlockOfLattice(nodes, 4, 7).empty());
  EXPECT_TRUE(BlockOfLattice(nodes, 5, 6).empty());
  EXPECT_TRUE(BlockOfLattice(nodes, 4, 5).empty());
  EXPECT_TRUE(BlockOfLattice(nodes, 3, 6).empty());
}

TEST(Lattice, MayMissAPointInTenAndHaveAStrayOne) {
  std::vector<LatticeNode> nodes = Grow(BentGrid(4, 6), 9, kSteps);
  std::erase_if(nodes, [](const LatticeNode& node) { return node.point == 8; });
  nodes.push_back({-2, 0, 99});  // above the grid, of which row -1 is the first
  const std::vector<int> block = BlockOfLattice(nodes, 4, 6);
  ASSERT_EQ(block.size(), 24u);
  EXPECT_EQ(block[8], -1);
  EXPECT_EQ(block[23], 23);
  std::erase_if(nodes, [](const LatticeNode& node) { return node.point % 5 == 0; });
  EXPECT_TRUE(BlockOfLattice(nodes, 4, 6).empty());
}

TEST(Lattice, FillsGapsFromTheirNeighbours) {
  const auto at = [](int row, int column) -> std::optional<Eigen::Vector2d> {
    return Eigen::Vector2d(10.0 * column + row, 12.0 * row - column);
  };
  PixelGrid grid;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) grid.push_back(at(row, column));
  }
  grid[5] = std::nullopt;   // inside
  grid[15] = std::nullopt;  // a corner
  PixelGrid filled = WithGapsFilled(grid, 4, 4);
  ASSERT_TRUE(filled[5] && filled[15]);
  EXPECT_LT((*filled[5] - *at(1, 1)).norm(), 1e-12);
  EXPECT_LT((*filled[15] - *at(3, 3)).norm(), 1e-12);

  PixelGrid lonely(16);
  lonely[0] = at(0, 0);
  filled = WithGapsFilled(lonely, 4, 4);
  EXPECT_FALSE(filled[1]);
}

TEST(PointIndex, VisitsAllPointsNearAPlace) {
  const std::vector<Eigen::Vector2d> points = BentGrid(9, 11);
  const PointIndex index(points);
  for (const Eigen::Vector2d& place :
       {Eigen::Vector2d(150.0, 120.0), Eigen::Vector2d(-50.0, 900.0), points[17]}) {
    for (const double radius : {5.0, 40.0, 1000.0}) {
      std::vector<bool> is_visited(points.size(), false);
      index.VisitNear(place, radius, [&](int k) { is_visited[static_cast<size_t>(k)] = true; });
      for (size_t k = 0; k < points.size(); ++k) {
        EXPECT_TRUE(is_visited[k] || (points[k] - place).norm() > radius) << k;
      }
    }
  }
}

}  // namespace
}  // namespace calibrato
