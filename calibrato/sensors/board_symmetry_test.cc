#include "calibrato/sensors/board_symmetry.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace calibrato {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

BoardView ViewOf(const Board& board, double roll) {
  BoardView view;
  view.points_g = BoardPoints(board);
  view.pixels.resize(2, view.points_g.cols());
  for (Eigen::Index k = 0; k < view.points_g.cols(); ++k) {
    view.corner_ids.push_back(static_cast<int>(k));
    const Eigen::Vector2d x = 1000.0 * (view.points_g.col(k) - BoardCentre(board)).head<2>();
    view.pixels.col(k) << 300.0 + std::cos(roll) * x.y() - std::sin(roll) * x.x(),
        200.0 + std::sin(roll) * x.y() + std::cos(roll) * x.x();
  }
  return view;
}

TEST(BoardSymmetry, IsThatOfTheSquaresColours) {
  EXPECT_THAT(OtherNumberings(Checkerboard{6, 7, 0.1, 0.1}), IsEmpty());
  EXPECT_THAT(OtherNumberings(Checkerboard{6, 8, 0.1, 0.1}), SizeIs(1));
  EXPECT_THAT(OtherNumberings(Checkerboard{5, 5, 0.1, 0.1}), SizeIs(1));
  EXPECT_THAT(OtherNumberings(Checkerboard{6, 6, 0.1, 0.1}), SizeIs(3));
}

TEST(BoardSymmetry, OfCircleGridsFollowsFromTheirRows) {
  EXPECT_THAT(OtherNumberings(CircleGrid{5, 6, 0.1, false}), SizeIs(1));
  EXPECT_THAT(OtherNumberings(CircleGrid{5, 5, 0.1, false}), SizeIs(3));
  EXPECT_THAT(OtherNumberings(CircleGrid{11, 4, 0.1, true}), IsEmpty());
  EXPECT_THAT(OtherNumberings(CircleGrid{10, 4, 0.1, true}), SizeIs(1));
}

TEST(BoardSymmetry, TheAdviceIsABoardWithoutTurns) {
  EXPECT_EQ(SidedBoardAdvice(Checkerboard{6, 8, 0.1, 0.1}),
            "use a checkerboard with an odd sum of rows and columns");
  for (const CircleGrid& board : {CircleGrid{5, 6, 0.1, false}, CircleGrid{10, 4, 0.1, true}}) {
    const std::string advice = SidedBoardAdvice(board);
    EXPECT_NE(advice.find("asymmetric circle grid with an odd number of rows"), std::string::npos);
  }
  EXPECT_EQ(SidedBoardAdvice(AprilGrid{6, 6, 0.1, 0.3}), "");
}

TEST(BoardSymmetry, NumberingsPutTheBoardsPointsWhereItsPointsAre) {
  // A turn of the board onto itself: distances between points of two numbers stay.
  for (const Board& board :
       {Board(Checkerboard{6, 6, 0.1, 0.1}), Board(Checkerboard{4, 6, 0.1, 0.2}),
        Board(CircleGrid{10, 4, 0.1, true}), Board(CircleGrid{5, 5, 0.1, false})}) {
    const Eigen::Matrix3Xd points = BoardPoints(board);
    for (const std::vector<int>& numbering : OtherNumberings(board)) {
      const Eigen::Matrix3Xd turned = points(Eigen::all, numbering);
      for (Eigen::Index k = 1; k < points.cols(); ++k) {
        EXPECT_NEAR((turned.col(k) - turned.col(0)).norm(), (points.col(k) - points.col(0)).norm(),
                    1e-12);
      }
      // No mirror image: the same way round.
      const auto cross = [](const Eigen::Matrix3Xd& p) {
        return (p.col(1) - p.col(0)).cross(p.col(p.cols() - 1) - p.col(0)).z();
      };
      EXPECT_NEAR(cross(turned), cross(points), 1e-12);
    }
  }
}

