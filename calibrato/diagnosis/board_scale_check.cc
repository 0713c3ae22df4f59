#include "calibrato/diagnosis/board_scale_check.h"

#include <cassert>
#include <cmath>
#include <utility>

#include "calibrato/calibration/arrowhead.h"
#include "calibrato/calibration/camera_imu_layout.h"
#include "calibrato/calibration/camera_imu_linearisation.h"
#include "calibrato/calibration/camera_imu_measurements.h"

namespace calibrato {
namespace {

// Boards are printed and measured to better than this; lenses that fit badly and accelerometers
// that are a little off look like less.
constexpr double kMinDeviation = 0.005;
constexpr double kMinSigmas = 5.0;
constexpr double kFailDeviation = 0.01;

bool IsOff(double scale, double sigma) {
  const double deviation = std::abs(scale - 1.0);
  return deviation > kMinDeviation && deviation > kMinSigmas * sigma;
}

// The size after one step from the calibration, and its standard deviation.
struct ScaleStep {
  double scale = 1.0;
  double sigma = 0.0;
};

std::optional<ScaleStep> OneStep(const CameraImuProblem& with_scale,
                                 const CameraImuCalibration& calibration) {
  const CameraImuState& state = *calibration.state;
  const CameraImuLayout layout(with_scale, state.T_g_i.order());
  ArrowheadSystem system(state.num_blocks(), layout.block_size, layout.border_size);
  if (!Linearise(with_scale, state, layout, MeasurementsOf(with_scale, state, calibration.inliers),
                 calibration.weights, &system)) {
    return std::nullopt;
  }
  const auto factor = ArrowheadCholesky::Factor(system, 0.0);
  if (!factor) return std::nullopt;
  const auto covariance = CovarianceFromInformation(factor->BorderInformation(), {});
  if (!covariance) return std::nullopt;
  const Eigen::VectorXd border = factor->Step().tail(layout.border_size);
  return ScaleStep{1.0 + border(layout.board_scale),
                   std::sqrt((*covariance)(layout.board_scale, layout.board_scale))};
}

}  // namespace

std::optional<BoardScaleCheck> CheckBoardScale(const CameraImuProblem& problem,
                                               const CameraImuCalibration& calibration) {
  assert(calibration.state.has_value() && !problem.estimate_board_scale);
  CameraImuProblem with_scale = problem;
  with_scale.estimate_board_scale = true;
  // What earlier recordings say was said with the size held.
  with_scale.prior.reset();
  if (calibration.termination == Termination::kConverged) {
    const auto step = OneStep(with_scale, calibration);
    if (!step || !IsOff(step->scale, step->sigma)) return std::nullopt;
  }
  CameraImuOptions options;
  options.spline_order = calibration.state->T_g_i.order();
  options.knot_spacing_s = calibration.knot_spacing_s;
  BoardScaleCheck check;
  check.calibration = CalibrateCameraImu(with_scale, options);
  if (check.calibration.termination != Termination::kConverged) return std::nullopt;
  const CameraImuLayout layout(with_scale, options.spline_order);
  check.scale = check.calibration.state->board_scale;
  check.sigma =
      std::sqrt(check.calibration.information.covariance(layout.board_scale, layout.board_scale));
  if (!IsOff(check.scale, check.sigma)) return std::nullopt;
  return check;
}

Finding BoardScaleFinding(const BoardScaleCheck& check) {
  const double deviation = std::abs(check.scale - 1.0);
  return {
      deviation > kFailDeviation ? Severity::kFail : Severity::kWarn,
      Format("the board is %.2f %% %s than its target says (+- %.2f), by the accelerometer",
             100.0 * deviation, check.scale > 1.0 ? "larger" : "smaller", 100.0 * check.sigma),
      Format("measure the board; lengths in the target are to be multiplied by %.4f", check.scale)};
}

}  // namespace calibrato
