#include "calibrato/diagnosis/camera_imu_parts.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include "calibrato/base/parallel.h"
#include "calibrato/calibration/camera_imu_layout.h"

namespace calibrato {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

bool HasAllSensors(const CameraImuProblem& problem) {
  for (const CameraImuCamera& camera : problem.cameras) {
    if (camera.views.empty()) return false;
  }
  for (const CameraImuImu& imu : problem.imus) {
    if (imu.stream.gyro.empty() || imu.stream.accel.empty()) return false;
  }
  return true;
}

Time EndOf(const CameraImuState& state) {
  return state.start + Duration::FromSeconds(state.T_g_i.duration_s());
}

// The problem with all noise given, as it was given or found, and nothing known from before: its
// parts are to have nothing in common.
CameraImuProblem WithNoiseAsFound(CameraImuProblem problem,
                                  const CameraImuCalibration& calibration) {
  problem.prior.reset();
  problem.corner_noise_px = calibration.weights.corner_noise_px;
  for (size_t n = 0; n < problem.imus.size(); ++n) {
    problem.imus[n].noise = NoiseAsFound(problem.imus[n].noise, calibration.weights.imus[n]);
  }
  return problem;
}

// The beginning of a trajectory with its biases.
CameraImuState FirstBlocks(const CameraImuState& state, int num_blocks) {
  const PoseSpline& spline = state.T_g_i;
  const std::vector<Rigid3>& points = spline.control_points();
  CameraImuState first = state;
  first.T_g_i = PoseSpline(spline.order(), spline.spacing_s(),
                           {points.begin(), points.begin() + num_blocks * (spline.order() - 1)});
  for (ImuCalibrationState& imu : first.imus) imu.biases.resize(static_cast<size_t>(num_blocks));
  return first;
}

}  // namespace

ImuNoise NoiseAsFound(ImuNoise noise, const CameraImuWeights::Imu& weights) {
  noise.gyro_noise_density = weights.gyro_stddev / std::sqrt(noise.rate_hz);
  noise.accel_noise_density = weights.accel_stddev / std::sqrt(noise.rate_hz);
  return noise;
}

CameraImuProblem PartOf(const CameraImuProblem& problem, Time begin, Time end) {
  CameraImuProblem part = problem;
  const auto is_outside = [&](const auto& item) {
    return !(begin <= item.stamp && item.stamp < end);
  };
  for (CameraImuCamera& camera : part.cameras) std::erase_if(camera.views, is_outside);
  for (CameraImuImu& imu : part.imus) {
    std::erase_if(imu.stream.gyro, is_outside);
    std::erase_if(imu.stream.accel, is_outside);
  }
  return part;
}

std::optional<CameraImuSplit> CheckSplit(const CameraImuProblem& problem,
                                         const CameraImuCalibration& calibration) {
  if (!calibration.state) return std::nullopt;
  const CameraImuState& state = *calibration.state;
  const CameraImuProblem known = WithNoiseAsFound(problem, calibration);
  const Time begin = state.start;
  const Time end = EndOf(state);
  const Time middle = begin + Duration::FromNanoseconds((end - begin).nanoseconds() / 2);
  CameraImuOptions options;
  options.spline_order = state.T_g_i.order();
  options.knot_spacing_s = calibration.knot_spacing_s;

  const std::array<std::pair<Time, Time>, 2> spans = {{{begin, middle}, {middle, end}}};
  std::array<CameraImuCalibration, 2> halves;
  for (size_t h = 0; h < 2; ++h) {
    const CameraImuProblem half = PartOf(known, spans[h].first, spans[h].second);
    if (!HasAllSensors(half)) return std::nullopt;
    halves[h] = CalibrateCameraImu(half, options);
    if (halves[h].termination != Termination::kConverged) return std::nullopt;
  }

  const CameraImuLayout layout(problem, state.T_g_i.order());
  CameraImuSplit split;
  for (size_t n = 0; n < problem.cameras.size(); ++n) {
    const CameraCalibrationState& first = halves[0].state->cameras[n];
    const CameraCalibrationState& second = halves[1].state->cameras[n];
    CameraImuSplit::Camera camera;
    camera.difference << second.T_c_i.DifferenceTo(first.T_c_i),
        second.time_offset_s - first.time_offset_s;
    Eigen::Matrix<double, 7, 7> covariance = Eigen::Matrix<double, 7, 7>::Zero();
    std::vector<Eigen::Index> columns;
    for (int k = 0; k < 6; ++k) columns.push_back(layout.cameras[n].pose + k);
    if (layout.cameras[n].time_offset >= 0) columns.push_back(layout.cameras[n].time_offset);
    const auto size = static_cast<Eigen::Index>(columns.size());
    for (const CameraImuCalibration& half : halves) {
      covariance.topLeftCorner(size, size) += half.information.covariance(columns, columns);
    }
    camera.sigma = covariance.diagonal().cwiseSqrt();
    camera.significance = SignificanceOf(camera.difference, covariance);
    split.cameras.push_back(camera);
  }
  return split;
}

