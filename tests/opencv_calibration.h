#pragma once

#include <opencv2/calib3d.hpp>
#include <vector>

#include "calibrato/sensors/camera_model.h"
#include "calibrato/sensors/measurements.h"

namespace calibrato {

/// OpenCV's own calibrations from corners that we have, as oracles.
struct OpenCvViews {
  std::vector<std::vector<cv::Point3d>> points_g;
  std::vector<std::vector<cv::Point2d>> pixels;

  explicit OpenCvViews(const std::vector<BoardView>& views) {
    for (const BoardView& view : views) {
      points_g.emplace_back();
      pixels.emplace_back();
      for (Eigen::Index k = 0; k < view.num_corners(); ++k) {
        points_g.back().emplace_back(view.points_g(0, k), view.points_g(1, k), 0.0);
        pixels.back().emplace_back(view.pixels(0, k), view.pixels(1, k));
      }
    }
  }
  // cv::calibrateCamera and cv::stereoCalibrate take floats only.
  [[nodiscard]] std::vector<std::vector<cv::Point3f>> FloatPoints() const {
    std::vector<std::vector<cv::Point3f>> result;
    for (const auto& view : points_g) result.emplace_back(view.begin(), view.end());
    return result;
  }
  [[nodiscard]] std::vector<std::vector<cv::Point2f>> FloatPixels() const {
    std::vector<std::vector<cv::Point2f>> result;
    for (const auto& view : pixels) result.emplace_back(view.begin(), view.end());
    return result;
  }
};

struct OpenCvCamera {
  CameraModel model;
  double rms_px = 0.0;  ///< sqrt(sum(du^2 + dv^2) / corners), as OpenCV defines it too.
};

inline const cv::TermCriteria kToTheEnd(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 1000,
                                        1e-15);

/// cv::calibrateCamera with k1 k2 p1 p2 (pinhole-radtan) or k3 too (pinhole-radtan5). Its order of
/// the five is ours.
inline OpenCvCamera CalibrateByOpenCv(const std::vector<BoardView>& views, Resolution resolution,
                                      bool with_k3) {
  const OpenCvViews data(views);
  cv::Mat K, distortion;
  std::vector<cv::Mat> rotations, translations;
  const double rms = cv::calibrateCamera(
      data.FloatPoints(), data.FloatPixels(), {resolution.width, resolution.height}, K, distortion,
      rotations, translations, with_k3 ? 0 : cv::CALIB_FIX_K3, kToTheEnd);
  Eigen::VectorXd parameters(with_k3 ? 9 : 8);
  parameters.head<4>() << K.at<double>(0, 0), K.at<double>(1, 1), K.at<double>(0, 2),
      K.at<double>(1, 2);
  for (int i = 4; i < parameters.size(); ++i) parameters(i) = distortion.at<double>(i - 4);
  return {CameraModel(with_k3 ? "pinhole-radtan5" : "pinhole-radtan", parameters), rms};
}

/// cv::fisheye::calibrate without skew: pinhole-equi.
inline OpenCvCamera CalibrateFisheyeByOpenCv(const std::vector<BoardView>& views,
                                             Resolution resolution) {
  const OpenCvViews data(views);
  cv::Mat K, distortion;
  std::vector<cv::Mat> rotations, translations;
  const double rms = cv::fisheye::calibrate(
      data.points_g, data.pixels, {resolution.width, resolution.height}, K, distortion, rotations,
      translations, cv::fisheye::CALIB_RECOMPUTE_EXTRINSIC | cv::fisheye::CALIB_FIX_SKEW,
      kToTheEnd);
  Eigen::VectorXd parameters(8);
  parameters.head<4>() << K.at<double>(0, 0), K.at<double>(1, 1), K.at<double>(0, 2),
      K.at<double>(1, 2);
  for (int i = 4; i < 8; ++i) parameters(i) = distortion.at<double>(i - 4);
  return {CameraModel("pinhole-equi", parameters), rms};
}

/// The largest difference of two lenses' parameters, in sigmas of the first's.
inline double LargestDifferenceInSigmas(const Eigen::VectorXd& a, const Eigen::VectorXd& b,
                                        const Eigen::MatrixXd& covariance) {
  return (a - b).cwiseQuotient(covariance.diagonal().cwiseSqrt()).cwiseAbs().maxCoeff();
}

}  // namespace calibrato