TEST(BoardSymmetry, TurnsMoveThePointsAsTheirNumbersDo) {
  for (const Board& board :
       {Board(Checkerboard{6, 6, 0.1, 0.1}), Board(Checkerboard{4, 6, 0.1, 0.2}),
        Board(CircleGrid{10, 4, 0.1, true}), Board(CircleGrid{5, 5, 0.1, false})}) {
    const Eigen::Matrix3Xd points_g = BoardPoints(board);
    const std::vector<BoardTurn> turns = BoardTurns(board);
    ASSERT_THAT(turns, SizeIs(OtherNumberings(board).size()));
    for (const BoardTurn& turn : turns) {
      for (Eigen::Index k = 0; k < points_g.cols(); ++k) {
        const int other = turn.numbering[static_cast<size_t>(k)];
        EXPECT_LT((turn.T_g_turned * points_g.col(k) - points_g.col(other)).norm(), 1e-12);
      }
    }
  }
}

TEST(BoardSymmetry, ARenumberedViewShowsTheBoardTurned) {
  const Board board = Checkerboard{6, 6, 0.1, 0.1};
  const Eigen::Matrix3Xd points_g = BoardPoints(board);
  BoardView view = ViewOf(board, 0.4);
  // Without two corners, so that columns and numbers differ.
  std::vector<int> kept = view.corner_ids;
  kept.erase(kept.begin() + 7);
  kept.erase(kept.begin());
  view.corner_ids = kept;
  view.pixels = view.pixels(Eigen::all, kept).eval();
  view.points_g = view.points_g(Eigen::all, kept).eval();
  for (const BoardTurn& turn : BoardTurns(board)) {
    const BoardView numbered = Renumbered(view, turn.numbering, points_g);
    EXPECT_TRUE(std::is_sorted(numbered.corner_ids.begin(), numbered.corner_ids.end()));
    const std::vector<int> columns = ColumnsInOrder(view, turn.numbering);
    ASSERT_THAT(columns, SizeIs(kept.size()));
    for (size_t k = 0; k < columns.size(); ++k) {
      const auto now = static_cast<Eigen::Index>(k);
      EXPECT_EQ(numbered.pixels.col(now), view.pixels.col(columns[k]));
      EXPECT_EQ(numbered.points_g.col(now), points_g.col(numbered.corner_ids[k]));
      EXPECT_LT(
          (turn.T_g_turned * numbered.points_g.col(now) - view.points_g.col(columns[k])).norm(),
          1e-12);
    }
  }
}

TEST(BoardSymmetry, KeepsTheNumbersOfABoardThatIsRolled) {
  const Board board = Checkerboard{6, 6, 0.1, 0.1};
  const Eigen::Matrix3Xd points_g = BoardPoints(board);
  const std::vector<std::vector<int>> numberings = OtherNumberings(board);
  const BoardView before = ViewOf(board, 0.1);
  const BoardView truth = ViewOf(board, 0.4);
  for (const std::vector<int>& numbering : numberings) {
    BoardView view = truth;
    for (size_t k = 0; k < numbering.size(); ++k) {
      view.pixels.col(static_cast<Eigen::Index>(k)) = truth.pixels.col(numbering[k]);
    }
    EXPECT_EQ(NumberedAsBefore(view, before, numberings, points_g).pixels, truth.pixels);
  }
}

TEST(BoardSymmetry, RenumbersPartsOfABoardToo) {
  const Board board = Checkerboard{3, 5, 0.1, 0.1};
  const std::vector<std::vector<int>> numberings = OtherNumberings(board);
  BoardView view = ViewOf(board, 3.2);
  view.corner_ids = {0, 1, 5};
  view.pixels = view.pixels(Eigen::all, view.corner_ids).eval();
  view.points_g = view.points_g(Eigen::all, view.corner_ids).eval();
  const BoardView numbered =
      NumberedAsBefore(view, ViewOf(board, 0.0), numberings, BoardPoints(board));
  EXPECT_THAT(numbered.corner_ids, ElementsAre(9, 13, 14));
  EXPECT_EQ(numbered.pixels.col(2), view.pixels.col(0));
  EXPECT_EQ(numbered.points_g.col(0), BoardPoints(board).col(9));
}

}  // namespace
}  // namespace calibrato
