#include "calibrato/calibration/camera_imu_start.h"

#include <algorithm>
#include <cmath>

#include "calibrato/base/parallel.h"
#include "calibrato/calibration/gyro_turns.h"
#include "calibrato/calibration/outliers.h"
#include "calibrato/calibration/plane_pose.h"
#include "calibrato/calibration/rate_alignment.h"
#include "calibrato/calibration/suspects.h"
#include "calibrato/calibration/view_fit.h"
#include "calibrato/geometry/so3.h"

namespace calibrato {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kMargin = 0.05;  // [s]
// Another camera's pose is taken where the first had none for so long.
constexpr double kShortestGap = 0.2;  // [s]
constexpr double kPoseLossPx = 1.0;
constexpr int kPoseIterations = 8;
constexpr size_t kViewsInATask = 8;

// Poses of the board in a camera's views, on the camera's clock since `epoch`, and the squared
// errors of their corners.
struct BoardPoses {
  std::vector<TimedPose> T_c_g;
  std::vector<size_t> views;  // Which they are of.
  std::vector<double> squared_errors_px2;
};

BoardPoses FindBoardPoses(const CameraImuCamera& camera, Time epoch) {
  const size_t num_views = camera.views.size();
  std::vector<std::optional<Rigid3>> poses(num_views);
  std::vector<Eigen::Matrix2Xd> residuals(num_views);
  ParallelFor((num_views + kViewsInATask - 1) / kViewsInATask, [&](size_t task) {
    for (size_t v = task * kViewsInATask; v < std::min(num_views, (task + 1) * kViewsInATask);
         ++v) {
      const BoardView& view = camera.views[v];
      const auto start = PoseFromView(camera.model, view);
      if (!start) continue;
      const Rigid3 T_c_g = RefinedPose(camera.model, view, *start, kPoseIterations, kPoseLossPx);
      residuals[v] = ReprojectionResiduals(camera.model, view, T_c_g);
      if (residuals[v].allFinite()) poses[v] = T_c_g;
    }
  });
  BoardPoses result;
  for (size_t v = 0; v < num_views; ++v) {
    if (!poses[v]) continue;
    result.T_c_g.push_back({(camera.views[v].stamp - epoch).seconds(), *poses[v]});
    result.views.push_back(v);
    for (const double squared : residuals[v].colwise().squaredNorm()) {
      result.squared_errors_px2.push_back(squared);
    }
  }
  return result;
}

std::vector<RateInterval> RatesOf(const std::vector<TimedPose>& T_c_g) {
  std::vector<RateInterval> rates;
  for (size_t v = 1; v < T_c_g.size(); ++v) {
    const TimedPose& a = T_c_g[v - 1];
    const TimedPose& b = T_c_g[v];
    const double duration = b.time_s - a.time_s;
    if (!(duration > 0.0) || duration > kLongestViewInterval) continue;
    rates.push_back({a.time_s, b.time_s, LogSo3(a.pose.R * b.pose.R.transpose()) / duration});
  }
  return rates;
}

std::vector<RateSample> SamplesOf(const std::vector<VectorSample>& gyro,
                                  const std::vector<bool>& suspect, Time epoch) {
  std::vector<RateSample> samples;
  samples.reserve(gyro.size());
  for (size_t k = 0; k < gyro.size(); ++k) {
    if (!suspect[k]) samples.push_back({(gyro[k].stamp - epoch).seconds(), gyro[k].value});
  }
  return samples;
}

// A path through poses T_g_i at some times: turned by the gyroscope in between.
class StartPath {
 public:
  StartPath(std::vector<TimedPose> anchors, const GyroTurns& turns)
      : anchors_(std::move(anchors)), turns_(turns) {
    for (const TimedPose& anchor : anchors_) turns_at_anchors_.push_back(turns_.At(anchor.time_s));
  }

  Rigid3 operator()(double t_s) const {
    const auto after = std::partition_point(anchors_.begin(), anchors_.end(),
                                            [&](const TimedPose& a) { return a.time_s <= t_s; });
    const auto b = static_cast<size_t>(after - anchors_.begin());
    const size_t a = b == 0 ? 0 : b - 1;
    const Matrix3d turned = anchors_[a].pose.R * turns_at_anchors_[a].transpose() * turns_.At(t_s);
    if (b == 0 || b == anchors_.size()) return {turned, anchors_[a].pose.t};
    const double duration = anchors_[b].time_s - anchors_[a].time_s;
    const double u = (t_s - anchors_[a].time_s) / duration;
    // What the gyroscope missed between two poses is shared out evenly.
    const Matrix3d turned_b =
        anchors_[a].pose.R * turns_at_anchors_[a].transpose() * turns_at_anchors_[b];
    const Vector3d missing = LogSo3(turned_b.transpose() * anchors_[b].pose.R);
    return {turned * ExpSo3(u * missing), PositionAt(a, b, u, duration)};
  }

