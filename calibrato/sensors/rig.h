#pragma once

#include <limits>
#include <string>
#include <vector>

#include "calibrato/base/time.h"
#include "calibrato/base/value.h"
#include "calibrato/geometry/rigid3.h"
#include "calibrato/sensors/arm_disturbances.h"
#include "calibrato/sensors/arm_limits.h"
#include "calibrato/sensors/board.h"
#include "calibrato/sensors/camera_chain.h"
#include "calibrato/sensors/image_disturbances.h"
#include "calibrato/sensors/imu.h"
#include "calibrato/sensors/imu_disturbances.h"
#include "calibrato/sensors/lens_residual.h"

namespace calibrato {

/// How corners are measured at fidelities `fast` and `physical`: white noise that grows with motion
/// blur, slowly at first and steeply beyond a knee, and a detector that loses the board when blur
/// smears it. With L the blur length [px], the mean way of the corners during the exposure:
///
///     sigma^2 = stddev_px^2 + (blur_factor L)^2 (1 + (L / blur_knee_px)^6)
///     P(board detected) = 1 / (1 + exp((L / corner spacing - blur_at_half) / blur_slope))
///                         * 1 / (1 + exp((L - lost_at_half_px) / lost_slope_px))
///
/// The spacing is that of neighbouring corners in the image: squares that are smeared over each
/// other are lost by the first factor, and what a detector's window can't hold by the second.
/// docs/simulation.md has the figures that fit rendered images.
struct CornerNoise {
  double stddev_px = 0.1;     ///< Of each coordinate at rest; the paper's simulator has about 0.1.
  double blur_factor = 0.05;  ///< [-] [px of noise per px of blur]
  double blur_knee_px = std::numeric_limits<double>::infinity();  ///< > 0; infinity: no knee.
  double blur_at_half = 0.5;  ///< [-] Blur at which every second board is lost.
  double blur_slope = 0.05;   ///< [-] > 0
  double lost_at_half_px = std::numeric_limits<double>::infinity();  ///< > 0; infinity: no limit.
  double lost_slope_px = 0.4;                                        ///< > 0
  /// What a corner's place within its pixel does to it: each coordinate is measured too large by
  /// this sin(2 pi coordinate) [px] >= 0. The same in every image that is taken from the same
  /// place, so frames of a camera that hovers do not average it away.
  double phase_error_px = 0.0;

  /// sigma [px] at blur length L [px].
  [[nodiscard]] double Stddev(double blur_px) const;
  [[nodiscard]] double DetectionProbability(double blur_px, double spacing_px) const;
};

/// Rate of the camera in the paper's scene [Hz].
inline constexpr double kPaperCameraRateHz = 10.0;

/// A camera-IMU rig on its carrier, with the board before it: the truth of a simulation.
struct Rig {
  std::vector<Camera> cameras;
  Rigid3 T_e_c0;             ///< Where camera 0 sits on the controlled frame.
  Rigid3 T_c0_i;             ///< IMU to camera 0: Kalibr's T_cam_imu.
  Duration time_offset_i_c;  ///< t_i = t_c + time_offset_i_c
  ImuNoise imu_noise;
  ImuDisturbances imu_disturbances;
  ArmLimits arm_limits;
  ArmDisturbances arm_disturbances;
  /// How far the arm's right finger, or what it holds, reaches beyond the Panda's own finger [m] >=
  /// 0: from about 0.16 on it comes into the view of the paper's camera, from the right.
  double finger_reach_m = 0.0;
  Board board;
  Rigid3 T_w_g;                                ///< Where the board stands.
  double stand_motion_m = 0.0;                 ///< How far its stand sways, root mean square >= 0.
  LensResidual lens_residual;                  ///< Of camera 0.
  double exposure_s = 0.0;                     ///< [s] >= 0; 0 means no motion blur.
  double camera_rate_hz = kPaperCameraRateHz;  ///< [Hz] > 0, at most 1000.
  CornerNoise corner_noise;                    ///< Fidelity `fast` and `physical`.
  ImageDisturbances image_disturbances;        ///< Times at every fidelity, else `rendered`.
};

/// RIG.yaml (docs/formats.md section 3). @throws InputError with line and key. Unknown keys are
/// appended to warnings (may be null).
[[nodiscard]] Rig RigFromValue(const Value& value, std::vector<std::string>* warnings);
[[nodiscard]] Value ToValue(const Rig& rig);

}  // namespace calibrato
