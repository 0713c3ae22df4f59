#pragma once

#include <vector>

#include "calibrato/calibration/camera_imu_linearisation.h"
#include "calibrato/calibration/camera_imu_problem.h"
#include "calibrato/calibration/camera_imu_state.h"

namespace calibrato {

/// Which measurements take part; one entry for each of the problem's.
struct CameraImuSelection {
  std::vector<std::vector<std::vector<bool>>> corners;  ///< [camera][view][corner]
  std::vector<std::vector<bool>> gyro;                  ///< [imu][sample]
  std::vector<std::vector<bool>> accel;                 ///< [imu][sample]
  bool operator==(const CameraImuSelection&) const = default;
};

/// Predicted - measured, of all of the problem's measurements, taking part or not. NaN where a
/// corner does not project, and for what lies outside the trajectory.
struct CameraImuResiduals {
  std::vector<std::vector<Eigen::Matrix2Xd>> corners_px;  ///< [camera][view], 2 x N [px]
  std::vector<std::vector<Eigen::Vector3d>> gyro;         ///< [imu][sample] [rad/s]
  std::vector<std::vector<Eigen::Vector3d>> accel;        ///< [imu][sample] [m/s^2]
};

/// Times on the spline, by the state's time offsets [s]; of a view, that of its first row.
[[nodiscard]] double TimeOfView(const CameraImuState& state, size_t camera, Time stamp);
[[nodiscard]] double TimeOfSample(const CameraImuState& state, size_t imu, Time stamp);

[[nodiscard]] CameraImuResiduals ResidualsOf(const CameraImuProblem& problem,
                                             const CameraImuState& state);

/// What lies on the trajectory and projects.
[[nodiscard]] CameraImuSelection SelectionOfFinite(const CameraImuResiduals& residuals);

/// The same, where their residuals are not needed: of samples none is predicted.
[[nodiscard]] CameraImuSelection SelectionOnTrajectory(const CameraImuProblem& problem,
                                                       const CameraImuState& state);

/// The measurements of a selection, for Linearise. They point into the problem.
[[nodiscard]] CameraImuMeasurements MeasurementsOf(const CameraImuProblem& problem,
                                                   const CameraImuState& state,
                                                   const CameraImuSelection& selection);

}  // namespace calibrato
