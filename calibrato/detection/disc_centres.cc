#include "calibrato/detection/disc_centres.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>
#include <variant>

#include "calibrato/detection/lens_map.h"
#include "calibrato/detection/stray_corners.h"

namespace calibrato {
namespace {

// How far the edge of a disc reaches beyond where it is, by blur [px].
constexpr double kBlurMargin = 2.0;
constexpr double kMinContrast = 8.0;  // [grey levels]
constexpr double kMaxMisfit = 0.35;   // of the area, relative
constexpr double kMaxShift = 0.35;    // of the disc's radius
constexpr int kMinRingPixels = 8;
constexpr int kMaxIterations = 4;
constexpr double kConvergedStep = 0.01;  // [px]

enum class DiscFlaw { kNearBorder, kBadFit };

struct Disc {
  Eigen::Vector2d centroid;
  double area = 0.0;  // [px^2]
};

// The pixels around a disc: how far they are from its centre on the board, and their brightness.
struct Pixel {
  Eigen::Vector2d offset;  // from the window's centre [px]
  double distance = 0.0;   // on the board [m]
  double value = 0.0;
};

// Within `reach` [m] of the centre on the board; nothing where that leaves the image.
std::optional<std::vector<Pixel>> PixelsAround(const GreyImage& image,
                                               const Eigen::Vector2d& centre,
                                               const Eigen::Matrix2d& J_pixel_board, double reach) {
  const auto& [width, height] = image.resolution;
  const Eigen::Vector2d extent = reach * J_pixel_board.rowwise().norm();
  const Eigen::Vector2d low = centre - extent;
  const Eigen::Vector2d high = centre + extent;
  if (!(low.minCoeff() >= 0.0 && high.x() <= width - 1 && high.y() <= height - 1)) {
    return std::nullopt;
  }
  const Eigen::Matrix2d to_board = J_pixel_board.inverse();
  std::vector<Pixel> pixels;
  for (int v = static_cast<int>(std::ceil(low.y())); v <= high.y(); ++v) {
    for (int u = static_cast<int>(std::ceil(low.x())); u <= high.x(); ++u) {
      const Eigen::Vector2d offset = Eigen::Vector2d(u, v) - centre;
      const double distance = (to_board * offset).norm();
      if (distance > reach) continue;
      pixels.push_back(
          {offset, distance,
           static_cast<double>(image.pixels[static_cast<size_t>(v) * static_cast<size_t>(width) +
                                            static_cast<size_t>(u)])});
    }
  }
  return pixels;
}

// The white around the disc, from `inner` outwards, as a plane in (1, u, v).
std::optional<Eigen::Vector3d> WhiteAround(const std::vector<Pixel>& pixels, double inner) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  int count = 0;
  for (const Pixel& pixel : pixels) {
    if (pixel.distance < inner) continue;
    const Eigen::Vector3d terms(1.0, pixel.offset.x(), pixel.offset.y());
    normal += terms * terms.transpose();
    right += pixel.value * terms;
    ++count;
  }
  if (count < kMinRingPixels) return std::nullopt;
  const Eigen::Vector3d plane = normal.ldlt().solve(right);
  return plane.allFinite() ? std::optional(plane) : std::nullopt;
}

// @param radius  Of the disc; `gap`: from centre to centre of the nearest discs [m].
std::variant<Disc, DiscFlaw> MeasureDisc(const GreyImage& image, const LocalMap& map, double radius,
                                         double gap) {
  // The shorter half axis of a small circle's image, over its radius.
  const Eigen::Matrix2d& J = map.J_pixel_board;
  const double trace = J.squaredNorm();
  const double determinant = J.determinant();
  const double smallest = std::sqrt(std::max(
      0.0,
      0.5 * (trace - std::sqrt(std::max(0.0, trace * trace - 4 * determinant * determinant)))));
  const double margin = kBlurMargin / smallest;
  const double inner = radius + margin;
  const double outer = std::min(inner + margin, gap - radius - 0.5 * margin);
  if (!(outer > inner)) return DiscFlaw::kBadFit;

  Eigen::Vector2d centre = map.pixel;
  Disc disc;
  for (int i = 0; i < kMaxIterations; ++i) {
    const std::optional<std::vector<Pixel>> pixels = PixelsAround(image, centre, J, outer);
    if (!pixels) return DiscFlaw::kNearBorder;
    const std::optional<Eigen::Vector3d> white = WhiteAround(*pixels, inner);
    if (!white || !((*white)(0) >= kMinContrast)) return DiscFlaw::kBadFit;
    double mass = 0.0;
    double core_mass = 0.0;
    int core_count = 0;
    double darkest = 0.0;
    Eigen::Vector2d moment = Eigen::Vector2d::Zero();
    for (const Pixel& pixel : *pixels) {
      if (pixel.distance > inner) continue;
      const double bright = (*white)(0) + white->tail<2>().dot(pixel.offset);
      const double darkness = 1.0 - pixel.value / bright;
      mass += darkness;
      moment += darkness * pixel.offset;
      darkest = std::max(darkest, darkness);
      if (pixel.distance < radius - margin) {
        core_mass += darkness;
        ++core_count;
      }
    }
    const double black = core_count > 0 ? core_mass / core_count : darkest;
    if (!(black * (*white)(0) >= kMinContrast)) return DiscFlaw::kBadFit;
    const Eigen::Vector2d step = moment / mass;
    disc.centroid = centre + step;
    disc.area = mass / black;
    if (!((disc.centroid - map.pixel).norm() <= kMaxShift * radius * smallest + 1.0)) {
      return DiscFlaw::kBadFit;
    }
    if (step.norm() < kConvergedStep) break;
    centre = disc.centroid;
  }
  const double expected = std::numbers::pi * radius * radius * std::abs(determinant);
  if (!(std::abs(disc.area - expected) <= kMaxMisfit * expected)) return DiscFlaw::kBadFit;
  return disc;
}

double Median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double RadiusFrom(const std::vector<LocalMap>& maps, const Eigen::VectorXd& areas) {
  std::vector<double> radii;
  for (size_t k = 0; k < maps.size(); ++k) {
    const double area = areas(static_cast<Eigen::Index>(k));
    radii.push_back(
        std::sqrt(area / (std::numbers::pi * std::abs(maps[k].J_pixel_board.determinant()))));
  }
  return Median(std::move(radii));
}

// Points are compared along x with those that follow, as far as these can be nearer.
double SmallestDistance(const Eigen::Matrix2Xd& points) {
  std::vector<Eigen::Vector2d> sorted;
  for (Eigen::Index k = 0; k < points.cols(); ++k) sorted.emplace_back(points.col(k));
  std::sort(sorted.begin(), sorted.end(), [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
  });
  double smallest = std::numeric_limits<double>::infinity();
  for (auto from = sorted.begin(); from != sorted.end(); ++from) {
    for (auto to = from + 1; to != sorted.end() && to->x() - from->x() < smallest; ++to) {
      smallest = std::min(smallest, (*to - *from).norm());
    }
  }
  return smallest;
}

}  // namespace

