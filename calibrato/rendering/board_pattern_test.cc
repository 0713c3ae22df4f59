#include "calibrato/rendering/board_pattern.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "calibrato/rendering/cell_outlines.h"
#include "calibrato/rendering/marker_bits.h"

namespace calibrato {
namespace {

double Area(const BoardPattern::Outline& outline) {
  double area = 0.0;
  for (size_t k = 0; k < outline.size(); ++k) {
    const Eigen::Vector2d& a = outline[k];
    const Eigen::Vector2d& b = outline[(k + 1) % outline.size()];
    area += 0.5 * (a.x() * b.y() - a.y() * b.x());
  }
  return area;
}

double BlackArea(const BoardPattern& pattern) {
  double area = 0.0;
  for (const BoardPattern::Outline& outline : pattern.outlines) area += Area(outline);
  for (const BoardPattern::Disc& disc : pattern.discs) {
    area += std::numbers::pi * disc.radius_m * disc.radius_m;
  }
  return area;
}

// By the number of sides to the right of a point: another way than the renderer's.
bool IsBlack(const BoardPattern& pattern, const Eigen::Vector2d& p) {
  bool is_black = false;
  for (const BoardPattern::Outline& outline : pattern.outlines) {
    for (size_t k = 0; k < outline.size(); ++k) {
      const Eigen::Vector2d& a = outline[k];
      const Eigen::Vector2d& b = outline[(k + 1) % outline.size()];
      if ((a.y() > p.y()) == (b.y() > p.y())) continue;
      if (p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x())) is_black = !is_black;
    }
  }
  return is_black;
}

int NumBlack(const MarkerBits& bits) {
  int count = 0;
  for (const std::vector<bool>& row : bits) {
    for (const bool is_white : row) count += is_white ? 0 : 1;
  }
  return count;
}

TEST(CellOutlines, OfASquareIsOneOutlineOfFourCorners) {
  const auto outlines = OutlinesOfFalse({{false, false}, {false, false}});
  ASSERT_EQ(outlines.size(), 1U);
  const std::set<std::pair<int, int>> corners(outlines[0].begin(), outlines[0].end());
  EXPECT_EQ(corners, (std::set<std::pair<int, int>>{{0, 0}, {2, 0}, {2, 2}, {0, 2}}));
}

TEST(CellOutlines, RunTheOtherWayAroundAHole) {
  const auto outlines =
      OutlinesOfFalse({{false, false, false}, {false, true, false}, {false, false, false}});
  ASSERT_EQ(outlines.size(), 2U);
  const auto area = [](const CellOutline& cells) {
    BoardPattern::Outline outline;
    for (const auto& [row, column] : cells) outline.emplace_back(row, column);
    return Area(outline);
  };
  EXPECT_EQ(area(outlines[0]), 9.0);
  EXPECT_EQ(area(outlines[1]), -1.0);
}

TEST(CellOutlines, StayApartWhereCellsTouchInACorner) {
  EXPECT_EQ(OutlinesOfFalse({{false, true}, {true, false}}).size(), 2U);
}

TEST(BoardPattern, OfACheckerboardIsBlackBeforeItsFirstCorner) {
  const Checkerboard board{3, 4, 0.06, 0.05};
  const BoardPattern pattern = PatternOf(board);
  EXPECT_EQ(pattern.outlines.size(), 10U);  // of 4 x 5 squares
  EXPECT_NEAR(BlackArea(pattern), 10 * 0.06 * 0.05, 1e-12);
  EXPECT_TRUE(IsBlack(pattern, {-0.01, -0.01}));
  EXPECT_FALSE(IsBlack(pattern, {0.01, -0.01}));
  EXPECT_FALSE(IsBlack(pattern, {-0.01, 0.01}));
  // Around every corner two squares of four are black, opposite ones.
  const Eigen::Matrix3Xd points = BoardPoints(board);
  for (const auto& point : points.colwise()) {
    const auto at = [&](double x, double y) {
      return IsBlack(pattern, point.head<2>() + Eigen::Vector2d(x, y));
    };
    EXPECT_EQ(at(0.01, 0.01), at(-0.01, -0.01));
    EXPECT_EQ(at(0.01, -0.01), at(-0.01, 0.01));
    EXPECT_NE(at(0.01, 0.01), at(-0.01, 0.01));
  }
  EXPECT_TRUE(pattern.sheet.contains(Eigen::Vector2d(-0.08, -0.07)));
}

TEST(BoardPattern, OfAnAprilGridTouchesEveryCornerWithASmallSquare) {
  const AprilGrid board{2, 3, 0.1, 0.3};
  const BoardPattern pattern = PatternOf(board);
  double expected = 12 * 0.03 * 0.03;
  for (int tag = 0; tag < 6; ++tag) expected += 1e-4 * NumBlack(AprilGridTag(tag));
  EXPECT_NEAR(BlackArea(pattern), expected, 1e-9);
  const double offset = 0.005;
  const Eigen::Matrix3Xd points = BoardPoints(board);
  for (const auto& point : points.colwise()) {
    const auto at = [&](double x, double y) {
      return IsBlack(pattern, point.head<2>() + Eigen::Vector2d(x, y));
    };
    EXPECT_EQ(at(offset, offset), at(-offset, -offset));
    EXPECT_NE(at(offset, offset), at(-offset, offset));
    EXPECT_NE(at(offset, offset), at(offset, -offset));
  }
}

TEST(BoardPattern, OfACircleGridHasADiscAtEachPoint) {
  const CircleGrid board{11, 4, 0.02, true};
  const BoardPattern pattern = PatternOf(board);
  ASSERT_EQ(pattern.discs.size(), 44U);
  EXPECT_NEAR(pattern.discs[0].radius_m, 0.02 * std::numbers::sqrt2 / 4.0, 1e-15);
  EXPECT_LT((pattern.discs[13].centre - BoardPoints(board).col(13).head<2>()).norm(), 1e-15);
}

TEST(BoardPattern, OfACharucoBoardHasItsMarkersInWhiteSquares) {
  const Charuco board{3, 4, 0.08, 0.06, "DICT_4X4_50"};
  const BoardPattern pattern = PatternOf(board);
  double expected = 6 * 0.08 * 0.08;
  for (int id = 0; id < 6; ++id) expected += 1e-4 * NumBlack(DictionaryMarker("DICT_4X4_50", id));
  EXPECT_NEAR(BlackArea(pattern), expected, 1e-9);
  // Marker 0 is in square (0, 1), its rows along x and its columns along y; modules of 10 mm.
  const MarkerBits bits = DictionaryMarker("DICT_4X4_50", 0);
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 6; ++column) {
      const Eigen::Vector2d p(-0.07 + 0.01 * (row + 0.5), 0.01 + 0.01 * (column + 0.5));
      EXPECT_EQ(IsBlack(pattern, p), !bits[row][column]) << row << " " << column;
    }
  }
}

}  // namespace
}  // namespace calibrato
