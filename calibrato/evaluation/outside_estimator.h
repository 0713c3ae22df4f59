#pragma once

#include <string>
#include <vector>

#include "calibrato/base/value.h"
#include "calibrato/geometry/rigid3.h"

namespace calibrato {

/// A camera-IMU calibration by somebody else's program, Kalibr's for one, as a small YAML says how
/// to run it:
///
///     name: kalibr
///     command: [run_kalibr.sh, "{bag}", "{target}", "{camchain}", "{imu}", "{out}"]
///     timeout_s: 600
///
/// {bag} is a ROS 1 bag with /cam0/image_raw and /imu0; {target}, {camchain} and {imu} are Kalibr's
/// YAML files; {out} is a folder, in which it has to leave camchain-imucam.yaml.
struct OutsideEstimator {
  std::string name;
  std::vector<std::string> command;
  double timeout_s = 600.0;
};

/// @throws InputError with line and key: missing or malformed keys, an empty command, a mark in
/// braces other than these. Unknown keys are appended to warnings (may be null).
[[nodiscard]] OutsideEstimator OutsideEstimatorFromValue(const Value& value,
                                                         std::vector<std::string>* warnings);

/// Files that the program is given, by their paths.
struct OutsideInput {
  std::string bag;
  std::string target;
  std::string camchain;
  std::string imu;
};

struct OutsideResult {
  /// Why there is no result: how the program ended, or what is wrong with the file that it left.
  std::string failure;
  Rigid3 T_c_i;
  double time_offset_s = 0.0;
  double seconds = 0.0;  ///< Wall time of the program.
};

/// @param folder  Where it runs; {out} is made in it.
[[nodiscard]] OutsideResult RunOutsideEstimator(const OutsideEstimator& estimator,
                                                const OutsideInput& input,
                                                const std::string& folder);

}  // namespace calibrato