std::vector<CameraImuKnowledge> KnowledgeOverTime(const CameraImuProblem& problem,
                                                  const CameraImuCalibration& calibration,
                                                  int max_parts) {
  assert(calibration.state.has_value());
  const CameraImuLayout layout(problem, calibration.state->T_g_i.order());
  const CameraImuLayout::Camera& columns = layout.cameras.front();
  const CameraImuProblem known = WithNoiseAsFound(problem, calibration);
  const int num_steps = calibration.state->num_blocks() - 1;
  const int num_parts = std::min(max_parts, num_steps);
  return ParallelMap<CameraImuKnowledge>(static_cast<size_t>(num_parts), [&](size_t k) {
    const int num_blocks = 1 + num_steps * (static_cast<int>(k) + 1) / num_parts;
    const CameraImuState state = FirstBlocks(*calibration.state, num_blocks);
    CameraImuKnowledge knowledge{state.T_g_i.duration_s(), kNan, kNan, kNan};
    const CameraImuProblem part = PartOf(known, state.start, EndOf(state));
    if (!HasAllSensors(part)) return knowledge;
    const std::vector<double> sigmas = SigmasOf(InformationAt(part, state));
    const auto sum = [&](int first, int size) {
      double squared = 0.0;
      for (int i = first; i < first + size; ++i) squared += sigmas[size_t(i)] * sigmas[size_t(i)];
      return std::sqrt(squared);
    };
    knowledge.rotation_sigma_rad = sum(columns.pose, 3);
    knowledge.translation_sigma_m = sum(columns.pose + 3, 3);
    if (columns.time_offset >= 0) knowledge.time_offset_sigma_s = sum(columns.time_offset, 1);
    return knowledge;
  });
}

std::vector<double> SigmasOf(const CameraImuInformation& information) {
  const size_t size = information.names.size();
  std::vector<double> sigmas(size, kNan);
  const Eigen::MatrixXd& matrix = information.information_matrix;
  if (matrix.size() == 0) return sigmas;
  if (information.covariance.size() != 0) {
    for (size_t i = 0; i < size; ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      sigmas[i] = std::sqrt(information.covariance(k, k));
    }
    return sigmas;
  }
  // Directions in which the information, scaled to a unit diagonal, is nothing but rounding.
  constexpr double kUndetermined = 1e-12;
  // What of a parameter may lie in them all the same, for the same reason.
  constexpr double kRoundedShare = 1e-8;
  const Eigen::VectorXd scale =
      matrix.diagonal().cwiseMax(std::numeric_limits<double>::min()).cwiseSqrt().cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(scale.asDiagonal() * matrix *
                                                              scale.asDiagonal());
  for (size_t i = 0; i < size; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    double undetermined = 0.0;
    double variance = 0.0;
    for (Eigen::Index j = 0; j < matrix.rows(); ++j) {
      const double share = solver.eigenvectors()(k, j) * solver.eigenvectors()(k, j);
      if (solver.eigenvalues()(j) > kUndetermined) {
        variance += share / solver.eigenvalues()(j);
      } else {
        undetermined += share;
      }
    }
    if (undetermined < kRoundedShare) sigmas[i] = scale(k) * std::sqrt(variance);
  }
  return sigmas;
}

}  // namespace calibrato
