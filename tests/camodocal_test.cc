// 32 photos of a strong fisheye from pixels to parameters, with four models.

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "calibrato/calibration/camera_calibration.h"
#include "tests/opencv_photos.h"

namespace calibrato {
namespace {

TEST(Camodocal, FourModelsFitTheFisheye) {
  const char* data = std::getenv("CALIBRATO_DATA");
  if (data == nullptr) GTEST_SKIP() << "CALIBRATO_DATA is not set";
  const Detections detections = DetectInPhotos(std::string(data) + "/camodocal_fisheye", "*.png",
                                               Checkerboard{9, 6, 0.12, 0.12});
  EXPECT_EQ(detections.num_images, 32);
  EXPECT_GE(detections.views.size(), 27U);
  for (const char* model : {"pinhole-equi", "omni-radtan", "ds-none", "eucm-none"}) {
    CameraProblem problem;
    problem.model = model;
    problem.resolution = detections.resolution;
    problem.views = detections.views;
    const CameraCalibration result = CalibrateCamera(problem);
    EXPECT_EQ(result.termination, Termination::kConverged) << model;
    EXPECT_GE(result.used_views.size(), 27U) << model;
    EXPECT_LE(result.reprojection_rms_px, 0.35) << model;
    std::printf("%s: %zu of %d photos, rms %.3f px (all %.3f), %zu corners left out", model,
                result.used_views.size(), detections.num_images, result.reprojection_rms_px,
                result.reprojection_rms_all_px, result.rejected_corners.size());
    for (const RejectedView& view : result.rejected_views) {
      std::printf(", %s %s (%.2f px)", view.name.c_str(), ViewRejectionName(view.reason).c_str(),
                  view.rms_px);
    }
    std::printf("\n");
  }
}

}  // namespace
}  // namespace calibrato
