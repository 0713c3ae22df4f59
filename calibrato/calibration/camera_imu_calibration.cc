#include "calibrato/calibration/camera_imu_calibration.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cassert>
#include <cmath>

#include "calibrato/base/input_error.h"
#include "calibrato/calibration/arrowhead.h"
#include "calibrato/calibration/knot_spacing.h"
#include "calibrato/calibration/outliers.h"

namespace calibrato {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Where the next step promises to lower the sum of squared whitened residuals by less than this,
// the estimate lies within a hundredth of the standard deviation of any combination of unknowns:
// the decrease is the squared distance to the minimum in that measure.
constexpr double kConverged = 1e-4;
// Squared distance of the calibration alone to the linearised minimum: a twentieth of the standard
// deviation of any combination of its parameters.
constexpr double kSettled = 2.5e-3;
// As a share of the cost: enough to look for outliers.
constexpr double kNearlyConverged = 1e-3;
// Gauss-Newton until a step fails: diagonals of H are larger than its eigenvalues of slow motion by
// many orders of magnitude, so that even a little damping slows it down.
constexpr double kLeastDamping = 1e-10;
constexpr double kLargestDamping = 1e8;
// Where the normal equations determine nothing without damping, a step that is damped more than
// this promises little wherever it is taken.
constexpr double kNewtonDamping = 1e-3;
constexpr int kOutlierRounds = 4;
constexpr int kNoiseRounds = 4;
// Fewer outliers than this share of the measurements can't pull far.
constexpr double kFewOutliers = 1e-3;
// Of Cauchy's loss, while outliers are looked for.
constexpr double kLossScale = 3.0;
// A vector of three has the tail of a corner's five sigmas from here on.
constexpr double kSampleOutlierSigmas = 5.3;
constexpr double kMedianOfChiSquare3 = 2.366;
constexpr double kLinearTurn = 0.1;  // [rad]

void CheckProblem(const CameraImuProblem& problem) {
  const auto fail = [](const std::string& what, const std::string& remedy) {
    throw InputError({what, "", "", remedy});
  };
  if (problem.cameras.empty()) fail("no camera to calibrate", "give at least one camera");
  if (problem.imus.empty()) fail("no IMU to calibrate", "give at least one IMU");
  for (size_t n = 0; n < problem.cameras.size(); ++n) {
    if (problem.cameras[n].views.empty()) {
      fail("camera " + std::to_string(n) + " never saw the board",
           "check the target file and the images");
    }
  }
  for (size_t n = 0; n < problem.imus.size(); ++n) {
    if (problem.imus[n].stream.gyro.empty() || problem.imus[n].stream.accel.empty()) {
      fail("IMU " + std::to_string(n) + " has no gyroscope or no accelerometer samples",
           "check its file");
    }
  }
}

// Of a stream, by the median of its periods, which gaps leave alone [Hz]. Stamps jitter and data
// sheets round: what is within a hundredth of the stated rate is that.
double RateOf(const std::vector<VectorSample>& samples, double stated_hz) {
  std::vector<double> periods_s;
  for (size_t k = 1; k < samples.size(); ++k) {
    periods_s.push_back((samples[k].stamp - samples[k - 1].stamp).seconds());
  }
  if (periods_s.empty()) return stated_hz;
  const auto middle = periods_s.begin() + static_cast<std::ptrdiff_t>(periods_s.size() / 2);
  std::nth_element(periods_s.begin(), middle, periods_s.end());
  const double rate_hz = *middle > 0.0 ? 1.0 / *middle : stated_hz;
  return std::abs(rate_hz - stated_hz) <= 0.01 * stated_hz ? stated_hz : rate_hz;
}

CameraImuWeights WeightsOf(const CameraImuProblem& problem, double corner_noise_px) {
  CameraImuWeights weights;
  weights.corner_noise_px = corner_noise_px;
  for (const CameraImuImu& imu : problem.imus) {
    const double gyro_hz = RateOf(imu.stream.gyro, imu.noise.rate_hz);
    const double accel_hz = RateOf(imu.stream.accel, imu.noise.rate_hz);
    weights.imus.push_back({imu.noise.gyro_noise_density * std::sqrt(gyro_hz),
                            imu.noise.accel_noise_density * std::sqrt(accel_hz),
                            imu.noise.gyro_random_walk, imu.noise.accel_random_walk, gyro_hz,
                            accel_hz});
  }
  return weights;
}

CameraImuInformation InformationOfBorder(const CameraImuLayout& layout,
                                         const ArrowheadSystem& system) {
  CameraImuInformation information;
  information.names = layout.names;
  const auto factor = ArrowheadCholesky::Factor(system, 0.0);
  if (!factor) return information;
  information.information_matrix = factor->BorderInformation();
  const auto covariance = CovarianceFromInformation(information.information_matrix, {});
  if (!covariance) return information;
  information.covariance = *covariance;
  const int pose = layout.cameras.front().pose;
  const Eigen::Vector<double, 6> unit = Eigen::Vector<double, 6>::Constant(1e-3);
  information.extrinsics = InformationOf(covariance->block<6, 6>(pose, pose), unit);
  information.a_optimality_conditional =
      system.BorderBlock().block<6, 6>(pose, pose).inverse().trace();
  return information;
}

// Where some direction is not determined, or a rotation to no better than a turn over which the
// normal equations of one state say little of those at the other end: a solve walks along it
// without an end, or ends anywhere.
bool IsUndetermined(const CameraImuInformation& information, const CameraImuLayout& layout) {
  if (information.covariance.size() == 0) return true;
  const VectorXd variance = information.covariance.diagonal();
  return std::any_of(layout.cameras.begin(), layout.cameras.end(), [&](const auto& camera) {
    return !(variance.segment<3>(camera.pose).maxCoeff() <= kLinearTurn * kLinearTurn);
  });
}

// Levenberg-Marquardt on one set of measurements; it keeps the normal equations of where it is.
class Solver {
 public:
  Solver(const CameraImuProblem& problem, const CameraImuLayout& layout, CameraImuState start)
      : problem_(problem),
        layout_(layout),
        state_(std::move(start)),
        system_(state_.num_blocks(), layout.block_size, layout.border_size),
        next_system_(system_) {}

