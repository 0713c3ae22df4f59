// Real photos from pixels to parameters, against OpenCV's own calibration from the same corners.
// The photos are those of Debian's package opencv-doc.

#include <gtest/gtest.h>

#include <filesystem>
#include <opencv2/calib3d.hpp>
#include <string>
#include <vector>

#include "calibrato/calibration/camera_calibration.h"
#include "calibrato/detection/detect.h"
#include "calibrato/diagnosis/camera_diagnosis.h"
#include "calibrato/recording/photo.h"
#include "calibrato/recording/recording.h"

namespace calibrato {
namespace {

const char* const kPhotos = "/usr/share/doc/opencv-doc/examples/data";

struct Side {
  const char* glob;
  double max_rms_px;
};

class RealPhotos : public testing::TestWithParam<Side> {};

// Focal lengths by cv::calibrateCamera with k1 k2 p1 p2.
Eigen::Vector2d OpenCvFocalLengths(const CameraProblem& problem) {
  std::vector<std::vector<cv::Point3f>> points;
  std::vector<std::vector<cv::Point2f>> pixels;
  for (const BoardView& view : problem.views) {
    points.emplace_back();
    pixels.emplace_back();
    for (Eigen::Index k = 0; k < view.num_corners(); ++k) {
      points.back().emplace_back(view.points_g(0, k), view.points_g(1, k), 0.0F);
      pixels.back().emplace_back(view.pixels(0, k), view.pixels(1, k));
    }
  }
  cv::Mat K;
  cv::Mat distortion;
  std::vector<cv::Mat> rotations;
  std::vector<cv::Mat> translations;
  cv::calibrateCamera(points, pixels, {problem.resolution.width, problem.resolution.height}, K,
                      distortion, rotations, translations, cv::CALIB_FIX_K3);
  return {K.at<double>(0, 0), K.at<double>(1, 1)};
}

TEST_P(RealPhotos, AreCalibratedAsWellAsByOpenCv) {
  if (!std::filesystem::exists(std::string(kPhotos) + "/left01.jpg")) {
    GTEST_SKIP() << "the photos of opencv-doc are not installed; tools/install_dependencies does";
  }
  RecordingOptions options;
  options.image_globs = {GetParam().glob};
  const Recording recording = OpenRecording(kPhotos, options);
  const auto& images = std::get<std::vector<ImageFile>>(recording.cameras.at(0).data);
  ImageSource source;
  for (const ImageFile& image : images) source.names.push_back(image.name);
  source.load = [&](size_t k) { return ReadPhoto(images[k].path); };
  Detections detections = DetectBoards(source, Checkerboard{9, 6, 0.025, 0.025});
  EXPECT_EQ(detections.num_images, 13);
  EXPECT_EQ(detections.views.size(), 13U);

  CameraProblem problem;
  problem.resolution = detections.resolution;
  problem.views = std::move(detections.views);
  const CameraCalibration calibration = CalibrateCamera(problem);
  EXPECT_EQ(calibration.termination, Termination::kConverged);
  EXPECT_LE(calibration.reprojection_rms_px, GetParam().max_rms_px);
  EXPECT_NE(VerdictOf(DiagnoseCamera(problem, calibration)), Verdict::kFail);
  const Eigen::Vector2d ours = calibration.model->intrinsics().head<2>();
  const Eigen::Vector2d theirs = OpenCvFocalLengths(problem);
  EXPECT_LT((ours - theirs).cwiseAbs().maxCoeff(), 1.0) << ours << "\n" << theirs;
}

INSTANTIATE_TEST_SUITE_P(OpenCvDoc, RealPhotos,
                         testing::Values(Side{"left[01]*.jpg", 0.20},
                                         Side{"right[01]*.jpg", 0.21}));

}  // namespace
}  // namespace calibrato
