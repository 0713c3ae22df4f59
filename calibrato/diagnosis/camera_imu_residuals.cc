#include "calibrato/diagnosis/camera_imu_residuals.h"

#include <cassert>
#include <cmath>
#include <limits>

namespace calibrato {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

SensorResiduals SummariseSamples(const std::vector<VectorSample>& samples,
                                 const std::vector<Eigen::Vector3d>& residuals,
                                 const std::vector<bool>& inliers, double stddev,
                                 const CameraImuState& state, size_t imu) {
  SensorResiduals summary;
  double squared = 0.0;
  for (size_t k = 0; k < residuals.size(); ++k) {
    if (!residuals[k].allFinite()) continue;
    ++summary.num_samples;
    if (inliers[k]) {
      squared += residuals[k].squaredNorm();
      continue;
    }
    summary.outliers.push_back({samples[k].stamp, TimeOfSample(state, imu, samples[k].stamp)});
  }
  const int num_inliers = summary.num_samples - static_cast<int>(summary.outliers.size());
  summary.rms = num_inliers > 0 ? std::sqrt(squared / (3.0 * num_inliers)) : kNan;
  summary.normalised = summary.rms / stddev;
  return summary;
}

CornerResiduals SummariseCorners(const std::vector<BoardView>& views,
                                 const std::vector<Eigen::Matrix2Xd>& residuals,
                                 const std::vector<std::vector<bool>>& inliers, double noise_px,
                                 const CameraImuState& state, size_t camera) {
  CornerResiduals summary;
  double squared = 0.0;
  for (size_t v = 0; v < views.size(); ++v) {
    int seen = 0;
    int fitting = 0;
    for (Eigen::Index k = 0; k < residuals[v].cols(); ++k) {
      if (!residuals[v].col(k).allFinite()) continue;
      ++seen;
      if (!inliers[v][static_cast<size_t>(k)]) continue;
      ++fitting;
      squared += residuals[v].col(k).squaredNorm();
    }
    if (seen == 0) continue;
    ++summary.num_views;
    summary.num_corners += fitting;
    if (fitting == 0) {
      summary.rejected_views.push_back(views[v].name);
      summary.rejected.push_back({views[v].stamp, TimeOfView(state, camera, views[v].stamp)});
    } else {
      summary.num_outliers += seen - fitting;
    }
  }
  summary.rms_px = summary.num_corners > 0 ? std::sqrt(squared / summary.num_corners) : kNan;
  summary.normalised = summary.rms_px / std::sqrt(2.0) / noise_px;
  return summary;
}

}  // namespace

CameraImuResidualSummary SummariseResiduals(const CameraImuProblem& problem,
                                            const CameraImuCalibration& calibration) {
  assert(calibration.state.has_value());
  const CameraImuResiduals& residuals = calibration.residuals;
  const CameraImuSelection& inliers = calibration.inliers;
  CameraImuResidualSummary summary;
  for (size_t n = 0; n < problem.cameras.size(); ++n) {
    summary.cameras.push_back(
        SummariseCorners(problem.cameras[n].views, residuals.corners_px[n], inliers.corners[n],
                         calibration.weights.corner_noise_px, *calibration.state, n));
  }
  for (size_t n = 0; n < problem.imus.size(); ++n) {
    const ImuStream& stream = problem.imus[n].stream;
    const CameraImuWeights::Imu& weights = calibration.weights.imus[n];
    summary.gyros.push_back(SummariseSamples(stream.gyro, residuals.gyro[n], inliers.gyro[n],
                                             weights.gyro_stddev, *calibration.state, n));
    summary.accels.push_back(SummariseSamples(stream.accel, residuals.accel[n], inliers.accel[n],
                                              weights.accel_stddev, *calibration.state, n));
  }
  return summary;
}

}  // namespace calibrato
