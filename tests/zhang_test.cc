// Zhang's data of 1998 through the example program that converts them, against his published
// result.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "calibrato/calibration/camera_calibration.h"
#include "calibrato/recording/recording.h"

namespace calibrato {
namespace {

TEST(Zhang, PublishedResultIsReproduced) {
  const char* data = std::getenv("CALIBRATO_DATA");
  if (data == nullptr) GTEST_SKIP() << "CALIBRATO_DATA is not set";
  const std::string out = testing::TempDir() + "calibrato_zhang";
  std::filesystem::remove_all(out);
  const std::string command = std::string(ZHANG_TO_CORNER_LIST) + " '" + data +
                              "/zhang1998/data/TextDataResource-data' '" + out + "'";
  ASSERT_EQ(std::system(command.c_str()), 0) << command;
  const Recording recording = OpenRecording(out, {});
  CameraProblem problem;
  problem.resolution = *recording.cameras.at(0).resolution;
  problem.views = std::get<std::vector<BoardView>>(recording.cameras.at(0).data);
  ASSERT_EQ(problem.views.size(), 5U);
  ASSERT_EQ(problem.views[0].num_corners(), 256);
  HoldParameters({"p1", "p2"}, &problem);
  // His estimate is plain least squares over all corners.
  problem.reject_outliers = false;
  const CameraCalibration calibration = CalibrateCamera(problem);
  EXPECT_EQ(calibration.termination, Termination::kConverged);
  // alpha, beta, u0, v0 and k1, k2 of his calibration-result file.
  const Eigen::Vector4d published(832.5, 832.53, 303.959, 206.585);
  EXPECT_LT((calibration.model->focal_and_centre() - published).cwiseAbs().maxCoeff(), 0.5);
  EXPECT_NEAR(calibration.model->parameters()(4), -0.228601, 0.005);
  EXPECT_NEAR(calibration.model->parameters()(5), 0.190353, 0.005);
  // By default too: none of the 1280 corners is so far off that it could not be noise.
  problem.reject_outliers = true;
  const CameraCalibration robust = CalibrateCamera(problem);
  EXPECT_TRUE(robust.rejected_corners.empty());
  EXPECT_LT((robust.model->focal_and_centre() - published).cwiseAbs().maxCoeff(), 0.5);
  std::filesystem::remove_all(out);
}

}  // namespace
}  // namespace calibrato
