#include "calibrato/calibration/camera_calibration.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "calibrato/base/input_error.h"
#include "calibrato/calibration/start_values.h"

namespace calibrato {
namespace {

void CheckViews(const CameraProblem& problem) {
  for (const BoardView& view : problem.views) {
    const double extent = view.points_g.cwiseAbs().maxCoeff();
    if (!(view.points_g.row(2).cwiseAbs().maxCoeff() <= 1e-9 * (1.0 + extent))) {
      throw InputError({"the board is not flat", "view " + view.name,
                        "its points do not lie in the plane z = 0",
                        "give the corners in a frame whose x and y span the board"});
    }
  }
}

}  // namespace

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
    if (index >= 4) problem->known(index) = 0.0;
  }
  if (std::find(problem->fixed.begin(), problem->fixed.end(), false) == problem->fixed.end()) {
    throw InputError(
        {"nothing to estimate", "", "every parameter is held", "leave at least one out of --fix"});
  }
}

CameraCalibration CalibrateCamera(const CameraProblem& problem, int max_iterations) {
  CheckViews(problem);
  CameraCalibration result;
  result.coverage = CoverageOf(problem.views, problem.resolution);
  if (problem.views.size() < static_cast<size_t>(kMinViews)) return result;
  const auto start =
      FindStartValues(problem.model, problem.resolution, problem.views, problem.known);
  if (!start || start->used_views.size() < static_cast<size_t>(kMinViews)) return result;
  for (const size_t v : start->used_views) result.used_views.push_back(problem.views[v]);

  BundleAdjustmentOptions options;
  options.max_iterations = max_iterations;
  options.fixed_parameters = problem.fixed;
  BundleAdjustmentResult adjusted = AdjustBundle(start->state, result.used_views, options);

  result.termination = adjusted.termination;
  result.model = adjusted.state.model;
  for (size_t v = 0; v < result.used_views.size(); ++v) {
    const BoardView& view = result.used_views[v];
    result.num_corners += static_cast<int>(view.num_corners());
    result.residuals.push_back(ReprojectionResiduals(*result.model, view, adjusted.state.T_c_g[v]));
  }
  result.reprojection_rms_px = std::sqrt(adjusted.squared_error_px2 / result.num_corners);

  const auto num_free =
      result.model->num_parameters() -
      static_cast<int>(std::count(problem.fixed.begin(), problem.fixed.end(), true));
  const int num_degrees =
      2 * result.num_corners - num_free - 6 * static_cast<int>(result.used_views.size());
  const auto covariance = CovarianceFromInformation(
      CameraInformation(adjusted.state, result.used_views, problem.fixed), problem.fixed);
  result.T_c_g = std::move(adjusted.state.T_c_g);
  if (!covariance || num_degrees <= 0) {
    result.termination = Termination::kRankDeficient;
    return result;
  }
  const double variance = adjusted.squared_error_px2 / num_degrees;
  result.noise_stddev_px = std::sqrt(variance);
  result.covariance = variance * *covariance;
  result.information =
      InformationOf(result.covariance.topLeftCorner<4, 4>(), Eigen::Vector4d::Ones());
  return result;
}

}  // namespace calibrato
