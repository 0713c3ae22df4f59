#include "calibrato/detection/homography.h"

#include <opencv2/calib3d.hpp>
#include <vector>

namespace calibrato {

Eigen::Matrix3d FitHomography(const Eigen::Matrix2Xd& board, const Eigen::Matrix2Xd& pixels) {
  std::vector<cv::Point2d> from;
  std::vector<cv::Point2d> to;
  for (Eigen::Index k = 0; k < board.cols(); ++k) {
    from.emplace_back(board(0, k), board(1, k));
    to.emplace_back(pixels(0, k), pixels(1, k));
  }
  const cv::Mat fitted = cv::findHomography(from, to, 0);
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
  if (fitted.empty()) return H;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) H(row, column) = fitted.at<double>(row, column);
  }
  return H;
}

}  // namespace calibrato
