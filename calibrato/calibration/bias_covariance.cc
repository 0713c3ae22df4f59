#include "calibrato/calibration/bias_covariance.h"

#include <cassert>

#include "calibrato/calibration/arrowhead.h"
#include "calibrato/calibration/camera_imu_layout.h"
#include "calibrato/calibration/camera_imu_linearisation.h"

namespace calibrato {
namespace {

using Eigen::MatrixXd;

// The mean biases of all IMUs as linear functions of the unknowns, a column each.
MatrixXd MeansOfBiases(const CameraImuState& state, const CameraImuLayout& layout) {
  const int num_blocks = state.num_blocks();
  assert(state.imus.front().biases.size() == static_cast<size_t>(num_blocks));
  const auto num_imus = static_cast<int>(state.imus.size());
  MatrixXd means =
      MatrixXd::Zero(num_blocks * layout.block_size + layout.border_size, 6 * num_imus);
  for (int imu = 0; imu < num_imus; ++imu) {
    for (int c = 0; c < num_blocks; ++c) {
      means.block<6, 6>(c * layout.block_size + layout.BiasColumn(imu, 0), 6 * imu)
          .diagonal()
          .setConstant(1.0 / num_blocks);
    }
  }
  return means;
}

}  // namespace

NamedCovariance CovarianceWithBiases(const CameraImuProblem& problem,
                                     const CameraImuCalibration& calibration) {
  assert(calibration.state.has_value());
  const CameraImuState& state = *calibration.state;
  const MatrixXd& of_border = calibration.information.covariance;
  if (of_border.size() == 0) return {};
  const CameraImuLayout layout(problem, state.T_g_i.order());
  ArrowheadSystem system(state.num_blocks(), layout.block_size, layout.border_size);
  if (!Linearise(problem, state, layout, MeasurementsOf(problem, state, calibration.inliers),
                 calibration.weights, &system)) {
    return {};
  }
  const auto factor = ArrowheadCholesky::Factor(system, 0.0);
  if (!factor) return {};
  const MatrixXd means = MeansOfBiases(state, layout);
  const MatrixXd solved = factor->Solve(means);
  const Eigen::Index m = layout.border_size;
  const Eigen::Index k = means.cols();

  NamedCovariance covariance{calibration.information.names, MatrixXd(m + k, m + k)};
  for (size_t imu = 0; imu < state.imus.size(); ++imu) {
    for (const char* sensor : {".gyro_bias_", ".accel_bias_"}) {
      for (const char* axis : {"x", "y", "z"}) {
        covariance.names.push_back("imu" + std::to_string(imu) + sensor + axis);
      }
    }
  }
  const MatrixXd across = solved.bottomRows(m);
  const MatrixXd of_biases = means.transpose() * solved;
  covariance.matrix.topLeftCorner(m, m) = of_border;
  covariance.matrix.topRightCorner(m, k) = across;
  covariance.matrix.bottomLeftCorner(k, m) = across.transpose();
  covariance.matrix.bottomRightCorner(k, k) = 0.5 * (of_biases + of_biases.transpose());
  return covariance;
}

}  // namespace calibrato
