#include "calibrato/diagnosis/better_model.h"

#include <map>
#include <numeric>
#include <string_view>
#include <vector>

#include "calibrato/calibration/camera_rig_calibration.h"

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
    CameraRigProblem rig;
    CameraProblem& other = rig.cameras.emplace_back();
    other.model = name;
    other.resolution = problem.resolution;
    other.views = calibration.used_views;
    // The same corners for both: what does not fit counts.
    other.reject_outliers = false;
    rig.frame_of_view.emplace_back(other.views.size());
    std::iota(rig.frame_of_view[0].begin(), rig.frame_of_view[0].end(), 0);
    // Where the board's bending was estimated, its points are bent.
    for (BoardView& view : other.views) {
      rig.estimate_bending = rig.estimate_bending || !view.points_g.row(2).isZero(0.0);
      view.points_g.row(2).setZero();
    }
    const CameraCalibration result = CalibrateCameraRig(rig).cameras.front();
    if (result.termination == Termination::kConverged && result.noise_stddev_px < least) {
      best = BetterModel{std::string(name), result.noise_stddev_px};
      least = kBetterThanNext * result.noise_stddev_px;
    }
  }
  return best;
}

}  // namespace calibrato
