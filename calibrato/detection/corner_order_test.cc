#include "calibrato/detection/corner_order.h"

#include <gtest/gtest.h>

#include "calibrato/detection/draw_checkerboard.h"

namespace calibrato {
namespace {

constexpr Resolution kResolution{160, 120};

struct Picture {
  Checkerboard board;
  GreyImage image;
  Eigen::Matrix2Xd corners;
};

Picture Draw(int rows, int columns, double roll) {
  Picture picture;
  picture.board = {rows, columns, 0.05, 0.05};
  const Eigen::Matrix3d H_c_g = BoardHomography(picture.board, 150.0, {80.0, 60.0}, 0.8, 0.2, roll);
  picture.image = DrawCheckerboard(picture.board, H_c_g, kResolution);
  picture.corners = DrawnCorners(picture.board, H_c_g);
  return picture;
}

Eigen::Matrix2Xd ColumnsFlipped(const Picture& picture) {
  Eigen::Matrix2Xd flipped(2, picture.corners.cols());
  const int columns = picture.board.columns;
  for (Eigen::Index k = 0; k < flipped.cols(); ++k) {
    const Eigen::Index row = k / columns;
    flipped.col(k) = picture.corners.col(row * columns + columns - 1 - k % columns);
  }
  return flipped;
}

TEST(CornerOrder, TellsTheTwoSidesOfAnOddBoardByTheirColours) {
  for (const double roll : {0.3, 3.3}) {
    const Picture picture = Draw(4, 5, roll);
    EXPECT_EQ(OrderCorners(picture.image, picture.board, picture.corners), picture.corners);
    EXPECT_EQ(
        OrderCorners(picture.image, picture.board, picture.corners.rowwise().reverse().eval()),
        picture.corners);
  }
}

TEST(CornerOrder, UndoesAMirroredGrid) {
  const Picture picture = Draw(4, 5, 0.3);
  const Eigen::Matrix2Xd mirrored = ColumnsFlipped(picture);
  EXPECT_EQ(OrderCorners(picture.image, picture.board, mirrored), picture.corners);
  EXPECT_EQ(OrderCorners(picture.image, picture.board, mirrored.rowwise().reverse().eval()),
            picture.corners);
}

TEST(CornerOrder, BeginsAtTheTopLeftWhereColoursCannotTell) {
  // At a roll of 0.3 rad corner 0 is at the top left; half a turn later the last one is.
  const Picture upright = Draw(4, 6, 0.3);
  EXPECT_EQ(OrderCorners(upright.image, upright.board, upright.corners), upright.corners);
  const Picture turned = Draw(4, 6, 0.3 + 3.14159265);
  EXPECT_EQ(OrderCorners(turned.image, turned.board, turned.corners),
            Eigen::Matrix2Xd(turned.corners.rowwise().reverse()));
}

TEST(CornerOrder, BeginsASquareBoardOfEvenSizeAtTheTopLeftWhicheverWayItIsTurned) {
  for (int quarter = 0; quarter < 4; ++quarter) {
    const Picture picture = Draw(4, 4, 0.2 + quarter * 1.57079633);
    const std::optional<Eigen::Matrix2Xd> ordered =
        OrderCorners(picture.image, picture.board, picture.corners);
    ASSERT_TRUE(ordered);
    const Eigen::RowVectorXd distances = picture.corners.colwise().norm();
    EXPECT_EQ(ordered->col(0).norm(), distances.minCoeff());
    // x, from corner 0 to corner 4, runs down; y, from 0 to 1, to the right.
    EXPECT_GT((ordered->col(4) - ordered->col(0)).y(), 0.0);
    EXPECT_GT((ordered->col(1) - ordered->col(0)).x(), 0.0);
  }
}

TEST(CornerOrder, BeginsASquareBoardOfOddSizeAtABlackSquare) {
  // The other two corners of the board, a quarter turn away, have a white one.
  for (int quarter = 0; quarter < 4; ++quarter) {
    const Picture picture = Draw(5, 5, 0.2 + quarter * 1.57079633);
    const std::optional<Eigen::Matrix2Xd> ordered =
        OrderCorners(picture.image, picture.board, picture.corners);
    ASSERT_TRUE(ordered);
    EXPECT_TRUE(ordered->col(0) == picture.corners.col(0) ||
                ordered->col(0) == picture.corners.col(24));
  }
}

TEST(CornerOrder, RefusesCornersThatAreNotOnACheckerboard) {
  Picture picture = Draw(4, 5, 0.3);
  picture.image.pixels.assign(picture.image.pixels.size(), 128);
  EXPECT_EQ(OrderCorners(picture.image, picture.board, picture.corners), std::nullopt);

  const Picture shifted = Draw(4, 5, 0.0);
  const Eigen::Vector2d two_rows = shifted.corners.col(10) - shifted.corners.col(0);
  EXPECT_EQ(OrderCorners(shifted.image, shifted.board,
                         (shifted.corners.colwise() + 2.0 * two_rows).eval()),
            std::nullopt);
}

}  // namespace
}  // namespace calibrato
