#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calibrato/calibration/camera_imu_calibration.h"

namespace calibrato {

/// When something was measured that does not fit.
struct LeftOut {
  Time stamp;           ///< On the sensor's own clock, as in the recording.
  double time_s = 0.0;  ///< From the trajectory's beginning.
};

/// How well one sensor's samples fit.
struct SensorResiduals {
  double rms = 0.0;         ///< Of one axis, over inliers [rad/s] or [m/s^2]; NaN for none.
  double normalised = 0.0;  ///< The same over the stated standard deviation of a sample [-].
  int num_samples = 0;      ///< On the trajectory.
  /// Of these, those that do not fit, in order of time.
  std::vector<LeftOut> outliers;
};

/// How well one camera's corners fit.
struct CornerResiduals {
  double rms_px = 0.0;      ///< sqrt(sum(du^2 + dv^2) / N) over inliers; NaN for none.
  double normalised = 0.0;  ///< Of one coordinate over the noise of a corner [-].
  int num_views = 0;        ///< On the trajectory.
  int num_corners = 0;      ///< Inliers.
  int num_outliers = 0;     ///< In views of which other corners fit.
  std::vector<std::string> rejected_views;  ///< Of which no corner fits ...
  std::vector<LeftOut> rejected;            ///< ... and when they were taken.
};

struct CameraImuResidualSummary {
  std::vector<CornerResiduals> cameras;
  std::vector<SensorResiduals> gyros;  ///< One an IMU.
  std::vector<SensorResiduals> accels;
};

/// @pre the calibration has a state
[[nodiscard]] CameraImuResidualSummary SummariseResiduals(const CameraImuProblem& problem,
                                                          const CameraImuCalibration& calibration);

}  // namespace calibrato