 private:
  // A cubic with the slopes of its neighbours; a straight line through gaps.
  Vector3d PositionAt(size_t a, size_t b, double u, double duration) const {
    const Vector3d& p = anchors_[a].pose.t;
    const Vector3d& q = anchors_[b].pose.t;
    if (duration > kLongestViewInterval) return (1.0 - u) * p + u * q;
    const auto slope = [&](size_t k) -> Vector3d {
      const size_t before = k == 0 ? 0 : k - 1;
      const size_t after = std::min(k + 1, anchors_.size() - 1);
      const double time = anchors_[after].time_s - anchors_[before].time_s;
      if (time > 2.0 * kLongestViewInterval) return (q - p) / duration;
      return (anchors_[after].pose.t - anchors_[before].pose.t) / time;
    };
    const double v = 1.0 - u;
    return v * v * (1.0 + 2.0 * u) * p + u * u * (1.0 + 2.0 * v) * q +
           duration * u * v * (v * slope(a) - u * slope(b));
  }

  std::vector<TimedPose> anchors_;
  const GyroTurns& turns_;
  std::vector<Matrix3d> turns_at_anchors_;
};

// Erases the poses of suspect views, and says which views these are.
std::vector<bool> TakeOutSuspects(const CameraCalibrationState& camera, const GyroTurns& turns,
                                  size_t num_views, BoardPoses* poses) {
  std::vector<TimedPose> on_imu_clock = poses->T_c_g;
  for (TimedPose& pose : on_imu_clock) pose.time_s += camera.time_offset_s;
  const std::vector<bool> suspect = FindSuspectViews(on_imu_clock, camera.T_c_i.R, turns);
  std::vector<bool> suspect_views(num_views, false);
  BoardPoses kept;
  for (size_t k = 0; k < suspect.size(); ++k) {
    if (suspect[k]) {
      suspect_views[poses->views[k]] = true;
    } else {
      kept.T_c_g.push_back(poses->T_c_g[k]);
      kept.views.push_back(poses->views[k]);
    }
  }
  poses->T_c_g = std::move(kept.T_c_g);
  poses->views = std::move(kept.views);
  return suspect_views;
}

// Poses T_g_i on the IMU's clock: camera 0's, and others' where those leave a gap.
std::vector<TimedPose> PosesOfImu(const std::vector<BoardPoses>& poses,
                                  const std::vector<CameraCalibrationState>& cameras) {
  std::vector<TimedPose> anchors;
  for (size_t n = 0; n < poses.size(); ++n) {
    const Rigid3& T_c_i = cameras[n].T_c_i;
    const std::vector<TimedPose> before = anchors;
    for (const TimedPose& T_c_g : poses[n].T_c_g) {
      const double t = T_c_g.time_s + cameras[n].time_offset_s;
      const auto after = std::partition_point(before.begin(), before.end(),
                                              [&](const TimedPose& a) { return a.time_s < t; });
      const bool near_after = after != before.end() && after->time_s - t < kShortestGap;
      const bool near_before = after != before.begin() && t - (after - 1)->time_s < kShortestGap;
      if (!near_after && !near_before) anchors.push_back({t, T_c_g.pose.Inverse() * T_c_i});
    }
    std::stable_sort(anchors.begin(), anchors.end(),
                     [](const TimedPose& a, const TimedPose& b) { return a.time_s < b.time_s; });
  }
  // Two views of one stamp are one too many.
  const auto last =
      std::unique(anchors.begin(), anchors.end(),
                  [](const TimedPose& a, const TimedPose& b) { return !(b.time_s > a.time_s); });
  anchors.erase(last, anchors.end());
  return anchors;
}

// Why a camera's rates could not be aligned with those of the gyroscope.
CameraImuNoStart::Reason WhyNotAligned(size_t num_poses, const std::vector<RateInterval>& rates,
                                       const std::vector<RateSample>& gyro, double max_offset_s) {
  using Reason = CameraImuNoStart::Reason;
  if (num_poses <= kMinRateIntervals) return Reason::kNoBoardPoses;
  if (rates.size() < kMinRateIntervals) return Reason::kViewsFarApart;
  return MostCoveredIntervals(rates, gyro, max_offset_s) < kMinRateIntervals ? Reason::kNoSharedTime
                                                                             : Reason::kNoTurning;
}

}  // namespace