  const CameraImuState& state() const { return state_; }
  const ArrowheadSystem& system() const { return system_; }
  int num_iterations() const { return num_iterations_; }

  // Steps until the next one promises less than `tolerance`, and without damping would hardly move
  // the calibration either; or, as long as it is hardly damped, less than `share` of the cost, if
  // that is given.
  Termination Solve(const CameraImuMeasurements& measurements, const CameraImuWeights& weights,
                    double tolerance, double share, int max_iterations) {
    auto cost = Linearise(problem_, state_, layout_, measurements, weights, &system_);
    // Measurements are selected so that they project where they are taken up.
    assert(cost.has_value());
    double damping = 0.0;
    double growth = 10.0;
    while (num_iterations_ < max_iterations) {
      ++num_iterations_;
      if (const auto factor = ArrowheadCholesky::Factor(system_, damping)) {
        const VectorXd step = factor->Step();
        const double promised = PromisedDecrease(step, damping);
        if (promised < std::max(tolerance, share * *cost) &&
            (share > 0.0 ? damping < kNewtonDamping : IsAtMinimum(damping, tolerance))) {
          return Termination::kConverged;
        }
        if (auto next = std::isfinite(promised) ? Perturbed(state_, layout_, step) : std::nullopt) {
          const auto next_cost =
              Linearise(problem_, *next, layout_, measurements, weights, &next_system_);
          // Near the minimum rounding of the cost is larger than what is left to gain.
          const bool accepted = next_cost && *next_cost <= *cost + 1e-12 * *cost;
          if (accepted) {
            const double gain = (*cost - *next_cost) / promised;
            damping *= std::max(0.1, 1.0 - std::pow(2.0 * gain - 1.0, 3));
            if (damping < kLeastDamping) damping = 0.0;
            growth = 10.0;
            state_ = std::move(*next);
            std::swap(system_, next_system_);
            cost = next_cost;
            continue;
          }
        }
      }
      damping = std::max(kLeastDamping, damping * growth);
      growth *= 2.0;
      // Not even a tiny step along the gradient helps: the minimum to within rounding, or else a
      // place where the linearised problem promises what can't be had.
      if (damping > kLargestDamping) {
        return IsAtMinimum(damping, tolerance) ? Termination::kConverged
                                               : Termination::kNoStepHelps;
      }
    }
    return Termination::kIterationLimit;
  }