std::vector<std::optional<Eigen::Vector2d>> FindDiscCentres(const GreyImage& image,
                                                            const Eigen::Matrix2Xd& board,
                                                            const Eigen::Matrix2Xd& pixels,
                                                            const Eigen::VectorXd& areas,
                                                            RejectionCounts* rejected) {
  assert(board.cols() == pixels.cols() && areas.size() == pixels.cols());
  const auto n = static_cast<size_t>(pixels.cols());
  std::vector<std::optional<Eigen::Vector2d>> centres(n);
  const auto fit = [&](const Eigen::Matrix2Xd& points, const Eigen::Matrix2Xd& seen,
                       double radius) {
    return FitLocalMapsThroughLens(points, seen, radius, image.resolution);
  };
  std::vector<LocalMap> maps = fit(board, pixels, 0.0);
  const double first_radius = RadiusFrom(maps, areas);
  const double gap = SmallestDistance(board);
  Eigen::Matrix2Xd centroids = pixels;
  Eigen::VectorXd measured = areas;
  for (size_t k = 0; k < n; ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    const auto found = MeasureDisc(image, maps[k], first_radius, gap);
    if (const auto* disc = std::get_if<Disc>(&found)) {
      centres[k] = disc->centroid;
      centroids.col(column) = disc->centroid;
      measured(column) = disc->area;
    } else if (std::get<DiscFlaw>(found) == DiscFlaw::kNearBorder) {
      ++rejected->corners_near_border;
    } else {
      ++rejected->corners_of_bad_fit;
    }
  }
  const double radius = RadiusFrom(fit(board, centroids, 0.0), measured);
  const auto fit_centroids = [&](const Eigen::Matrix2Xd& points, const Eigen::Matrix2Xd& seen) {
    return fit(points, seen, radius);
  };
  maps = RemoveStrays(board, {gap, gap}, fit_centroids, 0.5, &centres, rejected);
  for (size_t k = 0; k < n; ++k) {
    if (centres[k]) *centres[k] -= maps[k].CentroidOffset(radius);
  }
  return centres;
}

}  // namespace calibrato
