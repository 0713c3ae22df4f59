#include "calibrato/simulation/fast_simulation.h"

#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace calibrato {
namespace {

// Pixels of all corners, or nothing if one lies outside the image.
std::optional<Eigen::Matrix2Xd> VisibleCorners(const Camera& camera, const Rigid3& T_c_g,
                                               const Eigen::Matrix3Xd& points_g) {
  Eigen::Matrix2Xd pixels(2, points_g.cols());
  for (Eigen::Index k = 0; k < points_g.cols(); ++k) {
    const auto pixel = camera.model.Project(T_c_g * points_g.col(k));
    const bool inside = pixel && pixel->x() >= 0.0 && pixel->y() >= 0.0 &&
                        pixel->x() <= camera.resolution.width - 1 &&
                        pixel->y() <= camera.resolution.height - 1;
    if (!inside) return std::nullopt;
    pixels.col(k) = *pixel;
  }
  return pixels;
}

// Mean way of the corners during the exposure [px]; nothing where one leaves the lens's domain.
std::optional<double> BlurLength(const Rig& rig, const CarrierPath& path, double t_s,
                                 const Eigen::Matrix3Xd& points_g) {
  if (rig.exposure_s == 0.0) return 0.0;
  const CameraModel& lens = rig.cameras.front().model;
  const Rigid3 first = BoardInCamera(rig, path.at(t_s - 0.5 * rig.exposure_s).T_b_e);
  const Rigid3 last = BoardInCamera(rig, path.at(t_s + 0.5 * rig.exposure_s).T_b_e);
  double sum = 0.0;
  for (Eigen::Index k = 0; k < points_g.cols(); ++k) {
    const auto a = lens.Project(first * points_g.col(k));
    const auto b = lens.Project(last * points_g.col(k));
    if (!a || !b) return std::nullopt;
    sum += (*b - *a).norm();
  }
  return sum / static_cast<double>(points_g.cols());
}

// Mean distance of neighbouring corners [px].
double CornerSpacing(const Eigen::Matrix2Xd& pixels,
                     const std::vector<std::pair<int, int>>& neighbours) {
  double sum = 0.0;
  for (const auto& [a, b] : neighbours) sum += (pixels.col(b) - pixels.col(a)).norm();
  return sum / static_cast<double>(neighbours.size());
}

}  // namespace

Rigid3 BoardInCamera(const Rig& rig, const Rigid3& T_b_e) {
  return (ArmBaseInWorld() * T_b_e * rig.T_e_c0).Inverse() * rig.T_w_g;
}

SimulatedFrames SimulateFrames(const Rig& rig, const TimedMotion& motion, Time start, Rng& rng) {
  return SimulateFrames(rig, PlannedPath(motion), start, rng);
}

SimulatedFrames SimulateFrames(const Rig& rig, const CarrierPath& path, Time start, Rng& rng) {
  const Camera& camera = rig.cameras.front();
  const Eigen::Matrix3Xd points_g = BoardPoints(rig.board);
  const std::vector<std::pair<int, int>> neighbours = NeighbouringPoints(rig.board);
  const CornerNoise& noise = rig.corner_noise;
  const Duration end = Duration::FromSeconds(path.duration_s);

  SimulatedFrames frames;
  for (int frame = 0;; ++frame) {
    const Duration elapsed = Duration::FromSeconds(frame / rig.camera_rate_hz);
    if (!(elapsed < end)) break;
    ++frames.num_frames;
    const Rigid3 T_c0_g = BoardInCamera(rig, path.at(elapsed.seconds()).T_b_e);
    auto pixels = VisibleCorners(camera, T_c0_g, points_g);
    const auto blur =
        pixels ? BlurLength(rig, path, elapsed.seconds(), points_g) : std::optional<double>();
    if (!blur) {
      ++frames.num_out_of_image;
      continue;
    }
    // Drawn for every frame alike, so that one frame's fate does not change the next one's noise.
    const double smear = *blur / CornerSpacing(*pixels, neighbours);
    const double detected = 1.0 / (1.0 + std::exp((smear - noise.blur_at_half) / noise.blur_slope));
    const bool found = rng.Uniform() < detected || rig.exposure_s == 0.0;
    const double stddev = noise.Stddev(*blur);
    for (double& coordinate : pixels->reshaped()) coordinate += stddev * rng.Normal();
    if (!found) {
      ++frames.num_lost_to_blur;
      continue;
    }
    BoardView view;
    view.stamp = start + elapsed;
    view.name = std::to_string(view.stamp.nanoseconds());
    for (int k = 0; k < points_g.cols(); ++k) view.corner_ids.push_back(k);
    view.pixels = std::move(*pixels);
    view.points_g = points_g;
    frames.views.push_back(std::move(view));
    frames.T_c0_g.push_back(T_c0_g);
  }
  return frames;
}

}  // namespace calibrato
