#include "calibrato/guide/gesture_choice.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "calibrato/base/parallel.h"
#include "calibrato/calibration/expected_extrinsics.h"
#include "calibrato/calibration/planned_frame.h"
#include "calibrato/geometry/so3.h"

namespace calibrato {
namespace {

constexpr double kImuRate = 50.0;    // Instants a second that stand for all samples.
constexpr double kFrameRate = 10.0;  // Likewise for frames.
constexpr double kStep = 1e-3;       // Of differences in time [s].
constexpr double kMargin = 2.0;      // Of the board inside the image [px].
constexpr double kHalfMinute = 30.0;
constexpr double kLeastGain = 0.95;

struct Instant {
  Rigid3 T_g_i;
  Eigen::Vector3d omega_i;
  Eigen::Vector3d velocity_g;
  Eigen::Vector3d force_i;
};

Instant InstantAt(const Gesture& gesture, const LiveEstimate& estimate, double t_s) {
  // Differences must not look over the ends, where poses stand still.
  const double t = std::clamp(t_s, kStep, gesture.duration_s - kStep);
  const auto pose = [&](double at) { return PoseAt(gesture, at) * estimate.T_c_i; };
  const Rigid3 before = pose(t - kStep);
  const Rigid3 after = pose(t + kStep);
  Instant instant;
  instant.T_g_i = pose(t);
  instant.omega_i = LogSo3(before.R.transpose() * after.R) / (2.0 * kStep);
  instant.velocity_g = (after.t - before.t) / (2.0 * kStep);
  const Eigen::Vector3d accel_g = (after.t - 2.0 * instant.T_g_i.t + before.t) / (kStep * kStep);
  instant.force_i = instant.T_g_i.R.transpose() * (accel_g - estimate.gravity_g);
  return instant;
}

// What is left of the sigma that falls most, of those that are not reached: 1 for all of it.
double BestShare(const std::vector<ParameterProgress>& before,
                 const std::vector<ParameterProgress>& after) {
  double best = 1.0;
  for (size_t k = 0; k < before.size(); ++k) {
    if (!before[k].is_reached()) best = std::min(best, after[k].sigma / before[k].sigma);
  }
  return best;
}

// What is known and how far that is from what is wanted, gesture by gesture of a plan.
class Prospect {
 public:
  Prospect(const GuideProblem& problem, const LiveEstimate& estimate,
           const std::vector<Gesture>& gestures, const GesturePlanOptions& options)
      : problem_(problem),
        estimate_(estimate),
        gestures_(gestures),
        options_(options),
        expected_(ParallelMap<Eigen::MatrixXd>(
            gestures.size(),
            [&](size_t k) {
              return ExpectFromGesture(problem, estimate, gestures[k], options.camera_rate_hz);
            })),
        known_(estimate.information),
        progress_(estimate.progress) {}

  [[nodiscard]] double TimeOf(size_t k) const { return gestures_[k].duration_s + options_.way_s; }
  // Of the distance that is left, what may be counted on a second.
  [[nodiscard]] double RateOf(size_t k) const {
    const auto trust = options_.trust.find(gestures_[k].name);
    const double gain = DistanceFromWanted(progress_) - DistanceFromWanted(ProgressWith(k));
    return (trust == options_.trust.end() ? 1.0 : trust->second) * gain / TimeOf(k);
  }
  [[nodiscard]] bool is_reached() const {
    return std::all_of(progress_.begin(), progress_.end(),
                       [](const ParameterProgress& parameter) { return parameter.is_reached(); });
  }
  void Add(size_t k, GuidePlan* plan) {
    progress_ = ProgressWith(k);
    known_ += expected_[k];
    plan->gestures.push_back(gestures_[k]);
    plan->time_left_s += TimeOf(k);
    if (is_judged_ || is_reached() || plan->time_left_s < kHalfMinute) return;
    is_judged_ = true;
    plan->more_helps = BestShare(estimate_.progress, progress_) < kLeastGain;
  }

 private:
  [[nodiscard]] std::vector<ParameterProgress> ProgressWith(size_t k) const {
    return ProgressOf(known_ + expected_[k], LayoutOf(problem_), estimate_.camera, problem_.wanted);
  }

