#include "calibrato/detection/detect.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "calibrato/base/input_error.h"
#include "calibrato/base/parallel.h"
#include "calibrato/detection/draw_checkerboard.h"

namespace calibrato {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr Resolution kResolution{320, 240};
const Checkerboard kBoard{6, 7, 0.06, 0.06};

Eigen::Matrix3d View(double tilt, double roll, const Checkerboard& board = kBoard) {
  return BoardHomography(board, 300.0, {160.3, 118.6}, 0.85, tilt, roll);
}

GreyImage Grey(Resolution resolution) {
  return {resolution,
          std::vector<uint8_t>(static_cast<size_t>(resolution.width) * resolution.height, 128)};
}

double MeanError(const BoardView& view, const Eigen::Matrix2Xd& truth) {
  return (view.pixels - truth(Eigen::all, view.corner_ids)).colwise().norm().mean();
}

ImageSource Source(const std::vector<GreyImage>& images) {
  ImageSource source;
  for (size_t k = 0; k < images.size(); ++k) source.names.push_back(std::to_string(k) + ".png");
  source.load = [&images](size_t k) { return images[k]; };
  return source;
}

template <typename Function>
std::string MessageOf(const Function& function) {
  try {
    function();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(DetectBoard, FindsCornersToATwentiethOfAPixel) {
  for (const double tilt : {0.0, 40.0 * kDegree, -35.0 * kDegree}) {
    const Eigen::Matrix3d H_c_g =
        BoardHomography(kBoard, 600.0, {320.3, 237.6}, 0.85, tilt, 5.0 * kDegree);
    const std::optional<BoardView> view =
        DetectBoard(DrawCheckerboard(kBoard, H_c_g, {640, 480}), kBoard);
    ASSERT_TRUE(view) << tilt;
    EXPECT_LT(MeanError(*view, DrawnCorners(kBoard, H_c_g)), 0.05) << tilt;
    EXPECT_EQ(view->points_g, BoardPoints(kBoard));
    ASSERT_EQ(view->corner_ids.size(), 42u);
    EXPECT_EQ(view->corner_ids[41], 41);
  }
}

TEST(DetectBoard, RefinesInVeryLargeImagesOnTheImageItself) {
  const Eigen::Matrix3d H_c_g =
      BoardHomography(kBoard, 2000.0, {1210.0, 420.0}, 1.9, 0.3, 10.0 * kDegree);
  const std::optional<BoardView> view =
      DetectBoard(DrawCheckerboard(kBoard, H_c_g, {2400, 800}), kBoard);
  ASSERT_TRUE(view);
  EXPECT_LT(MeanError(*view, DrawnCorners(kBoard, H_c_g)), 0.05);
}

TEST(DetectBoard, KeepsItsCornersThroughAFullTurn) {
  for (int degrees = 0; degrees < 360; degrees += 30) {
    const Eigen::Matrix3d H_c_g = View(20.0 * kDegree, degrees * kDegree);
    const std::optional<BoardView> view =
        DetectBoard(DrawCheckerboard(kBoard, H_c_g, kResolution), kBoard);
    ASSERT_TRUE(view) << degrees;
    // A turn of the numbers by half a turn would be an error of many pixels, and so would a mirror.
    EXPECT_LT(MeanError(*view, DrawnCorners(kBoard, H_c_g)), 0.1) << degrees;
  }
}

TEST(DetectBoard, PointsItsZAxisTowardsTheCamera) {
  for (const Checkerboard& board : {Checkerboard{5, 7, 0.05, 0.05}, Checkerboard{5, 5, 0.05, 0.05},
                                    Checkerboard{7, 4, 0.05, 0.05}}) {
    for (const int degrees : {0, 75, 165, 255}) {
      const GreyImage image =
          DrawCheckerboard(board, View(0.2, degrees * kDegree, board), kResolution);
      const std::optional<BoardView> view = DetectBoard(image, board);
      ASSERT_TRUE(view) << Describe(board) << degrees;
      const Eigen::Vector2d x = view->pixels.col(board.columns) - view->pixels.col(0);
      const Eigen::Vector2d y = view->pixels.col(1) - view->pixels.col(0);
      // In camera axes (x right, y down, z forward) x cross y must point back to the camera.
      EXPECT_LT(x.x() * y.y() - x.y() * y.x(), 0.0) << Describe(board) << degrees;
    }
  }
}

TEST(DetectBoard, TakesRowsAndColumnsSwappedForTheSameBoard) {
  const Checkerboard swapped{7, 6, 0.06, 0.06};
  const Eigen::Matrix3d H_c_g = View(0.2, 0.1);
  const std::optional<BoardView> view =
      DetectBoard(DrawCheckerboard(kBoard, H_c_g, kResolution), swapped);
  ASSERT_TRUE(view);
  const Eigen::Matrix2Xd truth = DrawnCorners(kBoard, H_c_g);
  for (Eigen::Index k = 0; k < view->num_corners(); ++k) {
    EXPECT_LT((truth.colwise() - view->pixels.col(k)).colwise().norm().minCoeff(), 0.2);
  }
}

TEST(DetectBoard, FindsNothingWhereThereIsNoBoard) {
  for (const Board& board :
       {Board(kBoard), Board(AprilGrid{6, 6, 0.088, 0.3}), Board(CircleGrid{6, 7, 0.06, false}),
        Board(Charuco{6, 8, 0.06, 0.045, "DICT_5X5_100"})}) {
    for (const Resolution size : {kResolution, Resolution{4, 3}, Resolution{1, 1},
                                  Resolution{1, 500}, Resolution{20'000, 60}}) {
      EXPECT_FALSE(DetectBoard(Grey(size), board)) << size.width;
    }
  }
}

TEST(DetectBoard, LeavesOutAndCountsCornersNearTheBorder) {
  const Eigen::Matrix3d H_c_g = View(0.0, 0.0);
  const double leftmost = DrawnCorners(kBoard, H_c_g).row(0).minCoeff();
  const auto search_with_leftmost_at = [&](double u) {
    Eigen::Matrix3d shift = Eigen::Matrix3d::Identity();
    shift(0, 2) = u - leftmost;
    return SearchForBoard(DrawCheckerboard(kBoard, shift * H_c_g, kResolution), kBoard);
  };
  const BoardSearch inside = search_with_leftmost_at(12.0);
  ASSERT_TRUE(inside.view);
  EXPECT_EQ(inside.view->num_corners(), 42);
  EXPECT_EQ(inside.rejected, RejectionCounts());
  // The leftmost column of corners, one of each row.
  const BoardSearch near = search_with_leftmost_at(5.0);
  ASSERT_TRUE(near.view);
  EXPECT_EQ(near.view->num_corners(), 36);
  EXPECT_EQ(near.rejected.corners_near_border, 6);
  EXPECT_FALSE(search_with_leftmost_at(0.5).view);
}

TEST(DetectBoard, RefusesABoardThatNoFinderCanTellFromItsBackground) {
  EXPECT_THAT(MessageOf([] {
                static_cast<void>(DetectBoard(Grey(kResolution), Checkerboard{2, 7, 0.06, 0.06}));
              }),
              AllOf(HasSubstr("2 rows x 7 columns"), HasSubstr("at least 3 rows")));
}

TEST(DetectBoards, KeepsTheOrderOfTheImagesAndListsThoseWithoutABoard) {
  const std::vector<GreyImage> images = {DrawCheckerboard(kBoard, View(0.2, 0.0), kResolution),
                                         Grey({100, 100}),
                                         DrawCheckerboard(kBoard, View(-0.2, 0.5), kResolution)};
  ImageSource source = Source(images);
  for (const int64_t stamp : {10, 20, 30}) {
    source.stamps.push_back(Time::FromNanoseconds(stamp));
  }
  const Detections detections = DetectBoards(source, kBoard);
  EXPECT_EQ(detections.num_images, 3);
  EXPECT_EQ(detections.resolution, kResolution);
  EXPECT_THAT(detections.images_without_board, ElementsAre("1.png"));
  ASSERT_EQ(detections.views.size(), 2u);
  EXPECT_EQ(detections.views[0].name, "0.png");
  EXPECT_EQ(detections.views[1].name, "2.png");
  EXPECT_EQ(detections.views[1].stamp, Time::FromNanoseconds(30));
  EXPECT_LT(MeanError(detections.views[1], DrawnCorners(kBoard, View(-0.2, 0.5))), 0.1);
}

TEST(DetectBoards, GivesTheSameBytesForAnyNumberOfThreads) {
  std::vector<GreyImage> images;
  for (int k = 0; k < 6; ++k) {
    images.push_back(DrawCheckerboard(kBoard, View(0.1 * k - 0.3, 0.2 * k), kResolution));
  }
  SetNumThreads(1);
  const Detections serial = DetectBoards(Source(images), kBoard);
  SetNumThreads(2);
  const Detections parallel = DetectBoards(Source(images), kBoard);
  SetNumThreads(0);
  ASSERT_EQ(serial.views.size(), 6u);
  ASSERT_EQ(parallel.views.size(), 6u);
  for (size_t k = 0; k < 6; ++k) {
    EXPECT_EQ(serial.views[k].pixels, parallel.views[k].pixels);
    EXPECT_EQ(serial.views[k].name, parallel.views[k].name);
  }
}

TEST(DetectBoards, NamesOneImageOfEachSizeWhereThereAreTwo) {
  const std::vector<GreyImage> images = {DrawCheckerboard(kBoard, View(0.2, 0.0), kResolution),
                                         Grey({64, 64}),
                                         DrawCheckerboard(kBoard, View(0.2, 0.0), {330, 250})};
  EXPECT_THAT(MessageOf([&] { static_cast<void>(DetectBoards(Source(images), kBoard)); }),
              AllOf(HasSubstr("0.png"), HasSubstr("320 x 240"), HasSubstr("2.png"),
                    HasSubstr("330 x 250"), Not(HasSubstr("1.png"))));
}

TEST(DetectBoards, SaysWhatWasSearchedForWhereThereIsNoBoardAtAll) {
  const std::vector<GreyImage> images = {Grey(kResolution), Grey(kResolution)};
  EXPECT_THAT(MessageOf([&] { static_cast<void>(DetectBoards(Source(images), kBoard)); }),
              AllOf(HasSubstr("searched 2 images"), HasSubstr("6 rows x 7 columns"),
                    HasSubstr("--target"), Not(HasSubstr("was found"))));
  EXPECT_THAT(MessageOf([] { static_cast<void>(DetectBoards(ImageSource{}, kBoard)); }),
              HasSubstr("there are no images"));
}

TEST(DetectBoards, SuggestsTheBoardThatIsThere) {
  const std::vector<GreyImage> images = {Grey(kResolution),
                                         DrawCheckerboard(kBoard, View(0.2, 0.0), kResolution)};
  const auto message = [&](int rows, int columns) {
    return MessageOf([&] {
      static_cast<void>(DetectBoards(Source(images), Checkerboard{rows, columns, 0.06, 0.06}));
    });
  };
  // Squares counted instead of inner corners, also with rows and columns swapped; one too many.
  EXPECT_THAT(message(7, 8), HasSubstr("targetRows: 6 and targetCols: 7"));
  EXPECT_THAT(message(8, 7), HasSubstr("targetRows: 7 and targetCols: 6"));
  EXPECT_THAT(message(6, 8), HasSubstr("targetRows: 6 and targetCols: 7"));
}

TEST(DetectBoards, PassesOnTheErrorOfTheFirstImageThatCannotBeLoaded) {
  const std::vector<GreyImage> images(3, Grey({64, 64}));
  ImageSource source = Source(images);
  source.load = [&](size_t k) -> GreyImage {
    if (k > 0) throw InputError({"cannot read image", source.names[k], "it is torn", ""});
    return images[k];
  };
  EXPECT_THAT(MessageOf([&] { static_cast<void>(DetectBoards(source, kBoard)); }),
              HasSubstr("1.png"));
}

}  // namespace
}  // namespace calibrato
