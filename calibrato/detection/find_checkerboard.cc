#include "calibrato/detection/find_checkerboard.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "calibrato/detection/corner_order.h"

namespace calibrato {
namespace {

constexpr int kLargestHalfWindow = 5;
constexpr int kMaxIterations = 40;
constexpr double kConvergedStep = 0.001;  // [px]

// The search takes time and, in very large images, misses boards that are plain to see: it is done
// on an image of at most this side, the refinement on the image itself.
constexpr int kLargestSearchedSide = 1600;

std::vector<cv::Point2f> Search(const cv::Mat& image, cv::Size pattern) {
  std::vector<cv::Point2f> corners;
  // Without OpenCV's CALIB_CB_FAST_CHECK, which takes longer than to find a board that is plain to
  // see and rejects some that are there. Images without a board take longer in return.
  const bool found = cv::findChessboardCorners(
      image, pattern, corners, cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE);
  return found ? corners : std::vector<cv::Point2f>();
}

std::vector<cv::Point2f> SearchReduced(const cv::Mat& image, cv::Size pattern) {
  const int side = std::max(image.cols, image.rows);
  if (side <= kLargestSearchedSide) return Search(image, pattern);
  const double factor = static_cast<double>(kLargestSearchedSide) / side;
  cv::Mat reduced;
  cv::resize(image, reduced, {}, factor, factor, cv::INTER_AREA);
  std::vector<cv::Point2f> corners = Search(reduced, pattern);
  const double u_scale = static_cast<double>(image.cols) / reduced.cols;
  const double v_scale = static_cast<double>(image.rows) / reduced.rows;
  for (cv::Point2f& corner : corners) {
    // Pixel (0, 0) is the centre of the top-left pixel, in both images.
    corner.x = static_cast<float>((corner.x + 0.5) * u_scale - 0.5);
    corner.y = static_cast<float>((corner.y + 0.5) * v_scale - 0.5);
  }
  return corners;
}

double SmallestSpacing(const std::vector<cv::Point2f>& corners, const Checkerboard& board) {
  double smallest = std::numeric_limits<double>::infinity();
  for (int row = 0; row < board.rows; ++row) {
    for (int column = 0; column < board.columns; ++column) {
      const size_t k = static_cast<size_t>(row) * board.columns + column;
      if (column > 0) smallest = std::min(smallest, cv::norm(corners[k] - corners[k - 1]));
      if (row > 0) {
        smallest = std::min(smallest, cv::norm(corners[k] - corners[k - board.columns]));
      }
    }
  }
  return smallest;
}

// A finder asked for one row too many may take it from beside the board. Through a lens the spacing
// changes little from one square to the next: by 0.15 in ordinary photos, 0.6 at the edge of a
// fisheye's.
bool IsEvenlySpaced(const Eigen::Matrix2Xd& pixels, const Checkerboard& board) {
  constexpr double kMaxChange = 0.9;
  const auto is_even = [&](Eigen::Index middle, Eigen::Index step) {
    const Eigen::Vector2d before = pixels.col(middle) - pixels.col(middle - step);
    const Eigen::Vector2d after = pixels.col(middle + step) - pixels.col(middle);
    return (after - before).norm() <= kMaxChange * std::min(before.norm(), after.norm());
  };
  for (int row = 0; row < board.rows; ++row) {
    for (int column = 0; column < board.columns; ++column) {
      const Eigen::Index k = Eigen::Index{row} * board.columns + column;
      if (row > 0 && row + 1 < board.rows && !is_even(k, board.columns)) return false;
      if (column > 0 && column + 1 < board.columns && !is_even(k, 1)) return false;
    }
  }
  return true;
}

// The largest half window that cv::cornerSubPix takes in an image of this size.
int LargestHalfWindow(const cv::Mat& image) { return (std::min(image.cols, image.rows) - 5) / 2; }

bool IsInside(const Eigen::Matrix2Xd& pixels, Resolution resolution) {
  constexpr double kMargin = 1.0;  // [px]
  const Eigen::Array2d largest(resolution.width - 1 - kMargin, resolution.height - 1 - kMargin);
  return (pixels.array() >= kMargin).all() &&
         ((-pixels.array()).colwise() + largest >= 0.0).all();  // NaN fails both
}

}  // namespace

std::optional<Eigen::Matrix2Xd> FindCheckerboard(const GreyImage& image, const Checkerboard& board,
                                                 int half_window) {
  assert(board.rows >= 3 && board.columns >= 3);
  assert(image.pixels.size() ==
         static_cast<size_t>(image.resolution.width) * image.resolution.height);
  const cv::Mat grey(image.resolution.height, image.resolution.width, CV_8UC1,
                     const_cast<uint8_t*>(image.pixels.data()));  // cv::Mat knows no const data
  if (LargestHalfWindow(grey) < 1) return std::nullopt;
  std::vector<cv::Point2f> corners = SearchReduced(grey, {board.columns, board.rows});
  if (corners.empty()) return std::nullopt;

  if (half_window == 0) {
    const double third = SmallestSpacing(corners, board) / 3.0;
    half_window = std::clamp(static_cast<int>(third), 1, kLargestHalfWindow);
  }
  half_window = std::min(half_window, LargestHalfWindow(grey));
  cv::cornerSubPix(
      grey, corners, {half_window, half_window}, {-1, -1},
      {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, kMaxIterations, kConvergedStep});

  Eigen::Matrix2Xd pixels(2, static_cast<Eigen::Index>(corners.size()));
  for (size_t k = 0; k < corners.size(); ++k) {
    pixels.col(static_cast<Eigen::Index>(k)) << corners[k].x, corners[k].y;
  }
  if (!IsInside(pixels, image.resolution) || !IsEvenlySpaced(pixels, board)) return std::nullopt;
  return OrderCorners(image, board, pixels);
}

}  // namespace calibrato
