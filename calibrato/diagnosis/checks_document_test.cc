#include "calibrato/diagnosis/checks_document.h"

#include <gtest/gtest.h>

#include <limits>
#include <numeric>

#include "calibrato/calibration/synthetic_views_for_test.h"

namespace calibrato {
namespace {

TEST(ImageMapValue, KeepsFourDigitsAndMarksWhatDoesNotExist) {
  ImageMap map;
  map.values.resize(1, 3);
  map.values << 0.0123456, std::numeric_limits<double>::quiet_NaN(), 1234.56;
  map.median = 1.5;
  map.worst = 2.5;
  const Value value = ParseJson(ToJson(ToValue(map)), "map");
  const Value::Elements& row = value.At("values_px").elements()[0].elements();
  EXPECT_NEAR(row[0].AsDouble(), 0.01235, 1e-12);
  EXPECT_TRUE(row[1].IsNull());
  EXPECT_NEAR(row[2].AsDouble(), 1235.0, 1e-9);
  EXPECT_EQ(value.At("worst_px").AsDouble(), 2.5);
}

TEST(ProjectionUncertaintyValue, IsAtTheBoardsDistanceAndAtInfinity) {
  Eigen::VectorXd parameters(8);
  parameters << 585.0, 590.0, 322.0, 236.0, -0.2, 0.05, 0.0, 0.0;
  Rng rng(1);
  CameraRigProblem problem;
  CameraProblem& camera = problem.cameras.emplace_back();
  camera.resolution = {640, 480};
  camera.views = SyntheticViews(CameraModel("pinhole-radtan", parameters), camera.resolution,
                                Checkerboard{6, 7, 0.055, 0.055}, 15, 0.1, rng);
  std::vector<int>& frames = problem.frame_of_view.emplace_back(camera.views.size());
  std::iota(frames.begin(), frames.end(), 0);
  const CameraRigCalibration calibration = CalibrateCameraRig(problem);
  const Value value = ProjectionUncertaintyValue(HouseCameras(problem, calibration)[0],
                                                 calibration.cameras[0], camera.resolution);
  EXPECT_GT(value.At("distance_m").AsDouble(), 0.7);
  EXPECT_LT(value.At("distance_m").AsDouble(), 1.4);
  EXPECT_GT(value.At("at_infinity").At("median_px").AsDouble(),
            value.At("at_distance").At("median_px").AsDouble());
  EXPECT_EQ(value.At("at_infinity").At("values_px").size(), static_cast<size_t>(kImageMapRows));
  EXPECT_TRUE(ProjectionUncertaintyValue(std::nullopt, {}, camera.resolution).IsNull());
}

TEST(ChecksValue, IsNullWhereThereIsNothingToSay) {
  const Value value = ChecksValue({});
  EXPECT_EQ(value.members().size(), 4U);
  for (const auto& [key, check] : value.members()) EXPECT_TRUE(check.IsNull()) << key;
}

}  // namespace
}  // namespace calibrato
