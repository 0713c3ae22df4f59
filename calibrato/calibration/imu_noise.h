#pragma once

#include <string>
#include <vector>

#include "calibrato/calibration/allan_deviation.h"
#include "calibrato/sensors/imu.h"

// The noise of an IMU from a log of it at rest.

namespace calibrato {

/// A density with its uncertainty.
struct NoiseFigure {
  double value = 0.0;
  /// Standard deviation over the value; above 0.15 there is a warning.
  double relative_sigma = 0.0;
  /// Where the Allan deviation does not show it: `value` is what it is below of, with 95 %
  /// probability, else what is measured.
  bool is_upper_bound = false;
};

/// One axis of one sensor. Its Allan variance is fitted by
///
///     sigma^2(tau) = N^2 / tau + (2 ln 2 / pi) B^2 + K^2 tau / 3
///
/// (IEEE Std 952-1997, annex C), N, B and K not below zero, B only where its square is larger
/// than three sigmas of the square. Values at taus of 8, 16, 32 .. periods, in their logarithms,
/// are weighted by their degrees of freedom; sigmas rest on the covariance that they have between
/// them, for Gaussian noise as it was fitted.
struct AxisNoise {
  std::vector<AllanPoint> points;      ///< Four in an octave: what is drawn.
  std::vector<double> relative_sigma;  ///< Of each deviation.
  NoiseFigure white;                   ///< N [unit/sqrt(Hz)]
  NoiseFigure walk;                    ///< K [unit/s/sqrt(Hz)]
  double bias_instability = 0.0;       ///< B [unit]; 0 where it does not show.
};

/// One sensor: its axes, and what stands for all of them, the root mean squares.
struct SensorNoiseEstimate {
  std::vector<AxisNoise> axes;  ///< x, y, z
  NoiseFigure white;
  NoiseFigure walk;
  double rate_hz = 0.0;
  double duration_s = 0.0;  ///< Of the part that was used.
};

struct ImuNoiseEstimate {
  SensorNoiseEstimate gyro;   ///< [rad/s/sqrt(Hz)], [rad/s^2/sqrt(Hz)]
  SensorNoiseEstimate accel;  ///< [m/s^2/sqrt(Hz)], [m/s^3/sqrt(Hz)]
  std::vector<std::string>
      warnings;  ///< Figures that the log is too short for; gaps; one line each.

  [[nodiscard]] ImuNoise noise() const;
};

/// Of each sensor the longest part without gaps (periods of more than three medians) is used; a
/// sample that is lost here and there shifts the others by a period, which no figure feels.
/// @param name  "imu0", for errors and warnings.
/// @param stream  As recorded; what is not finite, out of order or doubled is left out.
/// @throws InputError: less than 10 s or 1000 samples without a gap, a sensor whose readings never
/// change, or an IMU that was moved: means over neighbouring seconds differ by more than 0.02 rad/s
/// or 0.2 m/s^2, and by more than eight sigmas of the noise itself; or means over a second, of the
/// whole part, by more than 0.06 rad/s or 0.6 m/s^2.
[[nodiscard]] ImuNoiseEstimate EstimateImuNoise(const std::string& name, const ImuStream& stream);

}  // namespace calibrato
