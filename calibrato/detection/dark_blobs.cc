#include "calibrato/detection/dark_blobs.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

namespace calibrato {
namespace {

// Dark is what is darker by this than its neighbourhood's mean, over a square of this share of the
// image's shorter side.
constexpr double kMinDarkness = 6.0;  // [grey levels]
constexpr double kNeighbourhood = 0.15;
constexpr double kMinArea = 12.0;  // [px^2]
constexpr double kMaxAreaShare = 0.02;
// The area of an ellipse with these second moments, over the blob's: 1 for an ellipse. The grain of
// small blobs shows.
constexpr double kMaxExcess = 0.12;
constexpr double kMaxElongation = 6.0;

struct Moments {
  double count = 0.0;
  double u = 0.0;
  double v = 0.0;
  double uu = 0.0;
  double uv = 0.0;
  double vv = 0.0;
};

bool IsEllipse(const Moments& m, double area) {
  const double mean_u = m.u / m.count;
  const double mean_v = m.v / m.count;
  // A pixel is a square, not a point: its own second moment is 1/12.
  const double uu = m.uu / m.count - mean_u * mean_u + 1.0 / 12.0;
  const double vv = m.vv / m.count - mean_v * mean_v + 1.0 / 12.0;
  const double uv = m.uv / m.count - mean_u * mean_v;
  const double determinant = uu * vv - uv * uv;
  const double half_trace = 0.5 * (uu + vv);
  const double root = std::sqrt(std::max(0.0, half_trace * half_trace - determinant));
  if (!(half_trace + root <= kMaxElongation * kMaxElongation * (half_trace - root))) return false;
  const double ellipse = 4.0 * std::numbers::pi * std::sqrt(determinant);
  return std::abs(ellipse / area - 1.0) <= kMaxExcess + 1.0 / area;
}

}  // namespace

std::vector<DarkBlob> FindDarkBlobs(const GreyImage& image) {
  const cv::Mat grey(image.resolution.height, image.resolution.width, CV_8UC1,
                     const_cast<uint8_t*>(image.pixels.data()));  // cv::Mat knows no const data
  std::vector<DarkBlob> blobs;
  const int shorter = std::min(grey.cols, grey.rows);
  if (shorter < 16) return blobs;
  const int block = static_cast<int>(kNeighbourhood * shorter) / 2 * 2 + 3;
  cv::Mat is_dark;
  cv::adaptiveThreshold(grey, is_dark, 255, cv::ADAPTIVE_THRESH_MEAN_C, cv::THRESH_BINARY_INV,
                        block, kMinDarkness);
  cv::Mat labels;
  cv::Mat stats;
  cv::Mat middles;
  const int count = cv::connectedComponentsWithStats(is_dark, labels, stats, middles, 4, CV_32S);
  const double max_area = kMaxAreaShare * static_cast<double>(grey.total());
  for (int label = 1; label < count; ++label) {
    const int left = stats.at<int>(label, cv::CC_STAT_LEFT);
    const int top = stats.at<int>(label, cv::CC_STAT_TOP);
    const int width = stats.at<int>(label, cv::CC_STAT_WIDTH);
    const int height = stats.at<int>(label, cv::CC_STAT_HEIGHT);
    const double area = stats.at<int>(label, cv::CC_STAT_AREA);
    const bool touches_border =
        left == 0 || top == 0 || left + width == grey.cols || top + height == grey.rows;
    // An ellipse fills at least a seventh of its box, however it is turned, up to kMaxElongation.
    if (touches_border || area < kMinArea || area > max_area || 7.0 * area < width * height) {
      continue;
    }
    Moments m;
    for (int v = 0; v < height; ++v) {
      const int* row = labels.ptr<int>(top + v) + left;
      for (int u = 0; u < width; ++u) {
        if (row[u] != label) continue;
        m.count += 1.0;
        m.u += u;
        m.v += v;
        m.uu += u * u;
        m.uv += u * v;
        m.vv += v * v;
      }
    }
    if (!IsEllipse(m, area)) continue;
    blobs.push_back({{left + m.u / m.count, top + m.v / m.count}, area});
  }
  return blobs;
}

}  // namespace calibrato
