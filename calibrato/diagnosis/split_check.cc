#include "calibrato/diagnosis/split_check.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "calibrato/calibration/bundle_adjustment.h"
#include "calibrato/calibration/information.h"
#include "calibrato/calibration/view_fit.h"

namespace calibrato {
namespace {

constexpr size_t kRunsPerHalf = 5;
constexpr int kPoseIterations = 20;

struct Half {
  std::vector<BoardView> views;
  std::vector<Rigid3> T_c_g;
  std::optional<CameraModel> model;
  Eigen::MatrixXd information;  // For noise of 1 px.
  Eigen::MatrixXd covariance;   // For noise of 1 px.
  double squared_error_px2 = 0.0;
  int degrees = 0;
};

std::array<Half, 2> Deal(const CameraCalibration& calibration) {
  const size_t num_views = calibration.used_views.size();
  const size_t run = std::max<size_t>(1, num_views / (2 * kRunsPerHalf));
  std::array<Half, 2> halves;
  for (size_t v = 0; v < num_views; ++v) {
    Half& half = halves[(v / run) % 2];
    half.views.push_back(calibration.used_views[v]);
    half.T_c_g.push_back(calibration.T_c_g[v]);
  }
  return halves;
}

int NumCorners(const std::vector<BoardView>& views) {
  int count = 0;
  for (const BoardView& view : views) count += static_cast<int>(view.num_corners());
  return count;
}

// False where this half leaves the camera open.
bool Fit(const CameraModel& start, const std::vector<bool>& fixed, Half* half) {
  if (half->views.size() < static_cast<size_t>(kMinViews)) return false;
  BundleAdjustmentState state;
  state.models = {start};
  state.T_c0_g = half->T_c_g;
  BundleAdjustmentOptions options;
  options.fixed_parameters = {fixed};
  const BundleAdjustmentResult result = AdjustBundle(state, ViewsOfOneCamera(half->views), options);
  if (result.termination != Termination::kConverged) return false;
  half->model = result.state.models[0];
  half->T_c_g = result.state.T_c0_g;
  half->squared_error_px2 = result.cost_px2;
  half->information = CameraInformation(*half->model, half->T_c_g, half->views, fixed);
  const auto covariance = CovarianceFromInformation(half->information, fixed);
  const auto num_held = static_cast<int>(std::count(fixed.begin(), fixed.end(), true));
  half->degrees = 2 * NumCorners(half->views) - 6 * static_cast<int>(half->views.size()) -
                  (start.num_parameters() - num_held);
  if (!covariance || half->degrees <= 0) return false;
  half->covariance = *covariance;
  return true;
}

// The squared error of one half's views as the other half's camera sees them.
double SquaredErrorOf(const Half& views, const CameraModel& model) {
  double sum = 0.0;
  for (size_t v = 0; v < views.views.size(); ++v) {
    const Rigid3 T_c_g = RefinedPose(model, views.views[v], views.T_c_g[v], kPoseIterations);
    sum += ReprojectionResiduals(model, views.views[v], T_c_g).squaredNorm();
  }
  return sum;
}

}  // namespace

std::optional<SplitCheck> CheckSplit(const CameraCalibration& calibration,
                                     const std::vector<bool>& fixed) {
  if (!calibration.model || calibration.covariance.size() == 0) return std::nullopt;
  auto [a, b] = Deal(calibration);
  if (!Fit(*calibration.model, fixed, &a) || !Fit(*calibration.model, fixed, &b)) {
    return std::nullopt;
  }
  SplitCheck check;
  check.parameters = {a.model->parameters(), b.model->parameters()};
  check.degrees = a.degrees + b.degrees;
  const double variance_a = a.squared_error_px2 / a.degrees;
  const double variance_b = b.squared_error_px2 / b.degrees;
  const Eigen::MatrixXd covariance = variance_a * a.covariance + variance_b * b.covariance;
  check.sigma = covariance.diagonal().cwiseSqrt();
  check.significance = SignificanceOf(check.parameters[1] - check.parameters[0], covariance);

  // A view's residuals have 2N - 6 degrees of freedom left when its pose is fitted to it. To these
  // the camera's own error adds trace(information of the views x covariance of the camera).
  const double variance = (a.squared_error_px2 + b.squared_error_px2) / check.degrees;
  const auto num_views = static_cast<double>(a.views.size() + b.views.size());
  const double held_out_degrees = 2.0 * calibration.num_corners - 6.0 * num_views;
  const double by_camera =
      (a.information * b.covariance).trace() + (b.information * a.covariance).trace();
  check.in_sample_stddev_px = std::sqrt(variance);
  check.expected_held_out_stddev_px = std::sqrt(variance * (1.0 + by_camera / held_out_degrees));
  check.held_out_stddev_px =
      std::sqrt((SquaredErrorOf(b, *a.model) + SquaredErrorOf(a, *b.model)) / held_out_degrees);
  return check;
}

}  // namespace calibrato
