#include "calibrato/diagnosis/camera_imu_parts.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "calibrato/base/parallel.h"
#include "calibrato/calibration/camera_imu_layout.h"
#include "calibrato/calibration/chi_square.h"

namespace calibrato {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Between a part and the whole [s].
constexpr double kLargestOffsetOfParts = 0.05;
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

// Spans of equal length, each calibrated alone.
std::optional<std::vector<CameraImuCalibration>> CalibrateParts(
    const CameraImuProblem& problem, const CameraImuCalibration& calibration, int num_parts) {
  if (!calibration.state) return std::nullopt;
  const CameraImuState& state = *calibration.state;
  CameraImuProblem known = WithNoiseAsFound(problem, calibration);
  for (size_t n = 0; n < known.cameras.size(); ++n) {
    CameraImuCamera& camera = known.cameras[n];
    // What is known of a lens from elsewhere is common to all parts, and no part's own.
    if (camera.intrinsics == IntrinsicsKnowledge::kPrior) {
      camera.intrinsics = IntrinsicsKnowledge::kExact;
      camera.model = state.cameras[n].model;
    }
    // On the clock of IMU 0, so that a short part looks for its offset where the whole found it.
    for (BoardView& view : camera.views) {
      view.stamp = view.stamp + Duration::FromSeconds(state.cameras[n].time_offset_s);
    }
  }
  CameraImuOptions options;
  options.spline_order = state.T_g_i.order();
  options.knot_spacing_s = calibration.knot_spacing_s;
  options.max_time_offset_s = kLargestOffsetOfParts;
  const int64_t duration = (EndOf(state) - state.start).nanoseconds();
  const auto edge = [&](int k) {
    return state.start + Duration::FromNanoseconds(duration / num_parts * k);
  };
  std::vector<CameraImuCalibration> parts;
  for (int k = 0; k < num_parts; ++k) {
    const CameraImuProblem part = PartOf(known, edge(k), edge(k + 1));
    if (!HasAllSensors(part)) return std::nullopt;
    parts.push_back(CalibrateCameraImu(part, options));
    if (parts.back().termination != Termination::kConverged) return std::nullopt;
  }
  return parts;
}

// Rotation and translation of a camera's T_c_i, and its time offset unless that is held.
VectorXd DifferenceOf(const CameraImuCalibration& to, const CameraImuCalibration& from,
                      const CameraImuProblem& problem, size_t camera) {
  const CameraCalibrationState& of_to = to.state->cameras[camera];
  const CameraCalibrationState& of_from = from.state->cameras[camera];
  VectorXd difference(7);
  difference << of_to.T_c_i.DifferenceTo(of_from.T_c_i),
      of_to.time_offset_s - of_from.time_offset_s;
  return difference.head(problem.estimate_time_offsets ? 7 : 6);
}

MatrixXd CovarianceOf(const CameraImuCalibration& calibration, const CameraImuProblem& problem,
                      size_t camera) {
  const CameraImuLayout layout(problem, calibration.state->T_g_i.order());
  const CameraImuLayout::Camera& columns = layout.cameras[camera];
  std::vector<Eigen::Index> used;
  for (int k = 0; k < 6; ++k) used.push_back(columns.pose + k);
  if (columns.time_offset >= 0) used.push_back(columns.time_offset);
  return calibration.information.covariance(used, used);
}

}  // namespace

double CameraImuScatter::sigma_scale() const {
  return probability < kSignificance ? std::sqrt(ratio) : 1.0;
}

ImuNoise NoiseAsFound(ImuNoise noise, const CameraImuWeights::Imu& weights) {
  noise.gyro_noise_density = weights.gyro_stddev / std::sqrt(weights.gyro_rate_hz);
  noise.accel_noise_density = weights.accel_stddev / std::sqrt(weights.accel_rate_hz);
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

std::optional<CameraImuScatter> ScatterOfParts(const CameraImuProblem& problem,
                                               const CameraImuCalibration& calibration,
                                               int num_parts) {
  assert(num_parts >= 2);
  const auto parts = CalibrateParts(problem, calibration, num_parts);
  if (!parts) return std::nullopt;
  CameraImuScatter scatter;
  scatter.num_parts = num_parts;
  scatter.ratio = 0.0;
  const auto num_cameras = static_cast<double>(problem.cameras.size());
  for (size_t n = 0; n < problem.cameras.size(); ++n) {
    std::vector<MatrixXd> weights;
    std::vector<VectorXd> differences;
    MatrixXd sum_of_weights;
    VectorXd weighted_sum;
    for (const CameraImuCalibration& part : *parts) {
      differences.push_back(DifferenceOf(part, parts->front(), problem, n));
      weights.push_back(CovarianceOf(part, problem, n).inverse());
      if (weights.size() == 1) {
        sum_of_weights = MatrixXd::Zero(weights[0].rows(), weights[0].cols());
        weighted_sum = VectorXd::Zero(weights[0].rows());
      }
      sum_of_weights += weights.back();
      weighted_sum += weights.back() * differences.back();
    }
    const VectorXd mean = sum_of_weights.ldlt().solve(weighted_sum);
    double squared = 0.0;
    for (size_t k = 0; k < parts->size(); ++k) {
      squared += (differences[k] - mean).dot(weights[k] * (differences[k] - mean));
    }
    const auto degrees = static_cast<double>((num_parts - 1) * mean.size());
    scatter.ratio = std::max(scatter.ratio, squared / degrees);
    scatter.probability =
        std::min(scatter.probability, num_cameras * ChiSquareTail(squared, degrees));
  }
  return scatter;
}

std::optional<CameraImuSplit> CheckSplit(const CameraImuProblem& problem,
                                         const CameraImuCalibration& calibration,
                                         double sigma_scale) {
  const auto halves = CalibrateParts(problem, calibration, 2);
  if (!halves) return std::nullopt;
  CameraImuSplit split;
  for (size_t n = 0; n < problem.cameras.size(); ++n) {
    const VectorXd difference = DifferenceOf((*halves)[1], (*halves)[0], problem, n);
    MatrixXd covariance =
        CovarianceOf((*halves)[0], problem, n) + CovarianceOf((*halves)[1], problem, n);
    covariance *= sigma_scale * sigma_scale;
    CameraImuSplit::Camera camera;
    camera.difference.setZero();
    camera.sigma.setZero();
    camera.difference.head(difference.size()) = difference;
    camera.sigma.head(difference.size()) = covariance.diagonal().cwiseSqrt();
    camera.significance = SignificanceOf(difference, covariance);
    split.cameras.push_back(camera);
  }
  return split;
}

std::vector<CameraImuKnowledge> KnowledgeOverTime(const CameraImuProblem& problem,
                                                  const CameraImuCalibration& calibration,
                                                  int max_parts, double sigma_scale) {
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
      return sigma_scale * std::sqrt(squared);
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
