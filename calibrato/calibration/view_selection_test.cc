#include "calibrato/calibration/view_selection.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <numeric>

#include "calibrato/calibration/camera_calibration.h"
#include "calibrato/calibration/synthetic_views_for_test.h"

namespace calibrato {
namespace {

constexpr Resolution kImage{640, 480};
const Board kBoard = Checkerboard{6, 7, 0.055, 0.055};

CameraModel Lens() {
  Eigen::VectorXd parameters(8);
  parameters << 585.0, 590.0, 322.0, 236.0, -0.2, 0.05, 0.0, 0.0;
  return {"pinhole-radtan", parameters};
}

std::vector<BoardView> Views(int num_views, uint64_t seed) {
  Rng rng(seed);
  return SyntheticViews(Lens(), kImage, kBoard, num_views, 0.1, rng);
}

// A video in which the board moves by `pixels` from one image to the next, 0.1 s later.
std::vector<BoardView> Video(const BoardView& first, int num_views, double pixels) {
  std::vector<BoardView> views;
  for (int v = 0; v < num_views; ++v) {
    BoardView view = first;
    view.stamp = Time::FromNanoseconds(1 + 100'000'000LL * v);
    view.pixels.row(0).array() += pixels * v;
    views.push_back(view);
  }
  return views;
}

TEST(SelectByCoverage, KeepsOneOfViewsThatAreAlike) {
  const std::vector<BoardView> different = Views(8, 1);
  const std::vector<size_t> once = SelectByCoverage(different, kImage);
  std::vector<BoardView> repeated = different;
  repeated.insert(repeated.end(), different.begin(), different.end());
  EXPECT_EQ(SelectByCoverage(repeated, kImage), once);
  EXPECT_GE(once.size(), 3U);
}

TEST(SelectByCoverage, TakesTheNextViewOnceTheBoardHasMovedFarEnough) {
  // The board moves in X only: 8 px of (W - s) a view, so that a sum of 0.15 is passed at view n.
  const BoardView first = Views(1, 2)[0];
  const std::vector<BoardView> video = Video(first, 20, 8.0);
  const double step = ViewParametersOf(video[1], kImage).x - ViewParametersOf(video[0], kImage).x;
  const auto n = static_cast<size_t>(std::ceil(0.15 / step));
  const std::vector<size_t> kept = SelectByCoverage(video, kImage);
  ASSERT_GE(kept.size(), 2U);
  EXPECT_EQ(kept[0], 0U);
  EXPECT_EQ(kept[1], n);
}

TEST(SelectByCoverage, LeavesOutViewsInWhichTheBoardMovesFast) {
  // 0.3 widths a second are 192 px/s: 19.2 px from one image to the next.
  const BoardView first = Views(1, 2)[0];
  EXPECT_GT(SelectByCoverage(Video(first, 8, 19.0), kImage).size(), 1U);
  EXPECT_EQ(SelectByCoverage(Video(first, 8, 19.4), kImage), std::vector<size_t>{0});
}

TEST(SelectDistinct, KeepsTheFirstOfViewsThatAreAlikeHoweverFarApart) {
  const std::vector<BoardView> different = Views(8, 1);
  std::vector<BoardView> views = different;
  views.insert(views.end(), different.begin(), different.end());
  std::vector<size_t> first(different.size());
  std::iota(first.begin(), first.end(), 0);
  EXPECT_EQ(SelectDistinct(views), first);
}

TEST(SelectDistinct, CountsTheWayFromTheLastViewThatWasKept) {
  // A slow drift of 0.11 px a view is distinct at every third.
  EXPECT_EQ(SelectDistinct(Video(Views(1, 2)[0], 8, 0.11)), (std::vector<size_t>{0, 3, 6}));
}

TEST(SelectDistinct, KeepsViewsOfDifferentParts) {
  const BoardView whole = Views(1, 2)[0];
  const auto part = [&](int first, int count) {
    BoardView view = whole;
    view.corner_ids.assign(whole.corner_ids.begin() + first,
                           whole.corner_ids.begin() + first + count);
    view.pixels = whole.pixels.middleCols(first, count);
    view.points_g = whole.points_g.middleCols(first, count);
    return view;
  };
  EXPECT_EQ(SelectDistinct({part(0, 10), part(10, 10), part(5, 10)}), (std::vector<size_t>{0, 1}));
}

TEST(BoardSpeeds, IsTheMeanWayOfSharedCornersOverTime) {
  std::vector<BoardView> video = Video(Views(1, 3)[0], 3, 5.0);
  // The last view holds only every second corner, which moved by 12 px more.
  BoardView& last = video[2];
  std::vector<Eigen::Index> half;
  std::vector<int> ids;
  for (Eigen::Index k = 1; k < last.num_corners(); k += 2) half.push_back(k);
  for (const Eigen::Index k : half) ids.push_back(last.corner_ids[static_cast<size_t>(k)]);
  last.corner_ids = ids;
  last.pixels = Eigen::Matrix2Xd(last.pixels(Eigen::all, half));
  last.pixels.row(1).array() += 12.0;
  const auto speeds = BoardSpeeds(video);
  EXPECT_FALSE(speeds[0]);
  EXPECT_NEAR(*speeds[1], 50.0, 1e-9);
  EXPECT_NEAR(*speeds[2], 130.0, 1e-9);  // 5, 12 and 13 px.
}

TEST(BoardSpeeds, AreUnknownWithoutStamps) {
  for (const auto& speed : BoardSpeeds(Views(4, 4))) EXPECT_FALSE(speed);
}

TEST(SelectByInformation, KeepsWhatTheInverseSaysIsBest) {
  // One unknown: information adds, the trace is its inverse. 8, then 4, then 1: 1/8, 1/12, 1/13.
  const auto scalar = [](double x) { return Eigen::MatrixXd::Constant(1, 1, x); };
  const std::vector<Eigen::MatrixXd> information = {scalar(1.0), scalar(8.0), scalar(4.0)};
  const InformationSelection selection =
      SelectByInformation(information, {0}, {.least_gain = 0.2, .min_views = 1});
  EXPECT_EQ(selection.kept, (std::vector<size_t>{1, 2}));
  EXPECT_NEAR(selection.a_optimality_kept, 1.0 / 12.0, 1e-12);
  EXPECT_NEAR(selection.a_optimality_all, 1.0 / 13.0, 1e-12);
  EXPECT_EQ(selection.num_enough, 3U);  // 1 + 8 is less than 12.
}

TEST(SelectByInformation, StopsWhereTheRecordingRepeatsItself) {
  // Ten views from everywhere, then two hundred times nearly the last of them.
  std::vector<BoardView> views = Views(10, 5);
  CameraProblem problem;
  problem.resolution = kImage;
  problem.views = views;
  Rng rng(6);
  for (int v = 0; v < 200; ++v) {
    BoardView view = views.back();
    for (double& x : view.pixels.reshaped()) x += 0.1 * rng.Normal();
    problem.views.push_back(view);
  }
  problem.reject_outliers = false;
  const auto information = InformationOfViews(CalibrateCamera(problem), {});
  const InformationSelection selection = SelectByInformation(information, {0, 1, 2, 3});
  EXPECT_LT(selection.kept.size(), 40U);
  EXPECT_LT(selection.num_enough, 60U);
  // The different ones are all there.
  for (size_t v = 0; v < 9; ++v) EXPECT_EQ(selection.kept[v], v);
  // What 180 more images of one pose add is less than a quarter of sigma.
  EXPECT_LT(selection.a_optimality_kept, 1.5 * selection.a_optimality_all);
}

TEST(SelectByInformation, KnowsMoreThanAsManyViewsAtRandom) {
  CameraProblem problem;
  problem.resolution = kImage;
  problem.views = Views(100, 7);
  const auto information = InformationOfViews(CalibrateCamera(problem), {});
  const InformationSelection selection = SelectByInformation(information, {0, 1, 2, 3});
  ASSERT_GT(selection.kept.size(), 5U);
  ASSERT_LT(selection.kept.size(), 100U);
  Eigen::MatrixXd first = Eigen::MatrixXd::Zero(8, 8);
  for (size_t v = 0; v < selection.kept.size(); ++v) first += information[v];
  const double trace = first.inverse().diagonal().head<4>().sum();
  EXPECT_LT(selection.a_optimality_kept, 0.8 * trace);
  // The criterion is what CalibrateCamera states of all views.
  EXPECT_NEAR(selection.a_optimality_all / CalibrateCamera(problem).information.a_optimality, 1.0,
              1e-6);
}

TEST(SelectByInformation, HeldParametersCountAsKnown) {
  CameraProblem problem;
  problem.resolution = kImage;
  problem.views = Views(20, 8);
  HoldParameters({"pu"}, &problem);
  const auto information = InformationOfViews(CalibrateCamera(problem), problem.fixed);
  const InformationSelection selection = SelectByInformation(information, {0, 1, 2, 3});
  EXPECT_GT(selection.a_optimality_all, 0.0);
  EXPECT_TRUE(std::isfinite(selection.a_optimality_all));
  EXPECT_GE(selection.kept.size(), 3U);
}

TEST(SelectByInformation, KeepsNothingWhereAllViewsTogetherLeaveARankOpen) {
  Eigen::Matrix2d one;
  one << 1.0, 1.0, 1.0, 1.0;
  EXPECT_TRUE(SelectByInformation({one, one, one}, {0, 1}).kept.empty());
}

TEST(TimeOfFirst, IsFromTheFirstStampToTheLast) {
  const std::vector<BoardView> video = Video(Views(1, 9)[0], 20, 1.0);
  EXPECT_EQ(*TimeOfFirst(11, video), Duration::FromSeconds(1.0));
  EXPECT_FALSE(TimeOfFirst(1, video));
  EXPECT_FALSE(TimeOfFirst(2, Views(2, 9)));
}

}  // namespace
}  // namespace calibrato
