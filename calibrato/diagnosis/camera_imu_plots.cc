#include "calibrato/diagnosis/camera_imu_plots.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "calibrato/diagnosis/envelope.h"

namespace calibrato {
namespace {

constexpr int kNumPieces = 500;
constexpr size_t kMostOutliers = 500;
constexpr int kMostCorners = 1500;
constexpr int kMostPathPoints = 1200;
constexpr int kPointsAnAxis = 20;

Value Rounded(const std::vector<double>& numbers, double scale) {
  Value value = Value::Array();
  for (const double x : numbers) value.Append(std::round(scale * x) / scale);
  return value;
}

double MedianOf(std::vector<double> values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Adds how long each measurement came after the one before it.
void SetIntervals(const std::vector<double>& time_s, Value* value) {
  std::vector<double> intervals_ms;
  for (size_t k = 1; k < time_s.size(); ++k) {
    intervals_ms.push_back(1e3 * (time_s[k] - time_s[k - 1]));
  }
  const std::vector<double> later(time_s.begin() + (time_s.empty() ? 0 : 1), time_s.end());
  value->Set("interval_ms", Envelope(later, intervals_ms, kNumPieces))
      .Set("median_interval_ms", MedianOf(intervals_ms));
}

Value SensorValue(const std::vector<VectorSample>& samples,
                  const std::vector<Eigen::Vector3d>& residuals, const std::vector<bool>& inliers,
                  double stddev, const CameraImuState& state, size_t imu) {
  std::vector<double> time_s;
  for (const VectorSample& sample : samples) {
    time_s.push_back(TimeOfSample(state, imu, sample.stamp));
  }
  Value measured = Value::Array();
  Value predicted = Value::Array();
  Value left = Value::Array();
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> m(samples.size());
    std::vector<double> p(samples.size());
    std::vector<double> r(samples.size());
    for (size_t k = 0; k < samples.size(); ++k) {
      r[k] = residuals[k](axis);
      // Beyond the trajectory there is no residual, and no sample is to be drawn.
      m[k] = std::isfinite(r[k]) ? samples[k].value(axis) : r[k];
      p[k] = m[k] + r[k];
    }
    measured.Append(Envelope(time_s, m, kNumPieces));
    predicted.Append(Envelope(time_s, p, kNumPieces));
    left.Append(Envelope(time_s, r, kNumPieces));
  }
  Value outliers = Value::Array();
  for (size_t k = 0; k < samples.size() && outliers.size() < kMostOutliers; ++k) {
    if (inliers[k] || !residuals[k].allFinite()) continue;
    const Eigen::Vector3d& value = samples[k].value;
    outliers.Append(Rounded({time_s[k], value.x(), value.y(), value.z()}, 1e4));
  }
  Value value = Value::Object();
  value.Set("measured", std::move(measured))
      .Set("predicted", std::move(predicted))
      .Set("residual", std::move(left))
      .Set("stddev", stddev)
      .Set("outliers", std::move(outliers));
  SetIntervals(time_s, &value);
  return value;
}

Value ImuValue(const CameraImuReport& report, size_t n) {
  const CameraImuCalibration& calibration = report.calibration;
  const CameraImuState& state = *calibration.state;
  const ImuStream& stream = report.problem.imus[n].stream;
  const CameraImuWeights::Imu& weights = calibration.weights.imus[n];
  std::vector<double> time_s;
  Value gyro = Value::Array();
  Value accel = Value::Array();
  const std::vector<ImuBias>& biases = state.imus[n].biases;
  const size_t stride = (biases.size() + kNumPieces - 1) / kNumPieces;
  for (size_t k = 0; k < biases.size(); k += stride) {
    time_s.push_back(static_cast<double>(k) * state.block_duration_s());
    gyro.Append(Value::Numbers(biases[k].gyro));
    accel.Append(Value::Numbers(biases[k].accel));
  }
  Value value = Value::Object();
  value
      .Set("gyro", SensorValue(stream.gyro, calibration.residuals.gyro[n],
                               calibration.inliers.gyro[n], weights.gyro_stddev, state, n))
      .Set("accel", SensorValue(stream.accel, calibration.residuals.accel[n],
                                calibration.inliers.accel[n], weights.accel_stddev, state, n))
      .Set("bias_time_s", Rounded(time_s, 1e4))
      .Set("gyro_bias", std::move(gyro))
      .Set("accel_bias", std::move(accel))
      .Set("gyro_walk", weights.gyro_walk)
      .Set("accel_walk", weights.accel_walk);
  return value;
}

Value CameraValue(const CameraImuReport& report, size_t n) {
  const CameraImuCalibration& calibration = report.calibration;
  const std::vector<BoardView>& views = report.problem.cameras[n].views;
  const auto& residuals = calibration.residuals.corners_px[n];
  std::vector<double> time_s;
  std::vector<double> rms_px;
  int num_inliers = 0;
  for (size_t v = 0; v < views.size(); ++v) {
    time_s.push_back(TimeOfView(*calibration.state, n, views[v].stamp));
    double squared = 0.0;
    int count = 0;
    for (Eigen::Index k = 0; k < residuals[v].cols(); ++k) {
      if (!calibration.inliers.corners[n][v][static_cast<size_t>(k)]) continue;
      squared += residuals[v].col(k).squaredNorm();
      ++count;
    }
    num_inliers += count;
    rms_px.push_back(count > 0 ? std::sqrt(squared / count)
                               : std::numeric_limits<double>::quiet_NaN());
  }
  Value corners = Value::Array();
  const int stride = num_inliers / kMostCorners + 1;
  int number = 0;
  for (size_t v = 0; v < views.size(); ++v) {
    for (Eigen::Index k = 0; k < residuals[v].cols(); ++k) {
      if (!calibration.inliers.corners[n][v][static_cast<size_t>(k)]) continue;
      if (number++ % stride != 0) continue;
      corners.Append(Rounded({time_s[v], residuals[v](0, k), residuals[v](1, k)}, 1e3));
    }
  }
  Value value = Value::Object();
  value.Set("rms", Envelope(time_s, rms_px, kNumPieces))
      .Set("corner_residuals", std::move(corners));
  SetIntervals(time_s, &value);
  return value;
}

void SetTrajectory(const CameraImuState& state, Value* plots) {
  const double duration_s = state.T_g_i.duration_s();
  // Hands and arms need no more than 30 points a second.
  const int num_points = std::clamp(static_cast<int>(30.0 * duration_s), 2, kMostPathPoints);
  const Rigid3 T_i_c = state.cameras.front().T_c_i.Inverse();
  Value path = Value::Array();
  Value axes = Value::Array();
  for (int k = 0; k < num_points; ++k) {
    const Rigid3 T_g_i = state.T_g_i.PoseAt(duration_s * k / (num_points - 1));
    path.Append(Rounded({T_g_i.t.x(), T_g_i.t.y(), T_g_i.t.z()}, 1e4));
    if (k % kPointsAnAxis != 0) continue;
    const Rigid3 T_g_c = T_g_i * T_i_c;
    const Eigen::Vector3d forward = T_g_c.R.col(2);
    axes.Append(Rounded(
        {T_g_c.t.x(), T_g_c.t.y(), T_g_c.t.z(), forward.x(), forward.y(), forward.z()}, 1e4));
  }
  plots->Set("trajectory_g", std::move(path)).Set("axis_g", std::move(axes));
}

// Around all corners that were seen.
Value BoardOutline(const std::vector<BoardView>& views) {
  Eigen::Vector3d least = views.front().points_g.rowwise().minCoeff();
  Eigen::Vector3d largest = views.front().points_g.rowwise().maxCoeff();
  for (const BoardView& view : views) {
    least = least.cwiseMin(view.points_g.rowwise().minCoeff());
    largest = largest.cwiseMax(view.points_g.rowwise().maxCoeff());
  }
  Value outline = Value::Array();
  outline.Append(Rounded({least.x(), least.y(), 0.0}, 1e4))
      .Append(Rounded({largest.x(), least.y(), 0.0}, 1e4))
      .Append(Rounded({largest.x(), largest.y(), 0.0}, 1e4))
      .Append(Rounded({least.x(), largest.y(), 0.0}, 1e4));
  return outline;
}

Value KnowledgeValue(const std::vector<CameraImuKnowledge>& knowledge) {
  Value time = Value::Array();
  Value rotation = Value::Array();
  Value translation = Value::Array();
  Value time_offset = Value::Array();
  for (const CameraImuKnowledge& known : knowledge) {
    time.Append(known.time_s);
    rotation.Append(known.rotation_sigma_rad);
    translation.Append(known.translation_sigma_m);
    time_offset.Append(known.time_offset_sigma_s);
  }
  Value value = Value::Object();
  value.Set("time_s", std::move(time))
      .Set("rotation_sigma_rad", std::move(rotation))
      .Set("translation_sigma_m", std::move(translation))
      .Set("time_offset_sigma_s", std::move(time_offset));
  return value;
}

}  // namespace

Value CameraImuPlots(const CameraImuReport& report) {
  Value plots = Value::Object();
  if (!report.calibration.state) return plots;
  const CameraImuState& state = *report.calibration.state;
  Value imus = Value::Array();
  for (size_t n = 0; n < report.problem.imus.size(); ++n) imus.Append(ImuValue(report, n));
  Value cameras = Value::Array();
  for (size_t n = 0; n < report.problem.cameras.size(); ++n) {
    cameras.Append(CameraValue(report, n));
  }
  plots.Set("duration_s", state.T_g_i.duration_s())
      .Set("imus", std::move(imus))
      .Set("cameras", std::move(cameras))
      .Set("corner_noise_px", report.calibration.weights.corner_noise_px)
      .Set("board_outline_g", BoardOutline(report.problem.cameras.front().views))
      .Set("knowledge", KnowledgeValue(report.diagnosis.knowledge));
  SetTrajectory(state, &plots);
  return plots;
}

}  // namespace calibrato
