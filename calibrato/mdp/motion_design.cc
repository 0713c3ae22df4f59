#include "calibrato/mdp/motion_design.h"

#include <nlopt.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <memory>

#include "calibrato/base/parallel.h"
#include "calibrato/mdp/motion_information.h"
#include "calibrato/motion/loop_demands.h"

namespace calibrato {
namespace {

using Eigen::VectorXd;

constexpr int kNumCoefficients = 36;
constexpr int kNumDemands = 7;
constexpr double kShortestLoop = 0.5;  // [s]
constexpr double kLongestLoop = 60.0;  // [s]
// A design that teaches nothing: far worse than any that does.
constexpr double kNothing = 20.0;

// Variables: each loop's coefficients before scaling, over the limit, then the logarithms of the
// durations.
class Variables {
 public:
  explicit Variables(const MotionDesignProblem& problem)
      : problem_(problem),
        scale_(ScaledAction(LoopCoefficients::Ones()) * problem.coefficient_limit) {}

  int size() const { return problem_.num_loops * (kNumCoefficients + 1); }
  int coefficients(int loop) const { return loop * kNumCoefficients; }
  int duration(int loop) const { return problem_.num_loops * kNumCoefficients + loop; }

  Motion MotionOf(const double* x) const {
    Motion motion;
    motion.base_pose = problem_.base_pose;
    for (int loop = 0; loop < problem_.num_loops; ++loop) {
      const Eigen::Map<const LoopCoefficients> unit(x + coefficients(loop));
      motion.loops.push_back({unit.cwiseProduct(scale_), std::exp(x[duration(loop)])});
    }
    return motion;
  }
  VectorXd Of(const Motion& motion) const {
    VectorXd x(size());
    for (int loop = 0; loop < problem_.num_loops; ++loop) {
      const Loop& it = motion.loops[static_cast<size_t>(loop)];
      x.segment<kNumCoefficients>(coefficients(loop)) =
          it.coefficients.cwiseQuotient(scale_).cwiseMax(-1.0).cwiseMin(1.0);
      x[duration(loop)] = std::log(std::clamp(it.duration_s, kShortestLoop, kLongestLoop));
    }
    return x;
  }
  // Adds factor times a loop's gradient.
  void Add(int loop, double duration_s, const LoopGradient& gradient, double factor,
           double* out) const {
    Eigen::Map<LoopCoefficients>(out + coefficients(loop)) +=
        factor * gradient.coefficients.cwiseProduct(scale_);
    out[duration(loop)] += factor * gradient.duration_s * duration_s;
  }

 private:
  const MotionDesignProblem& problem_;
  LoopCoefficients scale_;
};

struct Design {
  const MotionDesignProblem& problem;
  Variables variables{problem};
  int64_t num_evaluations = 0;

  // Mean over the rigs; adds the gradient where it is not null.
  double Objective(const double* x, double* gradient) {
    const Motion motion = variables.MotionOf(x);
    MotionInformationOptions options;
    options.criterion = problem.criterion;
    options.want_gradient = gradient != nullptr;
    const auto expected =
        ParallelMap<std::optional<MotionInformation>>(problem.rigs.size(), [&](size_t i) {
          return problem.task == Task::kIntrinsic
                     ? ExpectIntrinsicInformation(problem.rigs[i], motion, options)
                     : ExpectExtrinsicInformation(problem.rigs[i], motion, options);
        });
    num_evaluations += static_cast<int64_t>(problem.rigs.size());
    double sum = 0.0;
    const double share = 1.0 / static_cast<double>(problem.rigs.size());
    for (const auto& it : expected) {
      if (!it) {
        sum += share * kNothing;
        continue;
      }
      // log det is a logarithm already; of the six or four eigenvalues' mean.
      const bool log_det = problem.criterion == DesignCriterion::kD;
      const double size = problem.task == Task::kIntrinsic ? 4.0 : 6.0;
      sum += share * 0.5 * (log_det ? it->criterion / size : std::log(it->criterion));
      if (gradient == nullptr) continue;
      const double factor = share * 0.5 / (log_det ? size : it->criterion);
      for (int loop = 0; loop < problem.num_loops; ++loop) {
        const auto i = static_cast<size_t>(loop);
        variables.Add(loop, motion.loops[i].duration_s, it->gradient[i], factor, gradient);
      }
    }
    return sum;
  }

