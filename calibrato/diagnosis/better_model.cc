#include "calibrato/diagnosis/better_model.h"

#include <map>
#include <string_view>
#include <vector>

namespace calibrato {
namespace {

// What to try where a model does not fit: the next of its own kind, then what bends rays in another
// way.
const std::map<std::string_view, std::vector<std::string_view>> kSuccessors = {
    {"pinhole-none", {"pinhole-radtan", "pinhole-equi"}},
    {"pinhole-radtan", {"pinhole-radtan5", "pinhole-equi", "omni-radtan"}},
    {"pinhole-radtan5", {"pinhole-equi", "omni-radtan"}},
    {"pinhole-equi", {"omni-radtan", "pinhole-radtan5"}},
    {"pinhole-fov", {"pinhole-equi", "pinhole-radtan5"}},
    {"omni-none", {"omni-radtan", "pinhole-equi"}},
    {"omni-radtan", {"pinhole-equi", "pinhole-radtan5"}},
    {"ds-none", {"pinhole-equi", "omni-radtan"}},
    {"eucm-none", {"pinhole-equi", "omni-radtan"}},
};

constexpr double kWorthNaming = 0.95;     // [-] of the noise
constexpr double kBetterThanNext = 0.98;  // Successors are in order of preference.

}  // namespace

std::optional<BetterModel> FindBetterModel(const CameraProblem& problem,
                                           const CameraCalibration& calibration) {
  const auto successors = kSuccessors.find(problem.model);
  if (successors == kSuccessors.end()) return std::nullopt;
  std::optional<BetterModel> best;
  double least = kWorthNaming * calibration.noise_stddev_px;
  for (const std::string_view name : successors->second) {
    CameraProblem other;
    other.model = name;
    other.resolution = problem.resolution;
    other.views = calibration.used_views;
    // The same corners for both: what does not fit counts.
    other.reject_outliers = false;
    const CameraCalibration result = CalibrateCamera(other);
    if (result.termination == Termination::kConverged && result.noise_stddev_px < least) {
      best = BetterModel{std::string(name), result.noise_stddev_px};
      least = kBetterThanNext * result.noise_stddev_px;
    }
  }
  return best;
}

}  // namespace calibrato
