#pragma once

#include <string>

#include "calibrato/base/value.h"
#include "calibrato/diagnosis/recording_check.h"

namespace calibrato {

/// result.json of `calibrato check`:
///     {"kind": "check", "verdict", "findings",
///      "streams": [{"name", "verdict", "num", "duration_s", "rate_hz", "jitter_s", "num_missing",
///                   "num_gaps", "longest_gap_s", "steps_back_s": [..], and of samples
///                   "num_not_finite", "num_out_of_order", "num_duplicates", "num_saturated"}],
///      "clocks": [{"imu", "camera", "time_offset_s", "correlation", "speed_ratio",
///                  "pieces": [{"begin_s", "end_s", "time_offset_s", "correlation"}]}],
///      "boards": [{"camera", "verdict", "num_images", "num_with_board", "longest_away_s",
///                  "coverage": {"x", "y", "size", "skew"}, "uncovered_parts": [..],
///                  "travel_m": [3] or null, "edge_width_px", "black", "white", "brightness":
///                  medians over the images that were looked at, null without}],
///      "motions": [{"imu", "verdict", "rates_rad_s": [3], "forces_m_s2": [3],
///                   "median_force_m_s2", "rest": {"duration_s", "gyro_noise_density",
///                   "accel_noise_density"} or null}],
///      "expected": [{"name", "sigma", "enough", "verdict", "advice"}]}
/// Sigmas are null where the motion does not show the parameter.
[[nodiscard]] Value CheckResult(const RecordingToCheck& recording, const RecordingCheck& check);

/// What the page draws over time, in seconds from the first image (from the first sample, where no
/// image or none of that time is there):
///     {"duration_s",
///      "cameras": [{"name", "resolution": [w, h] or null, "time_s": [..], "num_corners": [..],
///                   "edge_time_s": [..], "edge_width_px": [..], "corners": [[u, v]..]}],
///      "imus": [{"name", "gyro": [3 envelopes], "accel": [3 envelopes]}],
///      "intervals": [{"name", "median_ms", "interval_ms": envelope}]}
[[nodiscard]] Value CheckPlots(const RecordingToCheck& recording, const RecordingCheck& check);

/// The result in plain text, for the terminal: a line for each stream and parameter, then the
/// verdict and the findings.
[[nodiscard]] std::string CheckText(const RecordingToCheck& recording, const RecordingCheck& check);

}  // namespace calibrato
