// A stereo pair from pixels to the pose between its cameras, beside cv::stereoCalibrate on the same
// corners.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>

#include "calibrato/calibration/camera_rig_calibration.h"
#include "calibrato/geometry/so3.h"
#include "tests/opencv_calibration.h"
#include "tests/opencv_photos.h"

namespace calibrato {
namespace {

struct OpenCvStereo {
  double rms_px = 0.0;
  Eigen::Vector3d t;
  Eigen::Matrix3d R;
};

OpenCvStereo StereoCalibrateByOpenCv(const CameraRigProblem& problem) {
  const OpenCvViews left(problem.cameras[0].views);
  const OpenCvViews right(problem.cameras[1].views);
  const Resolution resolution = problem.cameras[0].resolution;
  cv::Mat K[2], distortion[2], R, t, E, F;
  for (int c = 0; c < 2; ++c) {
    const OpenCvViews& views = c == 0 ? left : right;
    std::vector<cv::Mat> rotations, translations;
    cv::calibrateCamera(views.FloatPoints(), views.FloatPixels(),
                        {resolution.width, resolution.height}, K[c], distortion[c], rotations,
                        translations, cv::CALIB_FIX_K3, kToTheEnd);
  }
  OpenCvStereo stereo;
  stereo.rms_px =
      cv::stereoCalibrate(left.FloatPoints(), left.FloatPixels(), right.FloatPixels(), K[0],
                          distortion[0], K[1], distortion[1], {resolution.width, resolution.height},
                          R, t, E, F, cv::CALIB_USE_INTRINSIC_GUESS | cv::CALIB_FIX_K3, kToTheEnd);
  for (int i = 0; i < 3; ++i) {
    stereo.t(i) = t.at<double>(i);
    for (int j = 0; j < 3; ++j) stereo.R(i, j) = R.at<double>(i, j);
  }
  return stereo;
}

TEST(Stereo, BaselineAndRmsAreThoseOfOpenCv) {
  if (!HaveOpenCvPhotos()) GTEST_SKIP() << kNoOpenCvPhotos;
  CameraRigProblem problem;
  for (const char* glob : {"left[01]*.jpg", "right[01]*.jpg"}) {
    Detections detections = DetectInPhotos(kOpenCvPhotos, glob, Checkerboard{9, 6, 0.025, 0.025});
    ASSERT_EQ(detections.views.size(), 13U);
    CameraProblem camera;
    camera.resolution = detections.resolution;
    camera.views = std::move(detections.views);
    // The same corners for both: OpenCV keeps outliers.
    camera.reject_outliers = false;
    problem.cameras.push_back(std::move(camera));
    problem.frame_of_view.emplace_back();
    for (int v = 0; v < 13; ++v) problem.frame_of_view.back().push_back(v);
  }
  const CameraRigCalibration ours = CalibrateCameraRig(problem);
  ASSERT_EQ(ours.termination, Termination::kConverged);
  const OpenCvStereo theirs = StereoCalibrateByOpenCv(problem);
  double sum = 0.0;
  int count = 0;
  for (const CameraCalibration& camera : ours.cameras) {
    sum += camera.reprojection_rms_px * camera.reprojection_rms_px * camera.num_corners;
    count += camera.num_corners;
  }
  const double rms = std::sqrt(sum / count);
  const Rigid3& T = *ours.T_cn_cnm1[0];
  std::printf("rms %.4f px, OpenCV %.4f px; baseline %.3f mm, OpenCV %.3f mm\n", rms, theirs.rms_px,
              1e3 * T.t.norm(), 1e3 * theirs.t.norm());
  // Ours weights each camera by its own noise; of all weights, OpenCV's make the rms least.
  EXPECT_NEAR(rms, theirs.rms_px, 0.002);
  const Eigen::VectorXd sigma = ours.covariance.diagonal().cwiseSqrt();
  const auto first =
      std::find(ours.covariance_names.begin(), ours.covariance_names.end(), "cam1.rot_x") -
      ours.covariance_names.begin();
  const Eigen::Matrix<double, 6, 1> difference = T.DifferenceTo({theirs.R, theirs.t});
  EXPECT_LT(difference.cwiseQuotient(sigma.segment<6>(first)).cwiseAbs().maxCoeff(), 0.5)
      << difference.transpose();
}

}  // namespace
}  // namespace calibrato
