#include <gtest/gtest.h>

#include <filesystem>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "calibrato/base/files.h"
#include "calibrato/detection/detect.h"

namespace calibrato {
namespace {

// The photos of Debian's package opencv-doc: 13 pairs of a board of 9 x 6 inner corners.
const std::string kFolder = "/usr/share/doc/opencv-doc/examples/data";
const Checkerboard kBoard{6, 9, 0.025, 0.025};

ImageSource Photos(const std::string& glob) {
  ImageSource source;
  source.names = ListFiles(kFolder, glob);
  source.load = [names = source.names](size_t k) {
    const cv::Mat image = cv::imread(kFolder + "/" + names[k], cv::IMREAD_GRAYSCALE);
    return GreyImage{{image.cols, image.rows}, {image.data, image.data + image.total()}};
  };
  return source;
}

// The root mean square reprojection error of OpenCV's own calibration, with k1 k2 p1 p2 [px].
double CalibratedRms(const Detections& detections) {
  std::vector<std::vector<cv::Point3f>> points_g;
  std::vector<std::vector<cv::Point2f>> pixels;
  for (const BoardView& view : detections.views) {
    points_g.emplace_back();
    pixels.emplace_back();
    for (Eigen::Index k = 0; k < view.num_corners(); ++k) {
      const Eigen::Vector3f point = view.points_g.col(k).cast<float>();
      const Eigen::Vector2f pixel = view.pixels.col(k).cast<float>();
      points_g.back().emplace_back(point.x(), point.y(), point.z());
      pixels.back().emplace_back(pixel.x(), pixel.y());
    }
  }
  cv::Mat K;
  cv::Mat distortion;
  std::vector<cv::Mat> rotations;
  std::vector<cv::Mat> translations;
  return cv::calibrateCamera(points_g, pixels,
                             {detections.resolution.width, detections.resolution.height}, K,
                             distortion, rotations, translations, cv::CALIB_FIX_K3);
}

class DetectPhotos : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(kFolder + "/left01.jpg")) {
      GTEST_SKIP() << "needs the photos of Debian's package opencv-doc in " << kFolder;
    }
  }
};

TEST_F(DetectPhotos, FindsTheBoardInAllOfThemAsWellAsOthersDo) {
  const Detections left = DetectBoards(Photos("left[01]*.jpg"), kBoard);
  EXPECT_EQ(left.num_images, 13);
  EXPECT_EQ(left.views.size(), 13u);
  EXPECT_LT(CalibratedRms(left), 0.20);
  const Detections right = DetectBoards(Photos("right[01]*.jpg"), kBoard);
  EXPECT_EQ(right.num_images, 13);
  EXPECT_EQ(right.views.size(), 13u);
  EXPECT_LT(CalibratedRms(right), 0.21);
}

TEST_F(DetectPhotos, TakesNoCornersFromBesideTheBoard) {
  // With one column more, OpenCV makes one up in left12.jpg.
  const Board board = Checkerboard{6, 10, 0.025, 0.025};
  const ImageSource photo = Photos("left12.jpg");
  EXPECT_FALSE(DetectBoard(photo.load(0), board));
}

}  // namespace
}  // namespace calibrato
