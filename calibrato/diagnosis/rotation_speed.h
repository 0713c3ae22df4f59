#pragma once

#include <optional>
#include <vector>

#include "calibrato/sensors/camera_model.h"
#include "calibrato/sensors/imu.h"
#include "calibrato/sensors/measurements.h"

namespace calibrato {

/// How fast a camera turned between two of its views.
struct RotationSpeed {
  Time begin;
  Time end;
  double speed = 0.0;  ///< Mean size of the angular velocity [rad/s].
};

/// From the poses of the board in neighbouring views not more than 0.25 s apart. Views without a
/// pose are passed over. @param views  In order of time.
[[nodiscard]] std::vector<RotationSpeed> RotationSpeeds(const CameraModel& model,
                                                        const std::vector<BoardView>& views);

/// How a gyroscope's speeds fit those of a camera on the same body, whatever the rotation between
/// them.
struct SpeedComparison {
  double time_offset_s = 0.0;  ///< t_i = t_c + this, at a peak of the correlation.
  double correlation = 0.0;    ///< -1 .. 1
  /// Gyroscope over camera, by least squares through zero: 1 if both are in rad/s, 57.3 if the
  /// gyroscope is in deg/s.
  double scale = 0.0;
};

/// At the highest peak of the correlation over the time offset; but speeds that repeat themselves
/// correlate alike at several offsets, and then chance says which of those peaks is highest: of
/// those that are not clearly lower it is the one nearest to `centre_s`. Clearly lower is one by
/// more than three standard deviations of the difference of two correlations, in Fisher's z.
/// @param gyro  Finite and ascending.
/// @param centre_s  Offsets are looked for within centre_s +- 3 s, in steps of 10 ms.
/// @return nothing unless twenty intervals at least overlap and the camera's speed changes by more
/// than 0.05 rad/s (standard deviation): without motion there is nothing to compare.
[[nodiscard]] std::optional<SpeedComparison> CompareSpeeds(const std::vector<RotationSpeed>& camera,
                                                           const std::vector<VectorSample>& gyro,
                                                           double centre_s = 0.0);

}  // namespace calibrato