std::variant<CameraImuStart, CameraImuNoStart> FindCameraImuStart(const CameraImuProblem& problem,
                                                                  const CameraImuOptions& options,
                                                                  double knot_spacing_s) {
  using Reason = CameraImuNoStart::Reason;
  const ImuStream& stream = problem.imus.front().stream;
  if (stream.gyro.size() < 2) return CameraImuNoStart{Reason::kNoSharedTime, 0};
  const Time epoch = stream.gyro.front().stamp;
  CameraImuSuspects suspects;
  for (const CameraImuImu& imu : problem.imus) {
    suspects.gyro.push_back(FindSuspectSamples(imu.stream.gyro));
    suspects.accel.push_back(FindSuspectSamples(imu.stream.accel));
  }
  const std::vector<RateSample> gyro = SamplesOf(stream.gyro, suspects.gyro[0], epoch);

  std::vector<BoardPoses> poses;
  std::vector<CameraCalibrationState> cameras;
  ImuBias bias;
  std::vector<double> squared_errors;
  for (size_t n = 0; n < problem.cameras.size(); ++n) {
    const CameraImuCamera& camera = problem.cameras[n];
    poses.push_back(FindBoardPoses(camera, epoch));
    squared_errors.insert(squared_errors.end(), poses.back().squared_errors_px2.begin(),
                          poses.back().squared_errors_px2.end());
    if (problem.prior) {
      cameras.push_back(problem.prior->estimate.cameras[n]);
      if (poses.back().T_c_g.empty()) return CameraImuNoStart{Reason::kNoBoardPoses, n};
      continue;
    }
    const std::vector<RateInterval> rates = RatesOf(poses.back().T_c_g);
    const double max_offset_s = problem.estimate_time_offsets ? options.max_time_offset_s : 0.0;
    const auto alignment = AlignRates(rates, gyro, max_offset_s);
    if (!alignment) {
      return CameraImuNoStart{WhyNotAligned(poses.back().T_c_g.size(), rates, gyro, max_offset_s),
                              n};
    }
    cameras.push_back(
        {camera.model, {alignment->R_c_i, Vector3d::Zero()}, alignment->time_offset_s});
    if (n == 0) bias.gyro = alignment->gyro_bias;
  }
  if (problem.prior) bias = problem.prior->estimate.imus.front().biases.back();
  const GyroTurns turns(gyro, bias.gyro);
  for (size_t n = 0; n < poses.size(); ++n) {
    suspects.views.push_back(
        TakeOutSuspects(cameras[n], turns, problem.cameras[n].views.size(), &poses[n]));
  }
  const std::vector<TimedPose> anchors = PosesOfImu(poses, cameras);
  const StartPath path(anchors, turns);

  const double begin = std::max({anchors.front().time_s - kMargin, gyro.front().time_s,
                                 (stream.accel.front().stamp - epoch).seconds()});
  const double end = std::min({anchors.back().time_s + kMargin, gyro.back().time_s,
                               (stream.accel.back().stamp - epoch).seconds()});
  if (!(end - begin > 2.0 * knot_spacing_s)) return CameraImuNoStart{Reason::kNoSharedTime, 0};
  // Whole nanoseconds, so that the spline's time 0 is a stamp.
  const Time start = epoch + Duration::FromSeconds(begin);
  const double duration = end - begin;
  const double start_s = (start - epoch).seconds();
  CameraImuStart result{
      .state = StateAlong([&](double t_s) { return path(start_s + t_s); }, start, duration,
                          knot_spacing_s, options.spline_order, Vector3d::Zero(),
                          std::move(cameras), problem.imus.size()),
      .corner_noise_px = std::max(1e-6, NoiseFromMedian(std::move(squared_errors))),
      .suspects = std::move(suspects),
  };
  CameraImuState& state = result.state;
  Vector3d force_g = Vector3d::Zero();
  for (size_t k = 0; k < stream.accel.size(); ++k) {
    const double t = (stream.accel[k].stamp - start).seconds();
    if (result.suspects.accel[0][k] || !(t >= 0.0 && t <= duration)) continue;
    force_g += state.T_g_i.PoseAt(t).R * stream.accel[k].value;
  }
  state.gravity_g = problem.prior ? problem.prior->estimate.gravity_g
                                  : Vector3d(-problem.gravity * force_g.normalized());

  const auto num_knots = static_cast<size_t>(state.num_blocks());
  const double spacing = state.T_g_i.spacing_s();
  for (size_t n = 0; n < problem.imus.size(); ++n) {
    ImuCalibrationState& imu = state.imus[n];
    if (problem.prior) {
      imu = problem.prior->estimate.imus[n];
      bias = imu.biases.back();
    } else if (n > 0) {
      // The first IMU takes the camera's part.
      std::vector<RateInterval> rates;
      for (double t = 0.0; t + spacing < duration; t += spacing) {
        const Matrix3d R = state.T_g_i.PoseAt(t).R;
        const Matrix3d R_next = state.T_g_i.PoseAt(t + spacing).R;
        rates.push_back({t, t + spacing, LogSo3(R.transpose() * R_next) / spacing});
      }
      const auto alignment =
          AlignRates(rates, SamplesOf(problem.imus[n].stream.gyro, result.suspects.gyro[n], start),
                     options.max_time_offset_s);
      if (!alignment) return CameraImuNoStart{Reason::kOtherImu, n};
      imu.T_i_imu.R = alignment->R_c_i;
      imu.time_offset_s = -alignment->time_offset_s;
      bias = {alignment->gyro_bias, Vector3d::Zero()};
    }
    imu.biases.assign(num_knots, bias);
  }
  return result;
}

}  // namespace calibrato