  const GuideProblem& problem_;
  const LiveEstimate& estimate_;
  const std::vector<Gesture>& gestures_;
  const GesturePlanOptions& options_;
  std::vector<Eigen::MatrixXd> expected_;
  Eigen::MatrixXd known_;
  std::vector<ParameterProgress> progress_;
  bool is_judged_ = false;
};

}  // namespace

Eigen::MatrixXd ExpectFromGesture(const GuideProblem& problem, const LiveEstimate& estimate,
                                  const Gesture& gesture, double camera_rate_hz) {
  const KnowledgeLayout layout = LayoutOf(problem);
  const int num_frames = std::max(3, static_cast<int>(kFrameRate * gesture.duration_s));
  const double weight = camera_rate_hz * gesture.duration_s / num_frames;
  const double variance = estimate.corner_noise_px * estimate.corner_noise_px;
  Eigen::MatrixXd camera_alone = Eigen::MatrixXd::Zero(layout.size(), layout.size());
  PlannedMotion motion;
  motion.duration_s = gesture.duration_s;
  for (int k = 0; k < num_frames; ++k) {
    const double t = gesture.duration_s * (k + 0.5) / num_frames;
    const Rigid3 T_c_g = PoseAt(gesture, t).Inverse();
    if (!(MarginInImage(estimate.camera, problem.resolution, problem.points, T_c_g) >= kMargin)) {
      continue;
    }
    if (!layout.has_imu) {
      const auto information = CameraInformationOfFrame(estimate.camera, problem.points, T_c_g);
      if (information) camera_alone += weight / variance * *information;
      continue;
    }
    const Instant instant = InstantAt(gesture, estimate, t);
    motion.frames.push_back({t, weight, T_c_g, instant.omega_i, instant.velocity_g});
  }
  if (!layout.has_imu) return camera_alone;
  const int num_samples = static_cast<int>(std::ceil(kImuRate * gesture.duration_s));
  for (int k = 0; k < num_samples; ++k) {
    const double t = gesture.duration_s * (k + 0.5) / num_samples;
    const Instant instant = InstantAt(gesture, estimate, t);
    motion.imu.push_back(
        {t, gesture.duration_s / num_samples, instant.T_g_i.R, instant.omega_i, instant.force_i});
  }
  return ExtrinsicInformationOf({estimate.camera, problem.points, estimate.corner_noise_px,
                                 estimate.T_c_i, *problem.imu, estimate.gravity_g},
                                motion, problem.known_camera.has_value());
}

GuidePlan PlanGestures(const GuideProblem& problem, const LiveEstimate& estimate,
                       const std::vector<Gesture>& gestures, const GesturePlanOptions& options) {
  GuidePlan plan;
  plan.is_reached = estimate.is_reached();
  if (plan.is_reached || gestures.empty()) return plan;
  Prospect prospect(problem, estimate, gestures, options);
  for (int step = 0; step < options.max_gestures && !prospect.is_reached(); ++step) {
    double best_rate = 0.0;
    size_t best = gestures.size();
    for (size_t k = 0; k < gestures.size(); ++k) {
      const double rate = prospect.RateOf(k);
      if (!(rate > best_rate)) continue;
      best_rate = rate;
      best = k;
    }
    if (best == gestures.size()) break;
    prospect.Add(best, &plan);
  }
  if (plan.gestures.empty()) plan.more_helps = false;
  return plan;
}

GuidePlan PlanInOrder(const GuideProblem& problem, const LiveEstimate& estimate,
                      const std::vector<Gesture>& gestures, size_t first,
                      const GesturePlanOptions& options) {
  GuidePlan plan;
  plan.is_in_order = true;
  plan.is_reached = estimate.is_reached();
  if (plan.is_reached || gestures.empty()) return plan;
  Prospect prospect(problem, estimate, gestures, options);
  for (int step = 0; step < options.max_gestures && !prospect.is_reached(); ++step) {
    prospect.Add((first + static_cast<size_t>(step)) % gestures.size(), &plan);
  }
  return plan;
}

}  // namespace calibrato
