// A real stereo fisheye rig through the example program that converts it, against its owner's
// result.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "calibrato/calibration/camera_rig_calibration.h"
#include "calibrato/calibration/frame_matching.h"
#include "calibrato/recording/recording.h"

namespace calibrato {
namespace {

TEST(Pfrommer, TheOwnersFocalLengthsAreReproduced) {
  const char* data = std::getenv("CALIBRATO_DATA");
  if (data == nullptr) GTEST_SKIP() << "CALIBRATO_DATA is not set";
  const std::string out = testing::TempDir() + "calibrato_pfrommer";
  std::filesystem::remove_all(out);
  const std::string command = std::string(PFROMMER_TO_CORNER_LIST) + " '" + data +
                              "/pfrommer_fisheye_corners' '" + out + "'";
  ASSERT_EQ(std::system(command.c_str()), 0) << command;
  const Recording recording = OpenRecording(out, {});
  ASSERT_EQ(recording.cameras.size(), 2U);
  CameraRigProblem problem;
  std::vector<std::vector<BoardView>> views;
  int num_corners[2] = {0, 0};
  for (size_t c = 0; c < 2; ++c) {
    CameraProblem camera;
    camera.model = "pinhole-equi";
    camera.resolution = *recording.cameras[c].resolution;
    camera.views = std::get<std::vector<BoardView>>(recording.cameras[c].data);
    views.push_back(camera.views);
    for (const BoardView& view : camera.views)
      num_corners[c] += static_cast<int>(view.num_corners());
    problem.cameras.push_back(std::move(camera));
  }
  EXPECT_EQ(views[0].size() + views[1].size(), 1076U);
  problem.frame_of_view = FramesByStamp(views, DefaultStampTolerance(views));
  const CameraRigCalibration result = CalibrateCameraRig(problem);
  EXPECT_EQ(result.termination, Termination::kConverged);
  const Eigen::Vector2d owners[] = {{840.28, 838.01}, {840.36, 837.82}};
  for (size_t c = 0; c < 2; ++c) {
    const CameraCalibration& camera = result.cameras[c];
    EXPECT_LT((camera.model->focal_and_centre().head<2>() - owners[c]).cwiseAbs().maxCoeff(), 8.0)
        << camera.model->parameters().transpose();
    EXPECT_LE(camera.reprojection_rms_px, 0.45);
    EXPECT_GE(camera.num_corners, static_cast<int>(0.99 * num_corners[c]));
    std::printf("cam%zu: rms %.4f px (all %.4f), %d of %d corners, f %.2f %.2f\n", c,
                camera.reprojection_rms_px, camera.reprojection_rms_all_px, camera.num_corners,
                num_corners[c], camera.model->focal_and_centre()(0),
                camera.model->focal_and_centre()(1));
  }
  EXPECT_EQ(result.num_shared_frames[0], 341);
  ASSERT_TRUE(result.T_cn_cnm1[0]);
  std::filesystem::remove_all(out);
}

}  // namespace
}  // namespace calibrato
