#pragma once

#include <string>

#include "calibrato/base/value.h"
#include "calibrato/diagnosis/merge_document.h"

namespace calibrato {

/// result.json of a calibration's --out folder, of whatever kind. @throws InputError
[[nodiscard]] Value ReadResult(const std::string& folder);

/// Name of the camera chain beside a result of this kind: `camera` or `camera-imu`.
[[nodiscard]] std::string ChainName(const std::string& calibration_kind);

/// The --out folder of `calibrate camera`, `calibrate camera-imu` or `merge`. @throws InputError,
/// also if it has no estimate.
[[nodiscard]] ResultFolder ReadResultFolder(const std::string& folder);

}  // namespace calibrato
