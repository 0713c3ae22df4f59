#include "calibrato/simulation/fast_simulation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calibrato/motion/arm_clearance.h"
#include "calibrato/simulation/frame_exposure.h"
#include "calibrato/simulation/swaying_board.h"

namespace calibrato {
namespace {

// What a frame shows of the board.
struct SeenCorners {
  Rigid3 T_c0_g;
  std::vector<int> ids;
  Eigen::Matrix2Xd pixels;
};

// Camera 0 on its way: where it sees corners.
class CornerCamera {
 public:
  CornerCamera(const Rig& rig, const CarrierPath& path)
      : rig_(rig),
        path_(path),
        camera_(rig.cameras.front()),
        residual_(rig.lens_residual, camera_.resolution),
        points_g_(BoardPoints(rig.board)),
        neighbours_(NeighbouringPoints(rig.board)),
        points_per_part_(PointsPerPart(rig.board)) {
    if (rig.finger_reach_m == 0.0 || !path.joints) return;
    const Capsule finger_e = RightFinger(rig);
    const Rigid3 T_c0_e = rig.T_e_c0.Inverse();
    finger_c0_ = Capsule{T_c0_e * finger_e.a, T_c0_e * finger_e.b, finger_e.radius_m};
  }

  const Eigen::Matrix3Xd& points_g() const { return points_g_; }

  // All corners of a board that is read as a whole, or those of the parts of one that is not;
  // nothing if too few are in the image.
  [[nodiscard]] std::optional<SeenCorners> See(double t_s) const {
    const Rigid3 T_c_g = BoardInCamera(rig_, path_, t_s);
    Eigen::Matrix2Xd pixels(2, points_g_.cols());
    std::vector<int> ids;
    for (Eigen::Index first = 0; first < points_g_.cols(); first += points_per_part_) {
      bool is_inside = true;
      for (Eigen::Index k = first; is_inside && k < first + points_per_part_; ++k) {
        const auto pixel = PixelOf(T_c_g, k, t_s);
        is_inside = pixel && pixel->x() >= 0.0 && pixel->y() >= 0.0 &&
                    pixel->x() <= camera_.resolution.width - 1 &&
                    pixel->y() <= camera_.resolution.height - 1;
        if (is_inside) pixels.col(k) = *pixel;
      }
      for (Eigen::Index k = first; is_inside && k < first + points_per_part_; ++k) {
        ids.push_back(static_cast<int>(k));
      }
    }
    constexpr size_t kFewest = 4;  // determine a pose
    if (ids.size() < kFewest) return std::nullopt;
    return SeenCorners{T_c_g, ids, Eigen::Matrix2Xd(pixels(Eigen::all, ids))};
  }

  // Mean way of these corners during an exposure [px]; nothing where one leaves the lens's domain.
  [[nodiscard]] std::optional<double> BlurLength(const SeenCorners& seen,
                                                 const FrameExposure& exposure) const {
    if (exposure.length_s == 0.0) return 0.0;
    const double half_s = 0.5 * exposure.length_s;
    const Rigid3 first = BoardInCamera(rig_, path_, exposure.middle_s - half_s);
    const Rigid3 last = BoardInCamera(rig_, path_, exposure.middle_s + half_s);
    double sum = 0.0;
    for (const int k : seen.ids) {
      const auto a = camera_.model.Project(first * points_g_.col(k));
      const auto b = camera_.model.Project(last * points_g_.col(k));
      if (!a || !b) return std::nullopt;
      sum += (*b - *a).norm();
    }
    return sum / static_cast<double>(seen.ids.size());
  }

  // Mean distance of neighbouring corners that are both seen [px]; infinity without any.
  [[nodiscard]] double CornerSpacing(const SeenCorners& seen) const {
    std::vector<int> place(static_cast<size_t>(points_g_.cols()), -1);
    for (size_t i = 0; i < seen.ids.size(); ++i) place[seen.ids[i]] = static_cast<int>(i);
    double sum = 0.0;
    double count = 0.0;
    for (const auto& [a, b] : neighbours_) {
      if (place[a] < 0 || place[b] < 0) continue;
      sum += (seen.pixels.col(place[b]) - seen.pixels.col(place[a])).norm();
      count += 1.0;
    }
    return count > 0.0 ? sum / count : std::numeric_limits<double>::infinity();
  }

