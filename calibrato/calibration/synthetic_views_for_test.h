#pragma once

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "calibrato/base/rng.h"
#include "calibrato/geometry/so3.h"
#include "calibrato/sensors/board.h"
#include "calibrato/sensors/camera_model.h"
#include "calibrato/sensors/measurements.h"

namespace calibrato {

/// Views of a board from poses drawn at random around one at 1 m: shifted by up to 0.2 m and 0.15
/// m, 0.7 to 1.3 m away, tilted by up to 0.6 rad. Corners of one view all lie inside the image.
inline std::vector<BoardView> SyntheticViews(const CameraModel& model, Resolution resolution,
                                             const Board& board, int num_views,
                                             double noise_stddev_px, Rng& rng) {
  const Eigen::Matrix3Xd points = BoardPoints(board);
  const Eigen::Vector3d centre = BoardCentre(board);
  std::vector<BoardView> views;
  while (static_cast<int>(views.size()) < num_views) {
    // The board's z points at the viewer: half a turn about x.
    const Eigen::Vector3d tilt(rng.Uniform(-0.6, 0.6), rng.Uniform(-0.6, 0.6),
                               rng.Uniform(-0.6, 0.6));
    const Eigen::Matrix3d R = ExpSo3(tilt) * ExpSo3({3.14159265, 0.0, 0.0});
    const Eigen::Vector3d middle(rng.Uniform(-0.35, 0.35), rng.Uniform(-0.25, 0.25),
                                 rng.Uniform(0.7, 1.3));
    const Rigid3 T_c_g{R, middle - R * centre};
    BoardView view;
    view.name = std::to_string(views.size());
    view.points_g = points;
    view.pixels.resize(2, points.cols());
    bool inside = true;
    for (Eigen::Index k = 0; k < points.cols() && inside; ++k) {
      const auto pixel = model.Project(T_c_g * points.col(k));
      inside = pixel && pixel->minCoeff() > 0.0 && pixel->x() < resolution.width - 1 &&
               pixel->y() < resolution.height - 1;
      if (!inside) break;
      view.corner_ids.push_back(static_cast<int>(k));
      view.pixels.col(k) = *pixel + noise_stddev_px * Eigen::Vector2d(rng.Normal(), rng.Normal());
    }
    if (inside) views.push_back(std::move(view));
  }
  return views;
}

/// Views for lenses of any field of view: the board's middle in any direction up to max_angle off
/// the axis [rad], 0.3 to 0.9 m away, facing the camera up to a tilt of 0.6 rad about any axis and
/// a roll of 0.6 rad. Corners outside the image or the lens's field are not seen; views of less
/// than two thirds of the board are left out.
inline std::vector<BoardView> SyntheticWideViews(const CameraModel& model, Resolution resolution,
                                                 const Board& board, double max_angle,
                                                 int num_views, double noise_stddev_px, Rng& rng) {
  const Eigen::Matrix3Xd points = BoardPoints(board);
  const Eigen::Vector3d centre = BoardCentre(board);
  std::vector<BoardView> views;
  while (static_cast<int>(views.size()) < num_views) {
    const double angle = rng.Uniform(0.0, max_angle);
    const double side = rng.Uniform(-3.14159265, 3.14159265);
    const Eigen::Vector3d off_axis(-angle * std::sin(side), angle * std::cos(side), 0.0);
    const Eigen::Vector3d tilt(rng.Uniform(-0.6, 0.6), rng.Uniform(-0.6, 0.6),
                               rng.Uniform(-0.6, 0.6));
    const Eigen::Matrix3d aim = ExpSo3(off_axis);
    const Eigen::Matrix3d R = aim * ExpSo3(tilt) * ExpSo3({3.14159265, 0.0, 0.0});
    const Rigid3 T_c_g{R, aim.col(2) * rng.Uniform(0.3, 0.9) - R * centre};
    BoardView view;
    view.name = std::to_string(views.size());
    std::vector<Eigen::Vector2d> pixels;
    for (Eigen::Index k = 0; k < points.cols(); ++k) {
      const auto pixel = model.Project(T_c_g * points.col(k));
      const bool inside = pixel && pixel->minCoeff() > 0.0 && pixel->x() < resolution.width - 1 &&
                          pixel->y() < resolution.height - 1;
      if (!inside) continue;
      view.corner_ids.push_back(static_cast<int>(k));
      pixels.push_back(*pixel);
    }
    if (3 * pixels.size() < 2 * static_cast<size_t>(points.cols())) continue;
    view.pixels.resize(2, static_cast<Eigen::Index>(pixels.size()));
    view.points_g = points(Eigen::all, view.corner_ids);
    for (size_t k = 0; k < pixels.size(); ++k) {
      view.pixels.col(static_cast<Eigen::Index>(k)) =
          pixels[k] + noise_stddev_px * Eigen::Vector2d(rng.Normal(), rng.Normal());
    }
    views.push_back(std::move(view));
  }
  return views;
}

}  // namespace calibrato
