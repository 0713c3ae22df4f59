#include "calibrato/rendering/coverage.h"

#include <gtest/gtest.h>

#include <numeric>

namespace calibrato {
namespace {

using Corners = std::vector<Eigen::Vector2d>;

void Add(const Corners& corners, double weight, CoverageSum* sum) {
  for (size_t k = 0; k < corners.size(); ++k) {
    sum->AddSide(corners[k], corners[(k + 1) % corners.size()], weight);
  }
}

std::vector<float> Covered(const Corners& corners, Resolution resolution) {
  CoverageSum sum(resolution);
  Add(corners, 1.0, &sum);
  return std::move(sum).Finish(0.0);
}

void ExpectCells(const std::vector<float>& cells, const std::vector<double>& expected) {
  ASSERT_EQ(cells.size(), expected.size());
  for (size_t k = 0; k < cells.size(); ++k) EXPECT_NEAR(cells[k], expected[k], 1e-6) << k;
}

TEST(Coverage, OfATriangleIsItsAreaInEachCell) {
  // Anticlockwise as one sees it, v downwards.
  ExpectCells(Covered({{0.0, 0.0}, {0.0, 2.0}, {2.0, 2.0}}, {3, 2}),
              {0.5, 0.0, 0.0, 1.0, 0.5, 0.0});
  // A side that crosses three cells in one row: from (0.5, 0) to (2.5, 1).
  ExpectCells(Covered({{0.5, 0.0}, {0.5, 1.0}, {2.5, 1.0}}, {4, 1}), {0.4375, 0.5, 0.0625, 0.0});
}

TEST(Coverage, IsNegativeForTheOtherDirection) {
  ExpectCells(Covered({{0.25, 0.25}, {0.75, 0.25}, {0.75, 0.75}, {0.25, 0.75}}, {1, 1}), {-0.25});
}

TEST(Coverage, ReachesBeyondTheRasterOnAllSides) {
  const Corners around = {{-7.0, -3.0}, {-7.0, 9.0}, {12.0, 9.0}, {12.0, -3.0}};
  ExpectCells(Covered(around, {2, 2}), {1.0, 1.0, 1.0, 1.0});
  // A band along the diagonal, from far outside to far outside.
  const Corners band = {{-1e6, -1e6}, {-1e6 + 0.0, -1e6 + 1.0}, {1e6, 1e6 + 1.0}, {1e6, 1e6}};
  ExpectCells(Covered(band, {2, 2}), {0.5, 0.0, 0.5, 0.5});
  const Corners beside = {{5.0, 0.0}, {5.0, 2.0}, {6.0, 2.0}};
  ExpectCells(Covered(beside, {2, 2}), {0.0, 0.0, 0.0, 0.0});
  const Corners before = {{-6.0, 0.0}, {-6.0, 2.0}, {-5.0, 2.0}};
  ExpectCells(Covered(before, {2, 2}), {0.0, 0.0, 0.0, 0.0});
}

TEST(Coverage, AddsUpToThePolygonsArea) {
  const Corners corners = {{3.1, 2.7},  {1.3, 8.9},  {7.7, 14.2},
                           {15.3, 9.6}, {11.2, 1.4}, {6.0, 6.1}};
  double area = 0.0;
  for (size_t k = 0; k < corners.size(); ++k) {
    const Eigen::Vector2d& a = corners[k];
    const Eigen::Vector2d& b = corners[(k + 1) % corners.size()];
    area -= 0.5 * (a.x() * b.y() - a.y() * b.x());
  }
  const std::vector<float> cells = Covered(corners, {17, 16});
  EXPECT_NEAR(std::accumulate(cells.begin(), cells.end(), 0.0), area, 1e-4);
  for (const float cell : cells) EXPECT_TRUE(cell > -1e-6F && cell < 1.0F + 1e-6F);
}

TEST(Coverage, LeavesAHoleWhereADirectionIsReversed) {
  CoverageSum sum({3, 3});
  Add({{0.0, 0.0}, {0.0, 3.0}, {3.0, 3.0}, {3.0, 0.0}}, 2.0, &sum);
  Add({{1.0, 1.0}, {2.0, 1.0}, {2.0, 2.0}, {1.0, 2.0}}, 2.0, &sum);
  ExpectCells(std::move(sum).Finish(0.5), {2.5, 2.5, 2.5, 2.5, 0.5, 2.5, 2.5, 2.5, 2.5});
}

}  // namespace
}  // namespace calibrato
