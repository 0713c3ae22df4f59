#include "calibrato/diagnosis/imu_model_comparison.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "calibrato/calibration/arrowhead.h"
#include "calibrato/calibration/camera_imu_layout.h"
#include "calibrato/calibration/camera_imu_linearisation.h"
#include "calibrato/calibration/camera_imu_measurements.h"

namespace calibrato {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kFurther =
    24;  // Parameters of kScaleMisalignment; first among those of richer kinds.

Significance SignificanceOfFall(double fall, double degrees, double sigma_scale) {
  Significance significance;
  significance.statistic = fall / (sigma_scale * sigma_scale);
  significance.degrees = degrees;
  significance.probability = ChiSquareTail(significance.statistic, degrees);
  return significance;
}

std::vector<Eigen::Vector<double, 6>> PosesIn(const VectorXd& border,
                                              const CameraImuLayout& layout) {
  std::vector<Eigen::Vector<double, 6>> poses;
  for (const CameraImuLayout::Camera& camera : layout.cameras) {
    poses.emplace_back(border.segment<6>(camera.pose));
  }
  return poses;
}

// One step with further parameters, from where the simple model ended.
std::optional<ImuModelComparison> ByScore(CameraImuProblem problem,
                                          const CameraImuCalibration& simple, double sigma_scale) {
  // Its columns are those of the simple model.
  if (problem.prior) return std::nullopt;
  for (CameraImuImu& imu : problem.imus) imu.model = ImuModelKind::kScaleMisalignment;
  const CameraImuState& state = *simple.state;
  const CameraImuLayout layout(problem, state.T_g_i.order());
  ArrowheadSystem system(state.num_blocks(), layout.block_size, layout.border_size);
  if (!Linearise(problem, state, layout, MeasurementsOf(problem, state, simple.inliers),
                 simple.weights, &system)) {
    return std::nullopt;
  }
  const auto factor = ArrowheadCholesky::Factor(system, 0.0);
  if (!factor) return std::nullopt;
  const VectorXd step = factor->Step();
  const double fall = -system.Gradient().dot(step);
  if (!(fall >= 0.0)) return std::nullopt;
  const auto degrees = static_cast<double>(kFurther * problem.imus.size());
  return ImuModelComparison{SignificanceOfFall(fall, degrees, sigma_scale),
                            PosesIn(step.tail(layout.border_size), layout), true};
}

// What the estimates of the further parameters say, and how the rest moves when they are held at
// those of a perfect IMU.
std::optional<ImuModelComparison> ByEstimates(const CameraImuProblem& problem,
                                              const CameraImuCalibration& rich,
                                              double sigma_scale) {
  const MatrixXd& covariance = rich.information.covariance;
  if (covariance.size() == 0) return std::nullopt;
  const CameraImuLayout layout(problem, rich.state->T_g_i.order());
  CameraImuState perfect = *rich.state;
  std::vector<Eigen::Index> further;
  for (size_t n = 0; n < problem.imus.size(); ++n) {
    if (layout.imus[n].intrinsics < 0) continue;
    perfect.imus[n].intrinsics = {};
    for (int k = 0; k < kFurther; ++k) further.push_back(layout.imus[n].intrinsics + k);
  }
  const VectorXd difference = CalibrationDifference(*rich.state, perfect, layout)(further);
  const VectorXd weighted = covariance(further, further).ldlt().solve(difference);
  const VectorXd change = covariance(Eigen::all, further) * weighted;
  return ImuModelComparison{SignificanceOfFall(difference.dot(weighted),
                                               static_cast<double>(further.size()), sigma_scale),
                            PosesIn(change, layout), false};
}

}  // namespace

std::optional<ImuModelComparison> CompareImuModels(const CameraImuProblem& problem,
                                                   const CameraImuCalibration& calibration,
                                                   double sigma_scale) {
  if (calibration.termination != Termination::kConverged) return std::nullopt;
  const bool is_simple =
      std::all_of(problem.imus.begin(), problem.imus.end(),
                  [](const CameraImuImu& imu) { return imu.model == ImuModelKind::kCalibrated; });
  return is_simple ? ByScore(problem, calibration, sigma_scale)
                   : ByEstimates(problem, calibration, sigma_scale);
}

}  // namespace calibrato
