#include "calibrato/detection/saddle_search.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>

namespace calibrato {
namespace {

constexpr int kFirstSearchedSide = 480;     // [px]
constexpr int kLongestSearchedSide = 2600;  // [px]
constexpr int kReach = 2;                   // of the second differences [px]
constexpr int kMinDistance = 3;             // between saddles [px]
constexpr int kBorder = 4;                  // [px], the ring's radius
// Of the second differences' determinant: a corner with a contrast of 15 grey levels reaches it.
constexpr int kMinStrength = 20;
constexpr double kMinRingContrast = 10.0;  // [grey levels]
constexpr size_t kMaxSaddles = 3000;       // the strongest; more are texture

// Sixteen pixels on a circle of radius 4, in order of their angle.
constexpr std::array<std::array<int, 2>, 16> kRing = {{{4, 0},
                                                       {4, 2},
                                                       {3, 3},
                                                       {2, 4},
                                                       {0, 4},
                                                       {-2, 4},
                                                       {-3, 3},
                                                       {-4, 2},
                                                       {-4, 0},
                                                       {-4, -2},
                                                       {-3, -3},
                                                       {-2, -4},
                                                       {0, -4},
                                                       {2, -4},
                                                       {3, -3},
                                                       {4, -2}}};

cv::Mat Reduced(const GreyImage& image, int reduction) {
  const cv::Mat whole(image.resolution.height, image.resolution.width, CV_8UC1,
                      const_cast<uint8_t*>(image.pixels.data()));  // cv::Mat knows no const data
  cv::Mat reduced;
  if (reduction == 1) {
    reduced = whole;
  } else {
    // Remainders at the right and the bottom are left out, so that pixels are whole blocks.
    const cv::Size size(whole.cols / reduction, whole.rows / reduction);
    if (size.empty()) return {};
    cv::resize(whole(cv::Rect(0, 0, size.width * reduction, size.height * reduction)), reduced,
               size, 0.0, 0.0, cv::INTER_AREA);
  }
  cv::Mat smooth;
  cv::GaussianBlur(reduced, smooth, {5, 5}, 1.0, 1.0, cv::BORDER_REPLICATE);
  return smooth;
}

// Minus the determinant of the matrix of second differences: positive at saddles.
void Strengths(const cv::Mat& image, cv::Mat* strengths) {
  strengths->create(image.size(), CV_32SC1);
  strengths->setTo(0);
  for (int v = kBorder; v < image.rows - kBorder; ++v) {
    const uint8_t* above = image.ptr<uint8_t>(v - kReach);
    const uint8_t* here = image.ptr<uint8_t>(v);
    const uint8_t* below = image.ptr<uint8_t>(v + kReach);
    auto* out = strengths->ptr<int>(v);
    for (int u = kBorder; u < image.cols - kBorder; ++u) {
      const int uu = here[u + kReach] - 2 * here[u] + here[u - kReach];
      const int vv = below[u] - 2 * here[u] + above[u];
      const int uv4 = below[u + kReach] + above[u - kReach] - below[u - kReach] - above[u + kReach];
      out[u] = ((uv4 * uv4) >> 4) - uu * vv;
    }
  }
}

// On a circle about a corner it is bright, dark, bright, dark, and the same on opposite sides.
bool LooksLikeACornerAround(const cv::Mat& image, int u, int v) {
  std::array<int, 16> ring{};
  int lowest = 255;
  int highest = 0;
  for (size_t k = 0; k < ring.size(); ++k) {
    ring[k] = image.at<uint8_t>(v + kRing[k][1], u + kRing[k][0]);
    lowest = std::min(lowest, ring[k]);
    highest = std::max(highest, ring[k]);
  }
  const int contrast = highest - lowest;
  if (contrast < kMinRingContrast) return false;
  int num_changes = 0;
  int asymmetry = 0;
  for (size_t k = 0; k < ring.size(); ++k) {
    const bool is_bright = 2 * ring[k] > lowest + highest;
    const bool is_next_bright = 2 * ring[(k + 1) % ring.size()] > lowest + highest;
    num_changes += is_bright != is_next_bright ? 1 : 0;
    if (k < 8) asymmetry += std::abs(ring[k] - ring[k + 8]);
  }
  return num_changes == 4 && asymmetry < 8 * contrast * 0.3;
}

std::optional<Saddle> SaddleAt(const cv::Mat& image, int u, int v) {
  const auto at = [&](int du, int dv) -> double { return image.at<uint8_t>(v + dv, u + du); };
  constexpr int r = kReach;
  Eigen::Matrix2d hessian;
  hessian(0, 0) = at(r, 0) - 2.0 * at(0, 0) + at(-r, 0);
  hessian(1, 1) = at(0, r) - 2.0 * at(0, 0) + at(0, -r);
  hessian(0, 1) = 0.25 * (at(r, r) + at(-r, -r) - at(-r, r) - at(r, -r));
  hessian(1, 0) = hessian(0, 1);
  const Eigen::Vector2d gradient(0.5 * (at(r, 0) - at(-r, 0)), 0.5 * (at(0, r) - at(0, -r)));
  const double determinant = hessian.determinant();
  if (!(determinant < 0.0)) return std::nullopt;
  const Eigen::Vector2d offset = -r * (hessian.inverse() * gradient);
  if (!(offset.norm() < 2.0)) return std::nullopt;

  // The axis of the dark quadrants is that of the negative curvature; along the edges there is
  // none.
  const double mean = 0.5 * hessian.trace();
  const double half_difference = 0.5 * (hessian(0, 0) - hessian(1, 1));
  const double radius = std::hypot(half_difference, hessian(0, 1));
  const double bright_axis = 0.5 * std::atan2(hessian(0, 1), half_difference);
  const double dark_axis = bright_axis + 0.5 * M_PI;
  const double half_angle = std::atan(std::sqrt((radius - mean) / (radius + mean)));
  Saddle saddle;
  saddle.pixel = Eigen::Vector2d(u, v) + offset;
  saddle.edges.col(0) << std::cos(dark_axis - half_angle), std::sin(dark_axis - half_angle);
  saddle.edges.col(1) << std::cos(dark_axis + half_angle), std::sin(dark_axis + half_angle);
  saddle.strength = -determinant;
  return saddle;
}

}  // namespace

std::vector<Saddle> FindSaddles(const GreyImage& image, int reduction) {
  const cv::Mat smooth = Reduced(image, reduction);
  std::vector<Saddle> saddles;
  if (smooth.cols <= 2 * kBorder || smooth.rows <= 2 * kBorder) return saddles;
  cv::Mat strengths;
  Strengths(smooth, &strengths);
  const auto is_largest_around = [&](int u, int v, int strength) {
    for (int dv = -kMinDistance; dv <= kMinDistance; ++dv) {
      const auto* row = strengths.ptr<int>(v + dv) + u;
      for (int du = -kMinDistance; du <= kMinDistance; ++du) {
        // Of equals the first counts.
        const bool is_before = dv < 0 || (dv == 0 && du < 0);
        if (row[du] > strength || (is_before && row[du] == strength)) return false;
      }
    }
    return true;
  };
  for (int v = kBorder; v < smooth.rows - kBorder; ++v) {
    const auto* row = strengths.ptr<int>(v);
    for (int u = kBorder; u < smooth.cols - kBorder; ++u) {
      if (row[u] < kMinStrength || row[u] < row[u - 1] || row[u] < row[u + 1]) continue;
      if (!is_largest_around(u, v, row[u]) || !LooksLikeACornerAround(smooth, u, v)) continue;
      if (std::optional<Saddle> saddle = SaddleAt(smooth, u, v)) {
        // Pixel (0, 0) is the centre of the top-left pixel, in both images.
        saddle->pixel = ((saddle->pixel.array() + 0.5) * reduction - 0.5).matrix();
        saddles.push_back(*saddle);
      }
    }
  }
  std::stable_sort(saddles.begin(), saddles.end(),
                   [](const Saddle& a, const Saddle& b) { return a.strength > b.strength; });
  if (saddles.size() > kMaxSaddles) saddles.resize(kMaxSaddles);
  return saddles;
}

std::vector<int> ReductionsToSearch(Resolution resolution) {
  const int side = std::max(resolution.width, resolution.height);
  int first = 1;
  while (side / first > kFirstSearchedSide) first *= 2;
  std::vector<int> reductions;
  for (int k = first; k >= 1 && side / k <= kLongestSearchedSide; k /= 2) reductions.push_back(k);
  reductions.push_back(2 * first);
  return reductions;
}

}  // namespace calibrato
