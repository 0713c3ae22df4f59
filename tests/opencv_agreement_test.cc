// Same corners, same model: our solution against OpenCV's, on simulated and real corners (rounded
// to floats, which is all that cv::calibrateCamera takes; outliers kept, as OpenCV does). Ours must
// not leave more than OpenCV's; where both leave the same, they must be the same.

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <string>

#include "calibrato/calibration/camera_calibration.h"
#include "calibrato/calibration/synthetic_views_for_test.h"
#include "tests/opencv_calibration.h"
#include "tests/opencv_photos.h"

namespace calibrato {
namespace {

constexpr Resolution kImage{640, 480};
const Board kBoard = Checkerboard{6, 7, 0.03, 0.03};

void RoundToFloats(std::vector<BoardView>* views) {
  for (BoardView& view : *views) {
    view.pixels = view.pixels.cast<float>().cast<double>();
    view.points_g = view.points_g.cast<float>().cast<double>();
  }
}

CameraProblem MakeProblem(const CameraModel& lens, double max_angle, uint64_t seed) {
  Rng rng(seed);
  CameraProblem problem;
  problem.model = lens.name();
  problem.resolution = kImage;
  problem.views = max_angle > 0.0
                      ? SyntheticWideViews(lens, kImage, kBoard, max_angle, 25, 0.3, rng)
                      : SyntheticViews(lens, kImage, kBoard, 25, 0.3, rng);
  problem.reject_outliers = false;
  RoundToFloats(&problem.views);
  return problem;
}

void ExpectAgreement(const CameraCalibration& ours, const OpenCvCamera& theirs) {
  ASSERT_EQ(ours.termination, Termination::kConverged);
  const double difference = LargestDifferenceInSigmas(ours.model->parameters(),
                                                      theirs.model.parameters(), ours.covariance);
  std::printf("%d corners: rms %.9f px, OpenCV %.9f px; largest difference %.1e sigma\n",
              ours.num_corners, ours.reprojection_rms_px, theirs.rms_px, difference);
  EXPECT_LE(ours.reprojection_rms_px, theirs.rms_px * (1.0 + 1e-9));
  if (theirs.rms_px < ours.reprojection_rms_px * (1.0 + 1e-8)) {
    EXPECT_LT(difference, 1e-3);
  }
}

CameraProblem PhotoProblem(const char* model, const Detections& detections) {
  CameraProblem problem;
  problem.model = model;
  problem.resolution = detections.resolution;
  problem.views = detections.views;
  problem.reject_outliers = false;
  RoundToFloats(&problem.views);
  return problem;
}

TEST(OpenCvAgreement, PinholeRadtan) {
  Eigen::VectorXd parameters(8);
  parameters << 585.0, 590.0, 322.0, 236.0, -0.2, 0.05, 0.001, -0.002;
  const CameraProblem problem = MakeProblem(CameraModel("pinhole-radtan", parameters), 0.0, 1);
  ExpectAgreement(CalibrateCamera(problem), CalibrateByOpenCv(problem.views, kImage, false));
}

TEST(OpenCvAgreement, PinholeRadtan5) {
  Eigen::VectorXd parameters(9);
  parameters << 585.0, 590.0, 322.0, 236.0, -0.2, 0.05, 0.001, -0.002, 0.02;
  const CameraProblem problem = MakeProblem(CameraModel("pinhole-radtan5", parameters), 0.0, 2);
  ExpectAgreement(CalibrateCamera(problem), CalibrateByOpenCv(problem.views, kImage, true));
}

TEST(OpenCvAgreement, PinholeEqui) {
  Eigen::VectorXd parameters(8);
  parameters << 300.0, 301.0, 318.0, 241.0, 0.01, -0.005, 0.002, -0.001;
  const CameraProblem problem = MakeProblem(CameraModel("pinhole-equi", parameters), 0.9, 3);
  ExpectAgreement(CalibrateCamera(problem), CalibrateFisheyeByOpenCv(problem.views, kImage));
}

TEST(OpenCvAgreement, PhotosOfOpenCv) {
  if (!HaveOpenCvPhotos()) GTEST_SKIP() << kNoOpenCvPhotos;
  for (const char* glob : {"left[01]*.jpg", "right[01]*.jpg"}) {
    const Detections found = DetectInPhotos(kOpenCvPhotos, glob, Checkerboard{9, 6, 0.025, 0.025});
    const CameraProblem radtan = PhotoProblem("pinhole-radtan", found);
    ExpectAgreement(CalibrateCamera(radtan), CalibrateByOpenCv(radtan.views, kImage, false));
    const CameraProblem radtan5 = PhotoProblem("pinhole-radtan5", found);
    ExpectAgreement(CalibrateCamera(radtan5), CalibrateByOpenCv(radtan5.views, kImage, true));
  }
}

TEST(OpenCvAgreement, PhotosOfAFisheye) {
  const char* data = std::getenv("CALIBRATO_DATA");
  if (data == nullptr) GTEST_SKIP() << "CALIBRATO_DATA is not set";
  const CameraProblem problem =
      PhotoProblem("pinhole-equi", DetectInPhotos(std::string(data) + "/camodocal_fisheye", "*.png",
                                                  Checkerboard{9, 6, 0.12, 0.12}));
  ExpectAgreement(CalibrateCamera(problem),
                  CalibrateFisheyeByOpenCv(problem.views, problem.resolution));
}

}  // namespace
}  // namespace calibrato
