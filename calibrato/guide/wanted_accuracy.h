#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calibrato/sensors/camera_model.h"

namespace calibrato {

/// How well a calibration is wanted to be known before a person may stop: standard deviations. The
/// defaults are a quarter of what the verdict warns at, or better (docs/guide.md).
struct WantedAccuracy {
  double focal_share = 0.002;    ///< Of fu, fv, pu, pv, over the focal length [-] > 0.
  double rotation_rad = 8.7e-4;  ///< Of T_c_i, about each axis (0.05 degrees) > 0.
  double translation_m = 2e-3;   ///< Along each axis > 0.
  double time_offset_s = 1e-4;   ///< > 0
};

/// "focal-percent=0.2", "rotation-deg=0.05", "translation-mm=2", "time-ms=0.1": sets one.
/// @throws InputError for another name (the nearest is named) or a value that is not above 0.
void SetWanted(const std::string& word, WantedAccuracy* wanted);

/// How well one parameter is known, and how well it is wanted to be.
struct ParameterProgress {
  std::string name;  ///< "fu", "rot_x", "pos_z", "time_offset"
  std::string unit;  ///< "px", "rad", "m", "s"
  double sigma = 0.0;
  double wanted = 0.0;
  [[nodiscard]] bool is_reached() const { return sigma <= wanted; }
};

/// The order of what is estimated: [T_c_i 6, time offset, gravity's two angles] where there is an
/// IMU, then the camera's parameters unless they are known.
struct KnowledgeLayout {
  bool has_imu = false;
  int num_parameters = 0;  ///< 0 where the camera is known.
  static constexpr int kNumExtrinsics = 9;
  [[nodiscard]] int parameters() const { return has_imu ? kNumExtrinsics : 0; }
  [[nodiscard]] int size() const { return parameters() + num_parameters; }
};

/// The parameters that are wanted, in a fixed order: fu fv pu pv unless the camera is known, then
/// rot_x .. pos_z and time_offset where there is an IMU.
/// @param information  Of the layout's parameters, positive definite.
[[nodiscard]] std::vector<ParameterProgress> ProgressOf(const Eigen::MatrixXd& information,
                                                        const KnowledgeLayout& layout,
                                                        const CameraModel& camera,
                                                        const WantedAccuracy& wanted);

/// What still stands between a person and the end: the sum of log(sigma / wanted) over those that
/// are not reached, and a little of all of them. Smaller is better.
[[nodiscard]] double DistanceFromWanted(const std::vector<ParameterProgress>& progress);

}  // namespace calibrato
