#include "calibrato/detection/find_circle_grid.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "calibrato/detection/draw_discs.h"

namespace calibrato {
namespace {

double WorstError(const BoardView& view, const Eigen::Matrix2Xd& truth) {
  return (view.pixels - truth(Eigen::all, view.corner_ids)).colwise().norm().maxCoeff();
}

TEST(FindCircleGrid, IsExactAtTheCornersOfAnObliqueBoardThroughAFisheye) {
  const ObliqueView view;
  const GreyImage image = DrawDiscs(view.board, view.lens, view.T_c_g, view.resolution);
  RejectionCounts rejected;
  const auto found = FindCircleGrid(image, view.board, &rejected);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->num_corners(), 28);
  EXPECT_EQ(rejected, RejectionCounts());
  EXPECT_LT(WorstError(*found, DrawnCentres(view.board, view.lens, view.T_c_g)), 0.05);
}

// Along the edge to the left, the discs of the next row but one are nearer than the next in the
// column, so that the walk from disc to disc goes astray.
TEST(FindCircleGrid, NumbersDiscsRightWhereOthersAreNearerThanTheirNeighbours) {
  ObliqueView view;
  const Eigen::Vector3d rotation(3.099, -0.451, -0.206);
  view.T_c_g = {Eigen::AngleAxisd(rotation.norm(), rotation.normalized()).toRotationMatrix(),
                {-0.3306, -0.0363, 0.2533}};
  const GreyImage image = DrawDiscs(view.board, view.lens, view.T_c_g, view.resolution);
  RejectionCounts rejected;
  const auto found = FindCircleGrid(image, view.board, &rejected);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->num_corners(), 28);
  EXPECT_LT(WorstError(*found, DrawnCentres(view.board, view.lens, view.T_c_g)), 0.05);
}

TEST(FindCircleGrid, CountsDiscsThatTheBorderCuts) {
  ObliqueView view;
  const Eigen::Matrix2Xd truth = DrawnCentres(view.board, view.lens, view.T_c_g);
  const GreyImage whole = DrawDiscs(view.board, view.lens, view.T_c_g, view.resolution);
  // Through the middle of the rightmost disc.
  GreyImage cut{{static_cast<int>(truth.row(0).maxCoeff()), 480}, {}};
  for (int v = 0; v < 480; ++v) {
    const auto row = whole.pixels.begin() + v * 640;
    cut.pixels.insert(cut.pixels.end(), row, row + cut.resolution.width);
  }
  RejectionCounts rejected;
  const auto found = FindCircleGrid(cut, view.board, &rejected);
  ASSERT_TRUE(found);
  EXPECT_LT(found->num_corners(), 28);
  EXPECT_EQ(found->num_corners() + rejected.corners_near_border, 28);
  EXPECT_EQ(rejected.corners_of_bad_fit, 0);
  EXPECT_LT(WorstError(*found, truth), 0.05);
}

// A perforated wall of 9000 holes, which would take minutes were its lattice grown from each of
// them.
TEST(FindCircleGrid, FindsTheBoardBeforeAWallOfDiscs) {
  const ObliqueView view;
  constexpr Resolution kResolution{1280, 960};
  GreyImage image{kResolution, std::vector<uint8_t>(1280 * 960, 220)};
  for (int v = 0; v < 960; ++v) {
    for (int u = 0; u < 1280; ++u) {
      const double du = std::remainder(u + 0.02 * v, 10.0);
      const double dv = std::remainder(v - 0.02 * u, 10.0);
      if (du * du + dv * dv < 9.0) image.pixels[static_cast<size_t>(v * 1280 + u)] = 40;
    }
  }
  const GreyImage board = DrawDiscs(view.board, view.lens, view.T_c_g, view.resolution);
  for (int v = 0; v < 480; ++v) {
    std::copy_n(board.pixels.begin() + v * 640, 640, image.pixels.begin() + (v + 300) * 1280 + 400);
  }
  RejectionCounts rejected;
  const auto found = FindCircleGrid(image, view.board, &rejected);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->num_corners(), 28);
  const Eigen::Matrix2Xd truth =
      DrawnCentres(view.board, view.lens, view.T_c_g).colwise() + Eigen::Vector2d(400.0, 300.0);
  EXPECT_LT(WorstError(*found, truth), 0.05);
}

}  // namespace
}  // namespace calibrato
