// Real photos from pixels to a verdict. The photos are those of Debian's package opencv-doc;
// OpenCV's own calibration of them: opencv_agreement_test.cc.

#include <gtest/gtest.h>

#include "calibrato/calibration/camera_calibration.h"
#include "calibrato/diagnosis/camera_diagnosis.h"
#include "tests/opencv_photos.h"

namespace calibrato {
namespace {

struct Side {
  const char* glob;
  double max_rms_px;
};

class RealPhotos : public testing::TestWithParam<Side> {};

TEST_P(RealPhotos, AreCalibrated) {
  if (!HaveOpenCvPhotos()) GTEST_SKIP() << kNoOpenCvPhotos;
  Detections detections =
      DetectInPhotos(kOpenCvPhotos, GetParam().glob, Checkerboard{9, 6, 0.025, 0.025});
  EXPECT_EQ(detections.num_images, 13);
  EXPECT_EQ(detections.views.size(), 13U);

  CameraProblem problem;
  problem.resolution = detections.resolution;
  problem.views = std::move(detections.views);
  const CameraCalibration calibration = CalibrateCamera(problem);
  EXPECT_EQ(calibration.termination, Termination::kConverged);
  EXPECT_LE(calibration.reprojection_rms_px, GetParam().max_rms_px);
  EXPECT_NE(VerdictOf(DiagnoseCamera(problem, calibration).findings), Verdict::kFail);
}

INSTANTIATE_TEST_SUITE_P(OpenCvDoc, RealPhotos,
                         testing::Values(Side{"left[01]*.jpg", 0.20},
                                         Side{"right[01]*.jpg", 0.21}));

}  // namespace
}  // namespace calibrato
