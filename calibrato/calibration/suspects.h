#pragma once

#include <vector>

#include "calibrato/calibration/gyro_turns.h"
#include "calibrato/geometry/rigid3.h"
#include "calibrato/sensors/imu.h"

namespace calibrato {

/// A pose at a time [s].
struct TimedPose {
  double time_s = 0.0;
  Rigid3 pose;
};

// Measurements that their neighbours contradict. In a trajectory that bends as a spline does, a
// late image or a spike of the IMU may look no worse than its neighbours, for all of them are bent
// to fit; so they are to be kept out from the start, and judged by what the rest makes of them.
//
// Each measurement is predicted from two before and two after it. It is suspect if it is further
// from its prediction than some multiple of the median; of suspects next to each other the worst is
// taken first, and the others are judged without it. None is where more than a tenth would be: then
// the motion is too fast for neighbours to predict each other. One between two that are off alike
// is suspected with them.
//
// Both functions return one flag a measurement, in n log n steps.

/// Views with a wrong stamp, or with a board that was found wrongly. Orientation is predicted from
/// the view before, turned by the gyroscope, what is then missing at the view after it being shared
/// out evenly; position by a cubic.
/// @param T_c_g  Of the board in one camera, in order of the times, which are on the gyroscope's
///               clock.
[[nodiscard]] std::vector<bool> FindSuspectViews(const std::vector<TimedPose>& T_c_g,
                                                 const Eigen::Matrix3d& R_c_i,
                                                 const GyroTurns& turns);

/// Samples of one sensor; predicted by a cubic.
[[nodiscard]] std::vector<bool> FindSuspectSamples(const std::vector<VectorSample>& samples);

}  // namespace calibrato