 private:
  [[nodiscard]] std::optional<Eigen::Vector2d> PixelOf(const Rigid3& T_c_g, Eigen::Index k,
                                                       double t_s) const {
    const Eigen::Vector3d p_c0 = T_c_g * points_g_.col(k);
    const Eigen::Vector3d eye = Eigen::Vector3d::Zero();
    // Camera and finger sit on one hand.
    if (finger_c0_ && Distance(Capsule{eye, p_c0, 0.0}, *finger_c0_) < 0.0) return std::nullopt;
    auto pixel = camera_.model.Project(p_c0);
    const double line_delay_s = rig_.image_disturbances.line_delay_s;
    // A point lies where the row that it falls on sees it: each pass leaves as much of the error as
    // a point moves, in rows, while one row is read.
    constexpr int kMaxPasses = 50;
    constexpr double kConverged = 1e-6;  // [px]
    double row = std::numeric_limits<double>::infinity();
    for (int i = 0; i < kMaxPasses && line_delay_s > 0.0 && pixel; ++i) {
      const double before = row;
      row = std::clamp(pixel->y(), 0.0, 1.0 * camera_.resolution.height);
      if (std::abs(row - before) < kConverged) break;
      pixel = camera_.model.Project(BoardInCamera(rig_, path_, t_s + line_delay_s * row) *
                                    points_g_.col(k));
    }
    if (pixel) *pixel += residual_.At(*pixel);
    return pixel;
  }

  const Rig& rig_;
  const CarrierPath& path_;
  const Camera& camera_;
  LensField residual_;
  Eigen::Matrix3Xd points_g_;
  std::vector<std::pair<int, int>> neighbours_;
  int points_per_part_;
  std::optional<Capsule> finger_c0_;  // none where it is out of the way, or there is no arm
};

void AddPhaseError(double amplitude_px, Eigen::Matrix2Xd* pixels) {
  if (amplitude_px == 0.0) return;
  pixels->array() += amplitude_px * (2.0 * std::numbers::pi * pixels->array()).sin();
}

}  // namespace

Rigid3 BoardInCamera(const Rig& rig, const Rigid3& T_b_e) {
  return (ArmBaseInWorld() * T_b_e * rig.T_e_c0).Inverse() * rig.T_w_g;
}

SimulatedFrames SimulateFrames(const Rig& rig, const TimedMotion& motion, Time start, Rng& rng) {
  return SimulateFrames(rig, PlannedPath(motion), start, rng);
}

SimulatedFrames SimulateFrames(const Rig& rig, const CarrierPath& path, Time start, Rng& rng) {
  const CornerCamera camera(rig, path);
  const CornerNoise& noise = rig.corner_noise;
  const Duration end = Duration::FromSeconds(path.duration_s);

  SimulatedFrames frames;
  for (int frame = 0;; ++frame) {
    const Duration elapsed = Duration::FromSeconds(frame / rig.camera_rate_hz);
    if (!(elapsed < end)) break;
    ++frames.num_frames;
    const FrameExposure exposure = ExposureOfFrame(rig, elapsed.seconds());
    auto seen = camera.See(exposure.middle_s);
    const auto blur = seen ? camera.BlurLength(*seen, exposure) : std::optional<double>();
    if (!blur) {
      ++frames.num_out_of_image;
      continue;
    }
    // Drawn for every frame alike, so that one frame's fate does not change the next one's noise.
    const double detected = noise.DetectionProbability(*blur, camera.CornerSpacing(*seen));
    const bool found = rng.Uniform() < detected || exposure.length_s == 0.0;
    const double stddev = noise.Stddev(*blur);
    AddPhaseError(noise.phase_error_px, &seen->pixels);
    for (double& coordinate : seen->pixels.reshaped()) coordinate += stddev * rng.Normal();
    // In a stream of its own: jitter and drops change no corner.
    const ImageDisturbances& images = rig.image_disturbances;
    Rng arrival = rng.Stream("arrival", static_cast<uint64_t>(frame));
    if (arrival.Uniform() < images.drop_probability) {
      ++frames.num_dropped;
      continue;
    }
    if (!found) {
      ++frames.num_lost_to_blur;
      continue;
    }
    BoardView view;
    view.stamp = start + elapsed + Duration::FromSeconds(StampJitter(rig, arrival.Normal()));
    view.name = std::to_string(view.stamp.nanoseconds());
    view.points_g = camera.points_g()(Eigen::all, seen->ids);
    view.corner_ids = std::move(seen->ids);
    view.pixels = std::move(seen->pixels);
    frames.views.push_back(std::move(view));
    frames.T_c0_g.push_back(seen->T_c0_g);
  }
  return frames;
}

}  // namespace calibrato