 private:
  // Whether there is nothing to gain without damping either, which makes steps, and what they
  // promise, small anywhere. What the trajectory does where nothing was measured (in a gap) does
  // not count: there the linearised problem promises what can't be had. The calibration does.
  bool IsAtMinimum(double damping, double tolerance) const {
    if (damping == 0.0) return true;
    const auto factor = ArrowheadCholesky::Factor(system_, 0.0);
    if (!factor) return damping < kNewtonDamping;
    const VectorXd step = factor->Step();
    if (PromisedDecrease(step, 0.0) < tolerance) return true;
    const VectorXd of_border = step.tail(layout_.border_size);
    return of_border.dot(factor->BorderInformation() * of_border) < kSettled;
  }

  // With (H + damping D) x = -g the linearised cost falls by -g x + damping x' D x.
  double PromisedDecrease(const VectorXd& step, double damping) const {
    return -system_.Gradient().dot(step) +
           damping * step.dot(system_.Diagonal().cwiseProduct(step));
  }

  const CameraImuProblem& problem_;
  const CameraImuLayout& layout_;
  CameraImuState state_;
  ArrowheadSystem system_;
  ArrowheadSystem next_system_;
  int num_iterations_ = 0;
};

// The scale of a sensor's errors over what its noise density says, at least 1: a density that is
// too small makes no outliers.
double SampleScale(const std::vector<Eigen::Vector3d>& residuals, double stddev) {
  std::vector<double> squared;
  for (const Eigen::Vector3d& residual : residuals) {
    if (residual.allFinite()) squared.push_back(residual.squaredNorm());
  }
  if (squared.empty()) return 1.0;
  const auto middle = squared.begin() + static_cast<std::ptrdiff_t>(squared.size() / 2);
  std::nth_element(squared.begin(), middle, squared.end());
  return std::max(1.0, std::sqrt(*middle / kMedianOfChiSquare3) / stddev);
}

std::vector<bool> SampleInliers(const std::vector<Eigen::Vector3d>& residuals, double stddev) {
  const double threshold = kSampleOutlierSigmas * stddev * SampleScale(residuals, stddev);
  std::vector<bool> inliers(residuals.size());
  for (size_t k = 0; k < residuals.size(); ++k) inliers[k] = residuals[k].norm() <= threshold;
  return inliers;
}

double RobustCornerNoise(const CameraImuResiduals& residuals) {
  std::vector<double> squared;
  for (const auto& views : residuals.corners_px) {
    for (const Eigen::Matrix2Xd& errors : views) {
      for (const double error : errors.colwise().squaredNorm()) {
        if (std::isfinite(error)) squared.push_back(error);
      }
    }
  }
  return NoiseFromMedian(std::move(squared));
}

CameraImuSelection InliersAmong(const CameraImuResiduals& residuals,
                                const CameraImuWeights& weights) {
  CameraImuSelection inliers;
  const double threshold =
      kOutlierSigmas * std::max(weights.corner_noise_px, RobustCornerNoise(residuals));
  for (const auto& views : residuals.corners_px) {
    auto& of_camera = inliers.corners.emplace_back();
    for (const Eigen::Matrix2Xd& errors : views) {
      auto& of_view = of_camera.emplace_back();
      for (const double squared : errors.colwise().squaredNorm()) {
        of_view.push_back(squared <= threshold * threshold);
      }
      // A view of which most corners are off is off as a whole: a wrong stamp, a wrong board.
      const auto good = std::count(of_view.begin(), of_view.end(), true);
      if (2 * good < errors.cols()) of_view.assign(of_view.size(), false);
    }
  }
  for (size_t n = 0; n < residuals.gyro.size(); ++n) {
    inliers.gyro.push_back(SampleInliers(residuals.gyro[n], weights.imus[n].gyro_stddev));
    inliers.accel.push_back(SampleInliers(residuals.accel[n], weights.imus[n].accel_stddev));
  }
  return inliers;
}

void LeaveOut(const CameraImuSuspects& suspects, CameraImuSelection* selection) {
  for (size_t n = 0; n < suspects.views.size(); ++n) {
    for (size_t v = 0; v < suspects.views[n].size(); ++v) {
      std::vector<bool>& corners = selection->corners[n][v];
      if (suspects.views[n][v]) corners.assign(corners.size(), false);
    }
  }
  const auto leave_out = [](const std::vector<bool>& suspect, std::vector<bool>* selected) {
    for (size_t k = 0; k < suspect.size(); ++k) {
      if (suspect[k]) (*selected)[k] = false;
    }
  };
  for (size_t n = 0; n < suspects.gyro.size(); ++n) {
    leave_out(suspects.gyro[n], &selection->gyro[n]);
    leave_out(suspects.accel[n], &selection->accel[n]);
  }
}

int CountTrue(const std::vector<bool>& flags) {
  return static_cast<int>(std::count(flags.begin(), flags.end(), true));
}

// The largest share of a sensor's measurements that one selection has and another one has not.
double ShareLost(const CameraImuSelection& before, const CameraImuSelection& after) {
  double share = 0.0;
  const auto compare = [&](int had, int has) {
    share = std::max(share, static_cast<double>(had - has) / std::max(1, had));
  };
  for (size_t n = 0; n < before.corners.size(); ++n) {
    int had = 0;
    int has = 0;
    for (size_t v = 0; v < before.corners[n].size(); ++v) {
      had += CountTrue(before.corners[n][v]);
      has += CountTrue(after.corners[n][v]);
    }
    compare(had, has);
  }
  for (size_t n = 0; n < before.gyro.size(); ++n) {
    compare(CountTrue(before.gyro[n]), CountTrue(after.gyro[n]));
    compare(CountTrue(before.accel[n]), CountTrue(after.accel[n]));
  }
  return share;
}

// Whether a view that took part takes none.
bool LosesViews(const CameraImuSelection& before, const CameraImuSelection& after) {
  for (size_t n = 0; n < before.corners.size(); ++n) {
    for (size_t v = 0; v < before.corners[n].size(); ++v) {
      if (CountTrue(before.corners[n][v]) > 0 && CountTrue(after.corners[n][v]) == 0) return true;
    }
  }
  return false;
}

// Kinds of measurements whose noise can be estimated: corners, then gyroscope and accelerometer of
// each IMU.
size_t NumNoiseKinds(const CameraImuWeights& weights) { return 1 + 2 * weights.imus.size(); }

double* StddevOf(size_t kind, CameraImuWeights* weights) {
  if (kind == 0) return &weights->corner_noise_px;
  CameraImuWeights::Imu& imu = weights->imus[(kind - 1) / 2];
  return kind % 2 == 1 ? &imu.gyro_stddev : &imu.accel_stddev;
}

// Sum of squares of the selected errors, and how many numbers they are.
struct SquaredErrors {
  double sum = 0.0;
  int count = 0;
};

SquaredErrors ErrorsOf(size_t kind, const CameraImuResiduals& residuals,
                       const CameraImuSelection& selection) {
  SquaredErrors errors;
  if (kind > 0) {
    const size_t imu = (kind - 1) / 2;
    const auto& of = kind % 2 == 1 ? residuals.gyro[imu] : residuals.accel[imu];
    const auto& selected = kind % 2 == 1 ? selection.gyro[imu] : selection.accel[imu];
    for (size_t k = 0; k < of.size(); ++k) {
      // An offset that still moved may have carried it beyond the trajectory's end.
      if (!selected[k] || !of[k].allFinite()) continue;
      errors.sum += of[k].squaredNorm();
      errors.count += 3;
    }
    return errors;
  }
  for (size_t n = 0; n < residuals.corners_px.size(); ++n) {
    for (size_t v = 0; v < residuals.corners_px[n].size(); ++v) {
      const Eigen::Matrix2Xd& of_view = residuals.corners_px[n][v];
      for (Eigen::Index k = 0; k < of_view.cols(); ++k) {
        if (!selection.corners[n][v][static_cast<size_t>(k)]) continue;
        if (!of_view.col(k).allFinite()) continue;
        errors.sum += of_view.col(k).squaredNorm();
        errors.count += 2;
      }
    }
  }
  return errors;
}

int CountOutside(const CameraImuProblem& problem, const CameraImuState& state) {
  int count = 0;
  const auto add = [&](double t) {
    if (!(t >= 0.0 && t <= state.T_g_i.duration_s())) ++count;
  };
  for (size_t n = 0; n < problem.cameras.size(); ++n) {
    for (const BoardView& view : problem.cameras[n].views) add(TimeOfView(state, n, view.stamp));
  }
  for (size_t n = 0; n < problem.imus.size(); ++n) {
    const ImuStream& stream = problem.imus[n].stream;
    for (const VectorSample& sample : stream.gyro) add(TimeOfSample(state, n, sample.stamp));
    for (const VectorSample& sample : stream.accel) add(TimeOfSample(state, n, sample.stamp));
  }
  return count;
}

// Estimates the noise of one kind: its squared errors over their redundancy, the numbers measured
// less those that the unknowns use up, which are the derivative of log det H to the logarithm of
// the kind's weight; here by a difference. Source: Foerstner and Wrobel, "Photogrammetric Computer
// Vision", 2016, section 4.2.4 (variance components).
double EstimatedStddev(size_t kind, const CameraImuProblem& problem, const CameraImuLayout& layout,
                       const Solver& solver, const CameraImuMeasurements& measurements,
                       const CameraImuWeights& weights, const SquaredErrors& errors) {
  constexpr double kStep = 1e-3;
  CameraImuWeights moved = weights;
  const double stddev = *StddevOf(kind, &moved);
  *StddevOf(kind, &moved) *= std::exp(-0.5 * kStep);
  ArrowheadSystem moved_system(solver.system());
  if (!Linearise(problem, solver.state(), layout, measurements, moved, &moved_system)) {
    return stddev;
  }
  const auto here = ArrowheadCholesky::Factor(solver.system(), 0.0);
  const auto there = ArrowheadCholesky::Factor(moved_system, 0.0);
  if (!here || !there) return stddev;
  const double used = (there->LogDeterminant() - here->LogDeterminant()) / kStep;
  const double redundancy = errors.count - used;
  return redundancy > 0.0 && errors.sum > 0.0 ? std::sqrt(errors.sum / redundancy) : stddev;
}

// The noise of what is not given, at the solver's state.
CameraImuWeights EstimatedWeights(const CameraImuProblem& problem, const CameraImuOptions& options,
                                  const CameraImuLayout& layout, const Solver& solver,
                                  const CameraImuMeasurements& measurements,
                                  const CameraImuSelection& selection,
                                  const CameraImuWeights& weights) {
  CameraImuWeights estimated = weights;
  const CameraImuResiduals residuals = ResidualsOf(problem, solver.state());
  for (size_t kind = 0; kind < NumNoiseKinds(weights); ++kind) {
    if (kind == 0 ? problem.corner_noise_px.has_value() : !options.estimate_imu_noise) continue;
    *StddevOf(kind, &estimated) = EstimatedStddev(kind, problem, layout, solver, measurements,
                                                  weights, ErrorsOf(kind, residuals, selection));
  }
  return estimated;
}

// See CameraImuCalibration::change_with_finer_knots.
std::optional<double> ChangeWithFinerKnots(const CameraImuProblem& problem,
                                           CameraImuOptions options, const CameraImuLayout& layout,
                                           const CameraImuCalibration& result) {
  options.check_knot_spacing = false;
  options.knot_spacing_s = 0.5 * result.knot_spacing_s;
  const CameraImuCalibration finer = CalibrateCameraImu(problem, options);
  if (finer.termination != Termination::kConverged) return std::nullopt;
  const VectorXd change = CalibrationDifference(*finer.state, *result.state, layout);
  const VectorXd sigma = result.information.covariance.diagonal().cwiseSqrt();
  return change.cwiseQuotient(sigma).cwiseAbs().maxCoeff();
}

}  // namespace

