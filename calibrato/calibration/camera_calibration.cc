#include "calibrato/calibration/camera_calibration.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "calibrato/base/input_error.h"
#include "calibrato/calibration/camera_rig_calibration.h"

namespace calibrato {
void HoldParameters(const std::vector<std::string>& names, CameraProblem* problem) {
  if (names.empty()) return;
  const std::vector<std::string> known_names = CameraModel::ParameterNames(problem->model);
  problem->fixed.assign(known_names.size(), false);
  problem->known = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(known_names.size()),
                                             std::numeric_limits<double>::quiet_NaN());
  for (const std::string& name : names) {
    const auto found = std::find(known_names.begin(), known_names.end(), name);
    if (found == known_names.end()) {
      std::string list;
      for (const std::string& known : known_names) list += (list.empty() ? "" : ", ") + known;
      throw InputError({"cannot hold '" + name + "'", "",
                        problem->model + " has no parameter of that name", "choose from " + list});
    }
    const auto index = found - known_names.begin();
    problem->fixed[static_cast<size_t>(index)] = true;
    if (index >= CameraModel::NumIntrinsics(problem->model)) problem->known(index) = 0.0;
  }
  if (std::find(problem->fixed.begin(), problem->fixed.end(), false) == problem->fixed.end()) {
    throw InputError(
        {"nothing to estimate", "", "every parameter is held", "leave at least one out of --fix"});
  }
}

CameraCalibration CalibrateCamera(const CameraProblem& problem, int max_iterations) {
  CameraRigProblem rig;
  rig.cameras = {problem};
  rig.frame_of_view.emplace_back(problem.views.size());
  std::iota(rig.frame_of_view[0].begin(), rig.frame_of_view[0].end(), 0);
  return CalibrateCameraRig(rig, max_iterations).cameras.front();
}

}  // namespace calibrato