  int num_constraints() const { return 2 + kNumDemands * problem.num_loops; }

  // Each at most 0; gradients row by row where not null.
  void Constraints(const double* x, double* values, double* gradients) const {
    const int n = variables.size();
    const Motion motion = variables.MotionOf(x);
    if (gradients != nullptr) std::fill(gradients, gradients + num_constraints() * n, 0.0);
    values[0] = -1.0;
    values[1] = -1.0;
    for (int loop = 0; loop < problem.num_loops; ++loop) {
      const Loop& it = motion.loops[static_cast<size_t>(loop)];
      const LoopDemand path = PathLengthWithGradient(it.coefficients);
      values[0] += path.value / problem.max_path_m;
      values[1] += it.duration_s / problem.max_duration_s;
      const LoopDemands demands =
          DemandsOf(problem.base_pose, it, problem.rigs.front(), problem.limits);
      const LoopDemand* all[kNumDemands] = {&demands.speed,         &demands.acceleration,
                                            &demands.angular_speed, &demands.angular_acceleration,
                                            &demands.reach,         &demands.depth,
                                            &demands.view};
      for (int k = 0; k < kNumDemands; ++k)
        values[2 + kNumDemands * loop + k] = all[k]->value - 1.0;
      if (gradients == nullptr) continue;
      variables.Add(loop, it.duration_s, path.gradient, 1.0 / problem.max_path_m, gradients);
      gradients[n + variables.duration(loop)] += it.duration_s / problem.max_duration_s;
      for (int k = 0; k < kNumDemands; ++k) {
        variables.Add(loop, it.duration_s, all[k]->gradient, 1.0,
                      gradients + (2 + kNumDemands * loop + k) * n);
      }
    }
  }
};

double CallObjective(unsigned n, const double* x, double* gradient, void* data) {
  if (gradient != nullptr) std::fill(gradient, gradient + n, 0.0);
  return static_cast<Design*>(data)->Objective(x, gradient);
}

void CallConstraints(unsigned /*m*/, double* values, unsigned /*n*/, const double* x,
                     double* gradients, void* data) {
  static_cast<const Design*>(data)->Constraints(x, values, gradients);
}

}  // namespace

std::optional<MotionDesign> DesignMotion(const MotionDesignProblem& problem, const Motion& start,
                                         const MotionDesignOptions& options) {
  assert(!problem.rigs.empty() && problem.num_loops >= 1);
  assert(start.loops.size() == static_cast<size_t>(problem.num_loops));
  Design design{problem};
  VectorXd x = design.variables.Of(start);
  if (design.Objective(x.data(), nullptr) >= kNothing) return std::nullopt;

  const auto n = static_cast<unsigned>(design.variables.size());
  const std::unique_ptr<nlopt_opt_s, void (*)(nlopt_opt)> optimizer(nlopt_create(NLOPT_LD_MMA, n),
                                                                    &nlopt_destroy);
  VectorXd low = VectorXd::Constant(n, -1.0);
  VectorXd high = VectorXd::Ones(n);
  low.tail(problem.num_loops).setConstant(std::log(kShortestLoop));
  high.tail(problem.num_loops).setConstant(std::log(kLongestLoop));
  nlopt_set_lower_bounds(optimizer.get(), low.data());
  nlopt_set_upper_bounds(optimizer.get(), high.data());
  nlopt_set_min_objective(optimizer.get(), &CallObjective, &design);
  const VectorXd tolerance = VectorXd::Constant(design.num_constraints(), 1e-4);
  nlopt_add_inequality_mconstraint(optimizer.get(), static_cast<unsigned>(design.num_constraints()),
                                   &CallConstraints, &design, tolerance.data());
  nlopt_set_maxeval(optimizer.get(), options.max_evaluations);
  nlopt_set_ftol_abs(optimizer.get(), 1e-5);
  double value = 0.0;
  nlopt_optimize(optimizer.get(), x.data(), &value);

  MotionDesign result;
  result.motion = design.variables.MotionOf(x.data());
  result.objective = design.Objective(x.data(), nullptr);
  std::vector<double> constraints(static_cast<size_t>(design.num_constraints()));
  design.Constraints(x.data(), constraints.data(), nullptr);
  result.largest_violation = *std::max_element(constraints.begin(), constraints.end());
  result.num_information_evaluations = design.num_evaluations;
  return result;
}

}  // namespace calibrato