CameraImuCalibration CalibrateCameraImu(const CameraImuProblem& problem,
                                        const CameraImuOptions& options) {
  CheckProblem(problem);
  CameraImuCalibration result;
  result.knot_spacing_s =
      options.knot_spacing_s.value_or(KnotSpacingFor(problem.imus.front().stream));
  auto found = FindCameraImuStart(problem, options, result.knot_spacing_s);
  if (const auto* none = std::get_if<CameraImuNoStart>(&found)) {
    result.no_start = *none;
    return result;
  }
  auto* start = std::get_if<CameraImuStart>(&found);
  result.knot_spacing_s = start->state.T_g_i.spacing_s();
  result.weights = WeightsOf(problem, problem.corner_noise_px.value_or(start->corner_noise_px));

  const CameraImuLayout layout(problem, options.spline_order);
  Solver solver(problem, layout, std::move(start->state));
  CameraImuSelection selection = SelectionOfFinite(ResidualsOf(problem, solver.state()));
  bool has_suspects = false;
  if (options.reject_outliers) {
    const CameraImuSelection all = selection;
    LeaveOut(start->suspects, &selection);
    has_suspects = !(selection == all);
  }
  CameraImuMeasurements measurements = MeasurementsOf(problem, solver.state(), selection);
  (void)solver.Solve(measurements, result.weights, 0.0, kNearlyConverged, options.max_iterations);

  for (int round = 0; round < kOutlierRounds && options.reject_outliers; ++round) {
    CameraImuSelection inliers = InliersAmong(ResidualsOf(problem, solver.state()), result.weights);
    if (inliers == selection) break;
    if (round == 0 && ShareLost(selection, inliers) > kFewOutliers) {
      // While outliers pull, what they pull looks like outliers too.
      CameraImuWeights robust = result.weights;
      robust.loss_scale = kLossScale;
      (void)solver.Solve(measurements, robust, 0.0, kNearlyConverged, options.max_iterations);
      const CameraImuResiduals residuals = ResidualsOf(problem, solver.state());
      if (!problem.corner_noise_px) result.weights.corner_noise_px = RobustCornerNoise(residuals);
      inliers = InliersAmong(residuals, result.weights);
    }
    // What stood next to something that is off may have looked off as well, and is good without it.
    const bool few = ShareLost(selection, inliers) <= kFewOutliers &&
                     !LosesViews(selection, inliers) && !(round == 0 && has_suspects);
    selection = std::move(inliers);
    measurements = MeasurementsOf(problem, solver.state(), selection);
    (void)solver.Solve(measurements, result.weights, 0.0, kNearlyConverged, options.max_iterations);
    if (few) break;
  }

  // One round for the corners, whose noise moves little; more where the IMU's may be far off.
  for (int round = 0; round < (options.estimate_imu_noise ? kNoiseRounds : 1); ++round) {
    result.weights =
        EstimatedWeights(problem, options, layout, solver, measurements, selection, result.weights);
    result.termination =
        solver.Solve(measurements, result.weights, kConverged, 0.0, options.max_iterations);
  }

  result.num_iterations = solver.num_iterations();
  result.state = solver.state();
  result.information = InformationOfBorder(layout, solver.system());
  if (IsUndetermined(result.information, layout)) result.termination = Termination::kRankDeficient;
  result.residuals = ResidualsOf(problem, solver.state());
  const SquaredErrors inliers = ErrorsOf(0, result.residuals, selection);
  const SquaredErrors all = ErrorsOf(0, result.residuals, SelectionOfFinite(result.residuals));
  result.num_corners = inliers.count / 2;
  result.reprojection_rms_px = std::sqrt(inliers.sum / std::max(1, result.num_corners));
  result.reprojection_rms_all_px = std::sqrt(2.0 * all.sum / std::max(1, all.count));
  result.num_outside = CountOutside(problem, solver.state());
  result.inliers = std::move(selection);
  if (options.check_knot_spacing && result.termination == Termination::kConverged) {
    result.change_with_finer_knots = ChangeWithFinerKnots(problem, options, layout, result);
  }
  return result;
}

CameraImuInformation InformationAt(const CameraImuProblem& problem, const CameraImuState& state) {
  assert(problem.corner_noise_px.has_value());
  const CameraImuLayout layout(problem, state.T_g_i.order());
  const CameraImuSelection selection = SelectionOnTrajectory(problem, state);
  ArrowheadSystem system(state.num_blocks(), layout.block_size, layout.border_size);
  const auto cost = Linearise(problem, state, layout, MeasurementsOf(problem, state, selection),
                              WeightsOf(problem, *problem.corner_noise_px), &system);
  assert(cost.has_value());
  return cost ? InformationOfBorder(layout, system)
              : CameraImuInformation{layout.names, {}, {}, {}, 0.0};
}

}  // namespace calibrato
