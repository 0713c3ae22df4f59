#include "calibrato/calibration/camera_calibration.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <string_view>

#include "calibrato/base/input_error.h"
#include "calibrato/base/scalar_text.h"
#include "calibrato/calibration/camera_rig_calibration.h"

namespace calibrato {
namespace {

// What a parameter can be, by name.
struct ValidRange {
  std::string_view name;
  double low;
  double high;
  std::string_view words;
};

// Shapes as sensors/ has them, xi and beta above their least; the rest is far beyond every lens.
constexpr ValidRange kValidRanges[] = {
    {"fu", 1.0, 1e6, "1 to 1e6 px"},        {"fv", 1.0, 1e6, "1 to 1e6 px"},
    {"pu", -1e6, 1e6, "-1e6 to 1e6 px"},    {"pv", -1e6, 1e6, "-1e6 to 1e6 px"},
    {"xi", -0.999, 100.0, "-0.999 to 100"}, {"alpha", 0.0, 1.0, "0 to 1"},
    {"beta", 1e-3, 100.0, "0.001 to 100"}};
constexpr ValidRange kDistortion = {"", -1e6, 1e6, "-1e6 to 1e6"};

const ValidRange& RangeOf(const std::string& name) {
  const auto* found = std::find_if(std::begin(kValidRanges), std::end(kValidRanges),
                                   [&](const ValidRange& range) { return range.name == name; });
  return found == std::end(kValidRanges) ? kDistortion : *found;
}

double ValueOf(const std::string& word, size_t equals) {
  const auto value = ParseDecimal(word.substr(equals + 1));
  if (value) {
    const ValidRange& range = RangeOf(word.substr(0, equals));
    if (*value >= range.low && *value <= range.high) return *value;
    throw InputError({"cannot hold '" + word.substr(0, equals) + "'", "",
                      "'" + word.substr(equals + 1) + "' is out of its range",
                      "choose one of " + std::string(range.words)});
  }
  throw InputError({"cannot hold '" + word.substr(0, equals) + "'", "",
                    "'" + word.substr(equals + 1) + "' is not a number",
                    "give its value, as " + word.substr(0, equals) + "=458.6"});
}

}  // namespace

void HoldParameters(const std::vector<std::string>& names, CameraProblem* problem) {
  if (names.empty()) return;
  const std::vector<std::string> known_names = CameraModel::ParameterNames(problem->model);
  problem->fixed.assign(known_names.size(), false);
  problem->known = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(known_names.size()),
                                             std::numeric_limits<double>::quiet_NaN());
  for (const std::string& word : names) {
    const size_t equals = word.find('=');
    const std::string name = word.substr(0, equals);
    const auto found = std::find(known_names.begin(), known_names.end(), name);
    if (found == known_names.end()) {
      std::string list;
      for (const std::string& known : known_names) list += (list.empty() ? "" : ", ") + known;
      throw InputError({"cannot hold '" + name + "'", "",
                        problem->model + " has no parameter of that name", "choose from " + list});
    }
    const auto index = found - known_names.begin();
    if (problem->fixed[static_cast<size_t>(index)]) {
      throw InputError({"cannot hold '" + name + "'", "", "it is given twice", "leave one out"});
    }
    problem->fixed[static_cast<size_t>(index)] = true;
    if (equals != std::string::npos) {
      problem->known(index) = ValueOf(word, equals);
    } else if (index >= CameraModel::NumIntrinsics(problem->model)) {
      problem->known(index) = 0.0;
    }
  }
  if (std::find(problem->fixed.begin(), problem->fixed.end(), false) == problem->fixed.end()) {
    throw InputError(
        {"nothing to estimate", "", "every parameter is held", "leave at least one out of --fix"});
  }
}

std::vector<bool> HeldAtTheirEstimate(const CameraProblem& problem) {
  std::vector<bool> held = problem.fixed;
  const auto centre = static_cast<size_t>(CameraModel::FocalIndex(problem.model) + 2);
  for (size_t i = 0; i < held.size(); ++i) {
    const bool is_centre = i == centre || i == centre + 1;
    if (is_centre || !std::isnan(problem.known(static_cast<Eigen::Index>(i)))) held[i] = false;
  }
  return held;
}

CameraCalibration CalibrateCamera(const CameraProblem& problem, int max_iterations) {
  CameraRigProblem rig;
  rig.cameras = {problem};
  rig.frame_of_view.emplace_back(problem.views.size());
  std::iota(rig.frame_of_view[0].begin(), rig.frame_of_view[0].end(), 0);
  return CalibrateCameraRig(rig, max_iterations).cameras.front();
}

}  // namespace calibrato
