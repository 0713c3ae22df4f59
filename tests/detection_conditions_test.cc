// What a detector meets besides one good board: mirrors, two boards, boards of another kind, parts
// of boards, and boards that are rolled.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <string>

#include "calibrato/base/input_error.h"
#include "calibrato/detection/detect.h"
#include "rendered_boards.h"

namespace calibrato {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

const AprilGrid kAprilGrid{4, 5, 0.088, 0.3};
const Charuco kCharuco{6, 8, 0.06, 0.045, "DICT_5X5_100"};

Rigid3 Upright(const Board& board, double distance_m = 0.9,
               const Eigen::Vector2d& pixel = {320.0, 240.0}) {
  BoardPlace place;
  place.pixel = pixel;
  place.distance_m = distance_m;
  place.tilt = 0.3;
  place.roll = 0.1;
  return PoseOf(board, CameraForTest("pinhole-radtan"), place);
}

GreyImage ImageOf(const Board& board) {
  return ImageOf(board, CameraForTest("pinhole-radtan"), Upright(board));
}

GreyImage Mirrored(GreyImage image) {
  const auto width = static_cast<std::ptrdiff_t>(image.resolution.width);
  for (auto row = image.pixels.begin(); row != image.pixels.end(); row += width) {
    std::reverse(row, row + width);
  }
  return image;
}

// The left half of one image, the right half of another.
GreyImage SideBySide(const GreyImage& left, const GreyImage& right) {
  GreyImage both = left;
  const auto width = static_cast<size_t>(left.resolution.width);
  for (size_t k = 0; k < both.pixels.size(); ++k) {
    if (k % width >= width / 2) both.pixels[k] = right.pixels[k];
  }
  return both;
}

std::string MessageFor(const GreyImage& image, const Board& board) {
  ImageSource source;
  source.names = {"0.png"};
  source.load = [&](size_t) { return image; };
  try {
    static_cast<void>(DetectBoards(source, board));
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(DetectionConditions, FindsWholeBoardsOfEachKindWhole) {
  for (const Board& board :
       {Board(Checkerboard{6, 7, 0.06, 0.06}), Board(kAprilGrid), Board(kCharuco),
        Board(CircleGrid{11, 4, 0.03, true}), Board(CircleGrid{6, 7, 0.06, false})}) {
    const BoardSearch search = SearchForBoard(ImageOf(board), board);
    ASSERT_TRUE(search.view) << Describe(board);
    EXPECT_EQ(search.view->num_corners(), BoardPoints(board).cols()) << Describe(board);
    EXPECT_EQ(search.rejected, RejectionCounts()) << Describe(board);
  }
}

TEST(DetectionConditions, RefusesMirroredBoardsInClearWords) {
  for (const Board& board : {Board(kAprilGrid), Board(kCharuco)}) {
    const GreyImage image = Mirrored(ImageOf(board));
    const BoardSearch search = SearchForBoard(image, board);
    EXPECT_FALSE(search.view) << Describe(board);
    EXPECT_EQ(search.rejected.images_with_mirrored_board, 1) << Describe(board);
    EXPECT_THAT(MessageFor(image, board), AllOf(HasSubstr("0.png"), HasSubstr("mirror")));
  }
}

TEST(DetectionConditions, RefusesAMirroredCircleGridWhereItCanBeTold) {
  // With an even number of rows; with an odd one it is its own mirror image.
  const Board board = CircleGrid{10, 4, 0.03, true};
  EXPECT_TRUE(DetectBoard(ImageOf(board), board));
  EXPECT_EQ(SearchForBoard(Mirrored(ImageOf(board)), board).rejected.images_with_mirrored_board, 1);
}

TEST(DetectionConditions, TakesNeitherOfTwoBoardsInView) {
  const Camera camera = CameraForTest("pinhole-radtan");
  for (const Board& board :
       {Board(Checkerboard{6, 7, 0.06, 0.06}), Board(AprilGrid{3, 3, 0.088, 0.3}),
        Board(Charuco{5, 6, 0.06, 0.045, "DICT_4X4_50"}), Board(CircleGrid{7, 4, 0.03, true})}) {
    const double size =
        (BoardPoints(board).rowwise().maxCoeff() - BoardPoints(board).rowwise().minCoeff()).norm();
    const GreyImage image =
        SideBySide(ImageOf(board, camera, Upright(board, 2.6 * size, {160.0, 240.0})),
                   ImageOf(board, camera, Upright(board, 2.6 * size, {480.0, 230.0})));
    const BoardSearch search = SearchForBoard(image, board);
    EXPECT_FALSE(search.view) << Describe(board);
    EXPECT_EQ(search.rejected.images_with_two_boards, 1) << Describe(board);
    EXPECT_THAT(MessageFor(image, board), HasSubstr("two boards")) << Describe(board);
  }
}

TEST(DetectionConditions, CountsTagsThatAreNotOnTheBoard) {
  const AprilGrid smaller{4, 3, 0.088, 0.3};
  EXPECT_GT(SearchForBoard(ImageOf(kAprilGrid), smaller).rejected.tags_not_on_board, 0);
  const Charuco fewer{4, 5, 0.06, 0.045, "DICT_5X5_100"};
  EXPECT_GT(SearchForBoard(ImageOf(kCharuco), fewer).rejected.tags_not_on_board, 0);
}

TEST(DetectionConditions, CountsMarkersOfAnotherDictionary) {
  Charuco other = kCharuco;
  other.dictionary = "DICT_6X6_250";
  const BoardSearch search = SearchForBoard(ImageOf(kCharuco), other);
  EXPECT_FALSE(search.view);
  EXPECT_GT(search.rejected.tags_of_another_family, 5);
  EXPECT_THAT(MessageFor(ImageOf(kCharuco), other), HasSubstr("another family"));
}

TEST(DetectionConditions, NoticesRowsAndColumnsSwapped) {
  const AprilGrid swapped{5, 4, 0.088, 0.3};
  EXPECT_EQ(SearchForBoard(ImageOf(kAprilGrid), swapped).rejected.images_with_other_layout, 1);
  // Two rows too few in the target: the numbers of those that it has are right nevertheless.
  Charuco shorter = kCharuco;
  shorter.rows = 4;
  const BoardSearch search = SearchForBoard(ImageOf(kCharuco), shorter);
  EXPECT_FALSE(search.view.has_value());
  EXPECT_EQ(search.rejected.images_with_other_layout, 1);
  EXPECT_THAT(MessageFor(ImageOf(kAprilGrid), swapped), HasSubstr("tagRows: 4 and tagCols: 5"));
  const Board circles = CircleGrid{11, 4, 0.03, true};
  EXPECT_THAT(MessageFor(ImageOf(circles), CircleGrid{4, 11, 0.03, true}),
              HasSubstr("targetRows: 11 and targetCols: 4"));
}

TEST(DetectionConditions, FindsThePartsOfBoardsThatTellWhichPartTheyAre) {
  const Camera camera = CameraForTest("pinhole-radtan");
  for (const Board& board : {Board(kAprilGrid), Board(kCharuco)}) {
    BoardPlace place;
    place.distance_m = 0.6;
    place.pixel = {560.0, 400.0};  // the middle of the board; more than half is out of the image
    const Rigid3 T_c_g = PoseOf(board, camera, place);
    const std::optional<BoardView> view = DetectBoard(ImageOf(board, camera, T_c_g), board);
    ASSERT_TRUE(view) << Describe(board);
    EXPECT_GE(view->num_corners(), 8);
    EXPECT_LT(view->num_corners(), BoardPoints(board).cols());
    const Eigen::Matrix2Xd truth = TruthOf(board, camera, T_c_g);
    EXPECT_LT((view->pixels - truth(Eigen::all, view->corner_ids)).colwise().norm().maxCoeff(),
              0.1);
    EXPECT_EQ(view->points_g, BoardPoints(board)(Eigen::all, view->corner_ids));
  }
}

TEST(DetectionConditions, KeepTheNumbersOfASymmetricBoardThroughAFullRoll) {
  const Camera camera = CameraForTest("pinhole-radtan");
  for (const Board& board :
       {Board(Checkerboard{6, 8, 0.05, 0.05}), Board(CircleGrid{5, 5, 0.06, false})}) {
    std::vector<Rigid3> poses;
    ImageSource source;
    for (int k = 0; k <= 24; ++k) {
      BoardPlace place;
      place.distance_m = 0.9;
      place.tilt = 0.2;
      place.roll = k * std::numbers::pi / 12.0;
      poses.push_back(PoseOf(board, camera, place));
      source.names.push_back(std::to_string(k) + ".png");
      source.stamps.push_back(Time::FromNanoseconds(100'000'000 * int64_t{k}));
    }
    source.load = [&](size_t k) { return ImageOf(board, camera, poses[k]); };
    const Detections detections = DetectBoards(source, board);
    ASSERT_EQ(detections.views.size(), poses.size());
    EXPECT_TRUE(detections.is_numbered_by_continuity);
    // The first view's numbers are one of those that look alike; the same one must stay.
    const auto truth_now = [&](size_t k) { return TruthOf(board, camera, poses[k]); };
    const Eigen::Vector2d first = detections.views[0].pixels.col(0);
    Eigen::Index number = 0;
    (truth_now(0).colwise() - first).colwise().norm().minCoeff(&number);
    for (size_t k = 0; k < poses.size(); ++k) {
      EXPECT_LT((truth_now(k).col(number) - detections.views[k].pixels.col(0)).norm(), 0.1) << k;
    }
  }
}

}  // namespace
}  // namespace calibrato
