#pragma once

#include "calibrato/sensors/imu.h"

namespace calibrato {

/// How far apart the knots of a trajectory of order 6 may be for it to follow what an IMU felt [s].
///
/// A cubic spline, which is what the accelerations of such a trajectory are, is fitted to each
/// stream's readings at ever finer spacings; the one that predicts left-out readings best, by
/// generalised cross-validation (Craven and Wahba, "Smoothing noisy data with spline functions",
/// 1979),
///
///     GCV = (sum of squared residuals / N) / (1 - n / N)^2,  n coefficients, N readings,
///
/// is where motion ends and noise begins. Spikes (suspects.h) take no part. The finer of the two
/// streams' spacings is taken, and divided by sqrt(2), which makes what the spline can't follow at
/// least ten times less than what it would cost to follow noise.
///
/// Candidates run from 0.4 s down in steps of sqrt(2), as far as there are 2.5 readings for each
/// coefficient. 0.1 s for streams of fewer than 20 readings.
[[nodiscard]] double KnotSpacingFor(const ImuStream& stream);

}  // namespace calibrato
