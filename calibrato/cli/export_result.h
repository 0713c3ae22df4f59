#pragma once

#include <optional>
#include <string>

#include "calibrato/cli/command.h"

namespace calibrato {

/// `calibrato export RESULT_DIR`: a calibration as another program reads it
/// (sensors/foreign_calibration.h), into the folder `out`. Warnings go to stderr.
/// @throws InputError
ExitCode ExportResult(const std::string& folder, const std::string& format,
                      std::optional<double> camera_rate_hz, const std::string& out,
                      const GlobalOptions& global);

}  // namespace calibrato
