#pragma once

#include <cstddef>
#include <variant>
#include <vector>

#include "calibrato/base/time.h"
#include "calibrato/calibration/camera_imu_problem.h"
#include "calibrato/calibration/camera_imu_state.h"

namespace calibrato {

/// Measurements that their neighbours contradict (suspects.h). They take no part in the start, and
/// should take none in a solve before the trajectory can judge them.
struct CameraImuSuspects {
  std::vector<std::vector<bool>> views;  ///< [camera][view]
  std::vector<std::vector<bool>> gyro;   ///< [imu][sample]
  std::vector<std::vector<bool>> accel;  ///< [imu][sample]
};

/// Where to start a camera-IMU calibration from, found in the data alone.
struct CameraImuStart {
  CameraImuState state;
  double corner_noise_px = 1.0;  ///< Of one coordinate, from the views' own poses [px].
  CameraImuSuspects suspects;
};

/// Views further apart than this [s] say little of how the rig turned between them.
inline constexpr double kLongestViewInterval = 0.5;

/// Why a recording has nothing to start from.
struct CameraImuNoStart {
  enum class Reason {
    kNoBoardPoses,   ///< Of a camera: hardly a view tells the board's pose.
    kViewsFarApart,  ///< Of a camera: hardly two views lie within kLongestViewInterval.
    kNoSharedTime,   ///< A camera's views and the samples of IMU 0, whatever the time offset.
    kNoTurning,      ///< A camera or IMU 0 did not turn at all.
    kOtherImu,  ///< An IMU beyond the first shares no time with it, or one of both never turned.
  };
  Reason reason = Reason::kNoSharedTime;
  size_t sensor = 0;  ///< Which camera; which IMU for kOtherImu.
};

/// The board's pose in each view from its corners; the cameras' time offsets, rotations and the
/// gyroscope's bias from rates (rate_alignment.h); orientations between views by integrating the
/// gyroscope, the spline through them in closed form (SplineAlong); gravity as the mean of the
/// specific force in frame g. Translations between IMU and cameras start at zero: the problem is
/// linear in them, so that one step finds them.
///
/// The trajectory covers the time during which IMU 0 recorded and some camera had the board in
/// view, and 50 ms more at either end where there is IMU data.
/// @param knot_spacing_s  Reduced a little, so that whole blocks cover the trajectory.
/// @return why not, where fewer than kMinRateIntervals pairs of views show the board close enough
/// in time, where they and the IMU share no time, where a camera or IMU 0 did not turn, or where an
/// IMU beyond the first shares no time with it, or one of both did not turn.
/// @pre Every camera has views, and every IMU has samples of both sensors.
[[nodiscard]] std::variant<CameraImuStart, CameraImuNoStart> FindCameraImuStart(
    const CameraImuProblem& problem, const CameraImuOptions& options, double knot_spacing_s);

}  // namespace calibrato
