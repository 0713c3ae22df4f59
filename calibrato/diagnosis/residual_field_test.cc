#include "calibrato/diagnosis/residual_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "calibrato/base/full_sample_for_test.h"
#include "calibrato/calibration/synthetic_views_for_test.h"

namespace calibrato {
namespace {

constexpr Resolution kImage{640, 480};

CameraCalibration Calibrate(const std::string& model, double k1, int num_views, Rng rng) {
  Eigen::VectorXd parameters(8);
  parameters << 585.0, 590.0, 322.0, 236.0, k1, 0.05, 0.0, 0.0;
  CameraProblem problem;
  problem.model = model;
  problem.resolution = kImage;
  problem.views = SyntheticViews(CameraModel("pinhole-radtan", parameters), kImage,
                                 Checkerboard{6, 7, 0.055, 0.055}, num_views, 0.1, rng);
  return CalibrateCamera(problem);
}

TEST(ResidualField, IsNoiseWhereTheModelFits) {
  const int num_rigs = FullSample() ? 1000 : 100;
  double largest = 0.0;
  double mean = 0.0;
  for (int i = 0; i < num_rigs; ++i) {
    const ResidualField field = ResidualFieldOf(
        Calibrate("pinhole-radtan", -0.2, 15, Rng(1).Stream("rig", static_cast<uint64_t>(i))),
        kImage);
    largest = std::max(largest, field.neighbour_correlation / field.correlation_sigma);
    mean += field.neighbour_correlation / num_rigs;
  }
  EXPECT_LT(largest, 4.0);
  // The pose takes up 6 of a view's 84 numbers and the camera 8 of fifteen views', all smooth.
  EXPECT_NEAR(mean, -(6.0 + 8.0 / 15.0) / 84.0, 0.02);
}

TEST(ResidualField, IsSmoothWhereTheModelDoesNotFitTheLens) {
  const ResidualField field = ResidualFieldOf(Calibrate("pinhole-none", -0.2, 30, Rng(2)), kImage);
  EXPECT_GT(field.neighbour_correlation, 20.0 * field.correlation_sigma);
  EXPECT_GT(field.neighbour_correlation, 0.5);
}

TEST(ResidualField, ByHand) {
  // Two corners in the top left cell, one in the bottom right.
  CameraCalibration calibration;
  BoardView view;
  view.pixels.resize(2, 3);
  view.pixels << 0.0, 79.4, 639.0, 0.0, 79.4, 479.0;
  view.points_g.setZero(3, 3);
  view.points_g.row(0) << 0.0, 0.1, 0.2;
  Eigen::Matrix2Xd residuals(2, 3);
  residuals << 1.0, 3.0, 2.0, 0.0, 0.0, -1.0;
  calibration.used_views = {view};
  calibration.residuals = {residuals};
  calibration.num_corners = 3;
  calibration.reprojection_rms_px = std::sqrt(5.0);
  const ResidualField field = ResidualFieldOf(calibration, kImage);
  EXPECT_EQ(field.num_corners(0, 0), 2);
  EXPECT_EQ(field.mean_u(0, 0), 2.0);
  EXPECT_EQ(field.mean_v(0, 0), 0.0);
  EXPECT_EQ(field.num_corners(5, 7), 1);
  EXPECT_EQ(field.mean_v(5, 7), -1.0);
  EXPECT_TRUE(std::isnan(field.mean_u(2, 3)));
  // Pairs (0, 1) and (1, 2): products 3 + 6, mean squares 5 + 7.
  EXPECT_NEAR(field.neighbour_correlation, 9.0 / 12.0, 1e-12);
  EXPECT_NEAR(field.correlation_sigma, 0.5, 1e-12);
  EXPECT_NEAR(field.systematic_rms_px, std::sqrt(0.75 * 5.0), 1e-12);
}

}  // namespace
}  // namespace calibrato
