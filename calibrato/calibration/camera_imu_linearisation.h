#pragma once

#include <Eigen/Core>
#include <deque>
#include <optional>
#include <vector>

#include "calibrato/calibration/arrowhead.h"
#include "calibrato/calibration/camera_imu_layout.h"
#include "calibrato/calibration/camera_imu_problem.h"
#include "calibrato/calibration/camera_imu_state.h"

namespace calibrato {

/// The measurements that take part, on the spline's time [s] but for the time offsets that are
/// still to be found; each list in order of time.
struct CameraImuMeasurements {
  /// Corners of one instant: an image's; of a rolling shutter, one corner.
  struct View {
    double time_s = 0.0;  ///< Of the stamp.
    double row_px = 0.0;  ///< Exposed a line delay times this later [px].
    const BoardView* view = nullptr;
  };
  struct Sample {
    double time_s = 0.0;
    Eigen::Vector3d value;
  };
  struct Imu {
    std::vector<Sample> gyro;
    std::vector<Sample> accel;
  };
  std::vector<std::vector<View>> cameras;
  std::vector<Imu> imus;
  std::deque<BoardView> partial_views;  ///< Parts of views, pointed to above.
};

/// By what residuals are divided.
struct CameraImuWeights {
  struct Imu {
    double gyro_stddev = 1.0;   ///< Of one sample [rad/s].
    double accel_stddev = 1.0;  ///< [m/s^2]
    double gyro_walk = 1.0;     ///< [rad/s^2/sqrt(Hz)]
    double accel_walk = 1.0;    ///< [m/s^3/sqrt(Hz)]
    /// Of the streams as they were recorded, whatever the data sheet says [Hz]: a sample's standard
    /// deviation is the density times the root of its stream's rate.
    double gyro_rate_hz = 1.0;
    double accel_rate_hz = 1.0;
  };
  double corner_noise_px = 1.0;
  std::vector<Imu> imus;
  /// Of Cauchy's loss, in standard deviations, for corners and IMU samples; 0 for least squares.
  double loss_scale = 0.0;
};

/// The normal equations at a state. Residuals:
///
///     corners    (predicted - measured) / corner_noise_px
///     gyro, accel   (predicted + bias - measured) / stddev
///     random walks  (bias at a knot's end - at its beginning) / (walk sqrt(duration))
///     priors on camera parameters, and one of 1e4 m/s^2 and rad/s^2 on the trajectory's
///     accelerations, that decides where nothing was measured and nowhere else
///
/// Blocks are linearised in parallel, in rounds of a fixed size, and added in their order.
/// @return the cost: the sum of the losses; nothing where a corner does not project.
[[nodiscard]] std::optional<double> Linearise(const CameraImuProblem& problem,
                                              const CameraImuState& state,
                                              const CameraImuLayout& layout,
                                              const CameraImuMeasurements& measurements,
                                              const CameraImuWeights& weights,
                                              ArrowheadSystem* system);

}  // namespace calibrato
