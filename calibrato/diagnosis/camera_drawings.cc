#include "calibrato/diagnosis/camera_drawings.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>

#include "calibrato/calibration/lens_twin.h"

namespace calibrato {
namespace {

constexpr size_t kMostRejectedCorners = 1000;

double Hundredths(double x) { return std::round(100.0 * x) / 100.0; }

Value Pair(const Eigen::Vector2d& pixel) {
  Value pair = Value::Array();
  pair.Append(Hundredths(pixel.x())).Append(Hundredths(pixel.y()));
  return pair;
}

Value Pairs(const Eigen::Matrix2Xd& pixels) {
  Value pairs = Value::Array();
  for (Eigen::Index k = 0; k < pixels.cols(); ++k) pairs.Append(Pair(pixels.col(k)));
  return pairs;
}

// The corners on the board's rows and columns, each line in order: points that share a coordinate.
Value LinesOfBoard(const Eigen::Matrix3Xd& points_g) {
  constexpr double kSameCoordinate = 1e-5;  // [m]
  Value lines = Value::Array();
  for (const int shared : {0, 1}) {
    std::map<int64_t, std::vector<int>> by_coordinate;
    for (Eigen::Index k = 0; k < points_g.cols(); ++k) {
      by_coordinate[std::llround(points_g(shared, k) / kSameCoordinate)].push_back(
          static_cast<int>(k));
    }
    for (auto& [coordinate, line] : by_coordinate) {
      if (line.size() < 2) continue;
      std::sort(line.begin(), line.end(),
                [&](int a, int b) { return points_g(1 - shared, a) < points_g(1 - shared, b); });
      Value indices = Value::Array();
      for (const int k : line) indices.Append(k);
      lines.Append(std::move(indices));
    }
  }
  return lines;
}

double AreaOfBox(const Eigen::Matrix2Xd& pixels) {
  return (pixels.rowwise().maxCoeff() - pixels.rowwise().minCoeff()).prod();
}

// Pixels of a pinhole camera that looks along the mean ray, scaled and shifted so that the view is
// where, and as large as, it was. Nothing where a corner has no ray or lies behind that camera.
std::optional<Eigen::Matrix2Xd> Straightened(const CameraModel& model,
                                             const Eigen::Matrix2Xd& pixels) {
  Eigen::Matrix3Xd rays(3, pixels.cols());
  for (Eigen::Index k = 0; k < pixels.cols(); ++k) {
    const auto ray = model.Unproject(pixels.col(k));
    if (!ray) return std::nullopt;
    rays.col(k) = ray->normalized();
  }
  const Eigen::Vector3d middle = rays.rowwise().mean();
  const Eigen::Matrix3Xd turned =
      Eigen::Quaterniond::FromTwoVectors(middle, Eigen::Vector3d::UnitZ()).toRotationMatrix() *
      rays;
  if (!(turned.row(2).minCoeff() > 0.1)) return std::nullopt;
  const Eigen::Matrix2Xd straight = turned.colwise().hnormalized();
  const double scale = std::sqrt(AreaOfBox(pixels) / AreaOfBox(straight));
  const Eigen::Vector2d shift =
      0.5 * (pixels.rowwise().maxCoeff() + pixels.rowwise().minCoeff()) -
      0.5 * scale * (straight.rowwise().maxCoeff() + straight.rowwise().minCoeff());
  return (scale * straight).colwise() + shift;
}

}  // namespace

Value DistortionCurve(const CameraModel& model, Resolution resolution) {
  constexpr int kNumPoints = 60;
  Eigen::Vector4d k = model.focal_and_centre();
  k.head<2>() *= CentralFocalLength(model) / k(0);
  const Eigen::Vector2d corner(resolution.width - 1 - k(2), resolution.height - 1 - k(3));
  Value radius = Value::Array();
  Value shift = Value::Array();
  for (int i = 0; i <= kNumPoints; ++i) {
    const Eigen::Vector2d straight = corner * i / kNumPoints;
    const auto pixel = model.Project({straight.x() / k(0), straight.y() / k(1), 1.0});
    if (!pixel) break;
    radius.Append(std::round(1e2 * straight.norm()) / 1e2);
    shift.Append(std::round(1e3 * ((*pixel - k.tail<2>()).norm() - straight.norm())) / 1e3);
  }
  Value curve = Value::Object();
  curve.Set("radius_px", std::move(radius)).Set("shift_px", std::move(shift));
  return curve;
}

Value LensCurve(const CameraModel& model, Resolution resolution) {
  constexpr int kNumPoints = 90;
  const Eigen::Vector2d centre = model.focal_and_centre().tail<2>();
  const Eigen::Vector2d far(centre.x() < 0.5 * resolution.width ? resolution.width - 1 : 0,
                            centre.y() < 0.5 * resolution.height ? resolution.height - 1 : 0);
  const Eigen::Vector2d towards = (far - centre).normalized();
  const double end_px = (far - centre).norm();
  Value angles = Value::Array();
  Value radii = Value::Array();
  for (int i = 0; i <= kNumPoints; ++i) {
    const double radius = end_px * i / kNumPoints;
    const auto ray = model.Unproject(centre + radius * towards);
    if (!ray) break;
    angles.Append(std::round(1e5 * std::atan2(ray->head<2>().norm(), ray->z())) / 1e5);
    radii.Append(Hundredths(radius));
  }
  Value curve = Value::Object();
  curve.Set("angle_rad", std::move(angles)).Set("radius_px", std::move(radii));
  return curve;
}

Value StraightenedView(const CameraModel& model, const std::vector<BoardView>& views) {
  std::vector<const BoardView*> by_size;
  for (const BoardView& view : views) by_size.push_back(&view);
  std::stable_sort(by_size.begin(), by_size.end(), [](const BoardView* a, const BoardView* b) {
    return AreaOfBox(a->pixels) > AreaOfBox(b->pixels);
  });
  for (const BoardView* view : by_size) {
    const auto straightened = Straightened(model, view->pixels);
    if (!straightened) continue;
    Value value = Value::Object();
    value.Set("name", view->name)
        .Set("pixels", Pairs(view->pixels))
        .Set("straightened", Pairs(*straightened))
        .Set("lines", LinesOfBoard(view->points_g));
    return value;
  }
  return {};
}

Value RejectedCornerMarks(const std::vector<RejectedCorner>& corners) {
  Value value = Value::Array();
  for (size_t k = 0; k < std::min(corners.size(), kMostRejectedCorners); ++k) {
    Value entry = Value::Object();
    entry.Set("view", corners[k].view)
        .Set("pixel", Pair(corners[k].pixel))
        .Set("residual", Pair(corners[k].residual));
    value.Append(std::move(entry));
  }
  return value;
}

}  // namespace calibrato
