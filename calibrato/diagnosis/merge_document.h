#pragma once

#include <string>
#include <vector>

#include "calibrato/base/value.h"
#include "calibrato/diagnosis/merged_calibration.h"

namespace calibrato {

/// What stands in the --out folder of a calibration.
struct ResultFolder {
  std::string name;  ///< Its path, for errors and the table.
  Value result;      ///< result.json
  Value chain;       ///< camchain.yaml, or camchain-imucam.yaml.
  Value imus;        ///< imu.yaml; null for cameras alone.
};

/// What merging writes.
struct MergedDocuments {
  /// {"kind": "merge", "of": "camera" or "camera-imu", "verdict", "findings", "results": [names],
  ///  "cameras", of `camera`: [{"model", "resolution", "intrinsics", "distortion",
  ///  "intrinsics_sigma", "distortion_sigma", "T_cn_cnm1"}], of `camera-imu`: [{"T_cam_imu",
  ///  "time_offset_s", "line_delay_s"}], "imus" of `camera-imu`, with biases as means over the
  ///  recordings, "gravity_g" of the first, "covariance": {"names", "matrix"},
  ///  "groups": [{"name", "probability", "statistic", "degrees_of_freedom", "sigma_scale",
  ///  "parameters": [{"name", "value", "sigma", "repeatability", "stated_sigma", "deviations":
  ///  [..], "sigmas": [..]}]}]}
  /// `value` is null for rotations, whose deviations are turns about the merged one; `probability`,
  /// `statistic` and `degrees_of_freedom` are null for a group that was held; `stated_sigma`
  /// is the root of the mean square of the results' own sigmas, to be held against
  /// `repeatability`.
  Value result;
  Value chain;  ///< As the inputs'.
  Value imus;   ///< As the inputs'; null for cameras alone.
};

/// @throws InputError: not calibrations, of different kinds or cameras (number, model, resolution),
/// a chain or IMUs that are not of the result beside them, or what MergeCalibrations refuses; of
/// cameras with an IMU also where lenses that were held differ.
[[nodiscard]] MergedDocuments MergeResults(const std::vector<ResultFolder>& folders);

/// In plain text, for the terminal.
[[nodiscard]] std::string MergeText(const Value& result);

}  // namespace calibrato
