#include "calibrato/calibration/board_shape.h"

#include <gtest/gtest.h>

#include "calibrato/base/full_sample_for_test.h"
#include "calibrato/calibration/synthetic_views_for_test.h"

namespace calibrato {
namespace {

constexpr Resolution kImage{1280, 960};
// 1 m between the outermost corners.
const Board kBoard = Checkerboard{6, 7, 1.0 / 5.0, 1.0 / 6.0};

CameraModel Lens() {
  Eigen::VectorXd parameters(8);
  parameters << 900.0, 905.0, 642.0, 476.0, -0.2, 0.05, 0.001, -0.002;
  return {"pinhole-radtan", parameters};
}

// Views of a board whose corners are where `shape` puts them, calibrated as if they were not. The
// poses are those of SyntheticViews, for a board of a third of the size at a third of the distance.
CameraCalibration CalibrateWith(const std::function<Eigen::Vector3d(Eigen::Vector3d)>& shape,
                                int num_views, Rng rng) {
  constexpr double kScale = 3.0;
  const Board small = Checkerboard{6, 7, 0.2 / kScale, 1.0 / 6.0 / kScale};
  CameraProblem problem;
  problem.resolution = kImage;
  problem.views = SyntheticViews(Lens(), kImage, small, num_views, 0.0, rng);
  const CameraCalibration exact = CalibrateCamera(problem);
  EXPECT_EQ(exact.termination, Termination::kConverged);
  const Eigen::Vector3d middle = BoardCentre(kBoard);
  for (size_t v = 0; v < problem.views.size(); ++v) {
    BoardView& view = problem.views[v];
    const Rigid3 T_c_g{exact.T_c_g[v].R, kScale * exact.T_c_g[v].t};
    view.points_g *= kScale;
    for (Eigen::Index k = 0; k < view.num_corners(); ++k) {
      const Eigen::Vector3d point_g = view.points_g.col(k);
      const Eigen::Vector3d there = middle + shape(point_g - middle);
      view.pixels.col(k) =
          *Lens().Project(T_c_g * there) + 0.1 * Eigen::Vector2d(rng.Normal(), rng.Normal());
    }
  }
  return CalibrateCamera(problem);
}

Eigen::Vector3d Flat(Eigen::Vector3d p) { return p; }

TEST(EstimateBoardShape, FindsOneMillimetreOverOneMetre) {
  // A cylinder about y: z = a x^2 stands out by 1 mm between the middle and x = 0.5 m.
  const CameraCalibration calibration = CalibrateWith(
      [](Eigen::Vector3d p) {
        p.z() += 4e-3 * p.x() * p.x();
        return p;
      },
      20, Rng(1));
  const auto estimate = EstimateBoardShape(calibration, {});
  ASSERT_TRUE(estimate);
  EXPECT_LT(estimate->bending.significance.probability, 1e-6);
  // x = 0.1, 0.3, 0.5 m are the rows nearest to and farthest from the middle.
  EXPECT_NEAR(estimate->bending.depth_m, 4e-3 * (0.25 - 0.01), 2e-4);
  const Eigen::Vector3d coefficients = estimate->bending.bending.coefficients;
  EXPECT_NEAR(coefficients.x(), 4e-3, 8e-4);
  EXPECT_NEAR(coefficients.z(), 0.0, 8e-4);
  EXPECT_GT(estimate->stretch->significance.probability, 1e-4);
}

TEST(EstimateBoardShape, SeldomAccusesFlatAndTrueBoards) {
  const int num_boards = FullSample() ? 2000 : 100;
  double sum_of_bending = 0.0;
  double sum_of_stretch = 0.0;
  int num_accused = 0;
  for (int i = 0; i < num_boards; ++i) {
    const auto estimate = EstimateBoardShape(
        CalibrateWith(Flat, 12, Rng(2).Stream("board", static_cast<uint64_t>(i))), {});
    ASSERT_TRUE(estimate && estimate->stretch);
    sum_of_bending += estimate->bending.significance.statistic;
    sum_of_stretch += estimate->stretch->significance.statistic;
    num_accused += estimate->bending.significance.is_significant() ||
                   estimate->stretch->significance.is_significant();
  }
  // Chi-square with 3 and 2 degrees of freedom: means 3 and 2, variances 6 and 4.
  EXPECT_NEAR(sum_of_bending / num_boards, 3.0, 4.0 * std::sqrt(6.0 / num_boards));
  EXPECT_NEAR(sum_of_stretch / num_boards, 2.0, 4.0 * std::sqrt(4.0 / num_boards));
  const double expected = 2.0 * kSignificance * num_boards;
  EXPECT_LE(num_accused, expected + 4.0 * std::sqrt(expected));
}

TEST(EstimateBoardShape, FindsColumnsThatAreFurtherApartThanStated) {
  const CameraCalibration calibration = CalibrateWith(
      [](Eigen::Vector3d p) {
        p.y() *= 1.01;
        return p;
      },
      20, Rng(3));
  const auto estimate = EstimateBoardShape(calibration, {});
  ASSERT_TRUE(estimate);
  const BoardStretchEstimate& stretch = *estimate->stretch;
  EXPECT_LT(stretch.significance.probability, 1e-6);
  EXPECT_NEAR(stretch.stretch, 0.01, 4.0 * stretch.stretch_sigma);
  EXPECT_LT(stretch.stretch_sigma, 1e-3);
  EXPECT_NEAR(stretch.shear, 0.0, 4.0 * stretch.shear_sigma);
  EXPECT_GT(estimate->bending.significance.probability, 1e-4);
}

TEST(EstimateBoardShape, FindsAxesThatAreNotAtRightAngles) {
  const CameraCalibration calibration = CalibrateWith(
      [](Eigen::Vector3d p) {
        p.x() += 0.005 * p.y();
        return p;
      },
      20, Rng(4));
  const auto estimate = EstimateBoardShape(calibration, {});
  ASSERT_TRUE(estimate);
  EXPECT_TRUE(estimate->stretch->significance.is_significant());
  EXPECT_NEAR(estimate->stretch->shear, 0.005, 4.0 * estimate->stretch->shear_sigma);
}

TEST(EstimateBoardShape, IsUnknownWithoutACovariance) { EXPECT_FALSE(EstimateBoardShape({}, {})); }

}  // namespace
}  // namespace calibrato
