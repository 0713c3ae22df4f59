#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibrato/base/value.h"
#include "calibrato/calibration/comparison.h"

namespace calibrato {

/// Two results of `calibrate camera`, camera by camera.
struct ResultComparison {
  struct CameraPair {
    std::string name;  ///< "cam0"
    std::string first_model;
    std::string second_model;
    Resolution resolution;
    CameraComparison camera;
    std::optional<PoseComparison> T_cn_cnm1;  ///< Where both results have it.
  };
  std::vector<CameraPair> cameras;
};

enum class Agreement {
  kAgree,        ///< Nothing beyond chance.
  kDiffer,       ///< Some difference is significant.
  kInconclusive  ///< None is known to be significant, but a covariance is missing.
};

/// For people, without a line's end: "the results agree".
[[nodiscard]] std::string AgreementText(Agreement agreement);
[[nodiscard]] std::string AgreementName(Agreement agreement);  ///< "agree", "differ", ..

/// From two result.json.
/// @throws InputError: of another kind, another number of cameras, not calibrated, other image
/// size.
[[nodiscard]] ResultComparison CompareResults(const Value& first, const Value& second);

/// Where several differences are tested, each must be as much rarer by chance (Bonferroni).
/// @param level  How often all tests together may find a difference where there is none.
[[nodiscard]] Agreement AgreementOf(const ResultComparison& comparison,
                                    double level = kSignificance);

/// {"kind": "diff", "agreement", "level", "cameras": [{"name", "models": [2], "resolution": [w, h],
/// "probability", "statistic", "degrees_of_freedom", "tested": "parameters" or "projection",
/// "focal_change" (relative, if only it changed), "focal_change_sigma", "focal_change_probability",
/// "rms_difference_px", "expected_rms_difference_px", "rotation_rad": [3], "difference_px": map
/// (checks_document.h), "T_cn_cnm1": {"rotation_rad", "translation_m", "probability"}}, ..]}
[[nodiscard]] Value ComparisonResult(const ResultComparison& comparison,
                                     double level = kSignificance);

/// In plain text, for the terminal.
[[nodiscard]] std::string ComparisonText(const ResultComparison& comparison,
                                         double level = kSignificance);

}  // namespace calibrato
