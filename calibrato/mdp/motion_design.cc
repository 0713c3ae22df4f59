#include "calibrato/mdp/motion_design.h"

#include <nlopt.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "calibrato/base/parallel.h"
#include "calibrato/motion/loop_demands.h"

namespace calibrato {
namespace {

using Eigen::VectorXd;

constexpr int kNumCoefficients = 36;
constexpr double kShortestLoop = 0.5;  // [s]
// Of the square of a limit's excess, as a share of the limit: at 1 % of excess 0.002 of a loss, so
// that little is left for FitToBudget to take out.
constexpr double kExcessWeight = 20.0;
// Excess is charged from so little below the limit on.
constexpr double kMargin = 0.005;
// The variables' unit, in limits of the coefficients: it sets the first step's length, and
// how coefficients compare with durations.
constexpr double kUnit = 3.0;
// So many pairs of steps and gradients make up the curvature.
constexpr unsigned kMemory = 80;

// A loss and its gradient by the free loops' variables: all coefficients before scaling, in units,
// then the logarithms of the durations.
class Objective {
 public:
  Objective(const MotionDesignProblem& problem, const Motion& start)
      : problem_(problem),
        scale_(ScaledAction(LoopCoefficients::Ones()) * (kUnit * problem.coefficient_limit)),
        motion_(start),
        num_free_(problem.num_loops - problem.num_fixed_loops) {
    motion_.base_pose = problem.base_pose;
    path_left_ = problem.max_path_m;
    time_left_ = problem.max_duration_s;
    for (int i = 0; i < problem.num_fixed_loops; ++i) {
      path_left_ -= PathLength(motion_.loops[static_cast<size_t>(i)].coefficients);
      time_left_ -= motion_.loops[static_cast<size_t>(i)].duration_s;
    }
  }

  [[nodiscard]] int size() const { return num_free_ * (kNumCoefficients + 1); }
  [[nodiscard]] bool budget_is_left() const { return path_left_ > 0.0 && time_left_ > 0.0; }
  [[nodiscard]] int64_t num_evaluations() const { return num_evaluations_; }
  [[nodiscard]] const Motion& best() const { return best_; }

  [[nodiscard]] VectorXd Variables() const {
    VectorXd x(size());
    for (int i = 0; i < num_free_; ++i) {
      const Loop& loop = motion_.loops[LoopIndex(i)];
      x.segment<kNumCoefficients>(Coefficients(i)) = loop.coefficients.cwiseQuotient(scale_);
      x(Duration(i)) = std::log(std::max(loop.duration_s, kShortestLoop));
    }
    return x;
  }

  double Evaluate(const VectorXd& x, VectorXd* gradient) {
    // As the variables say, then scaled back to path and time.
    double path = 0.0;
    double time = 0.0;
    VectorXd path_gradient = VectorXd::Zero(size());
    for (int i = 0; i < num_free_; ++i) {
      Loop& loop = motion_.loops[LoopIndex(i)];
      loop.coefficients = x.segment<kNumCoefficients>(Coefficients(i)).cwiseProduct(scale_);
      loop.duration_s = std::exp(x(Duration(i)));
      const LoopDemand demand = PathLengthWithGradient(loop.coefficients);
      path += demand.value;
      path_gradient.segment<kNumCoefficients>(Coefficients(i)) =
          demand.gradient.coefficients.cwiseProduct(scale_);
      time += loop.duration_s;
    }
    const double shrink = std::min(1.0, path_left_ / path);
    const double hurry = std::min(1.0, time_left_ / time);
    for (int i = 0; i < num_free_; ++i) {
      motion_.loops[LoopIndex(i)].coefficients *= shrink;
      motion_.loops[LoopIndex(i)].duration_s *= hurry;
    }

    VectorXd by_motion = VectorXd::Zero(size());
    const ExpectedLoss expected = ExpectLoss(problem_, motion_, true);
    num_evaluations_ += NumEvaluations(problem_);
    double value = expected.value;
    for (int i = 0; i < num_free_; ++i) {
      Add(i, expected.gradient[LoopIndex(i)], 1.0, &by_motion);
      value += AddExcess(i, &by_motion);
    }
    if (value < best_value_) {
      best_value_ = value;
      best_ = motion_;
    }

    // Back to the variables.
    *gradient = by_motion;
    auto by_coefficients = gradient->head(num_free_ * kNumCoefficients);
    auto by_duration = gradient->tail(num_free_);
    if (shrink < 1.0) {
      const auto coefficients = x.head(num_free_ * kNumCoefficients);
      const double along = by_coefficients.dot(coefficients) / path;
      by_coefficients =
          shrink * (by_coefficients - along * path_gradient.head(num_free_ * kNumCoefficients));
    }
    if (hurry < 1.0) {
      const double sum = by_duration.sum();
      for (int i = 0; i < num_free_; ++i) by_duration(i) -= sum * std::exp(x(Duration(i))) / time;
    }
    return value;
  }

 private:
  static int Coefficients(int i) { return i * kNumCoefficients; }
  [[nodiscard]] int Duration(int i) const { return num_free_ * kNumCoefficients + i; }
  // Of all loops, that of the i-th free one.
  [[nodiscard]] size_t LoopIndex(int i) const {
    return static_cast<size_t>(problem_.num_fixed_loops + i);
  }

  void Add(int i, const LoopGradient& gradient, double factor, VectorXd* sum) const {
    sum->segment<kNumCoefficients>(Coefficients(i)) +=
        factor * gradient.coefficients.cwiseProduct(scale_);
    (*sum)(Duration(i)) += factor * gradient.duration_s * motion_.loops[LoopIndex(i)].duration_s;
  }

  // What one loop exceeds.
  double AddExcess(int i, VectorXd* sum) const {
    const Loop& loop = motion_.loops[LoopIndex(i)];
    const LoopDemands demands =
        DemandsOf(problem_.base_pose, loop, problem_.rigs.front(), problem_.limits);
    double charge = 0.0;
    for (const LoopDemand* demand :
         {&demands.speed, &demands.acceleration, &demands.angular_speed,
          &demands.angular_acceleration, &demands.reach, &demands.depth, &demands.view}) {
      const double excess = demand->value - (1.0 - kMargin);
      if (excess <= 0.0) continue;
      charge += kExcessWeight * excess * excess;
      Add(i, demand->gradient, 2.0 * kExcessWeight * excess, sum);
    }
    for (int k = 0; k < kNumCoefficients; ++k) {
      const double unit = loop.coefficients(k) / scale_(k);
      const double excess = kUnit * std::abs(unit) - 1.0;
      if (excess <= 0.0) continue;
      charge += kExcessWeight * excess * excess;
      (*sum)(Coefficients(i) + k) += 2.0 * kExcessWeight * excess * std::copysign(kUnit, unit);
    }
    return charge;
  }

  const MotionDesignProblem& problem_;
  LoopCoefficients scale_;
  Motion motion_;
  int num_free_;
  double path_left_ = 0.0;
  double time_left_ = 0.0;
  int64_t num_evaluations_ = 0;
  double best_value_ = std::numeric_limits<double>::infinity();
  Motion best_;
};

double CallObjective(unsigned n, const double* x, double* gradient, void* data) {
  VectorXd by_variables;
  const double value = static_cast<Objective*>(data)->Evaluate(
      Eigen::Map<const VectorXd>(x, static_cast<Eigen::Index>(n)), &by_variables);
  if (gradient != nullptr) std::copy(by_variables.begin(), by_variables.end(), gradient);
  return value;
}

}  // namespace

std::optional<MotionDesign> DesignMotion(const MotionDesignProblem& problem, const Motion& start,
                                         const MotionDesignOptions& options) {
  assert(!problem.rigs.empty() && problem.num_loops >= 1);
  assert(problem.num_fixed_loops >= 0 && problem.num_fixed_loops < problem.num_loops);
  assert(start.loops.size() == static_cast<size_t>(problem.num_loops));
  const std::optional<Motion> fitted = FitToBudget(problem, start);
  if (!fitted || ExpectLoss(problem, *fitted).value >= kNothingIsLearned) return std::nullopt;

  Objective objective(problem, *fitted);
  VectorXd x = objective.Variables();
  const std::unique_ptr<nlopt_opt_s, void (*)(nlopt_opt)> optimizer(
      nlopt_create(NLOPT_LD_LBFGS, static_cast<unsigned>(x.size())), &nlopt_destroy);
  nlopt_set_min_objective(optimizer.get(), &CallObjective, &objective);
  nlopt_set_vector_storage(optimizer.get(), kMemory);
  nlopt_set_maxeval(optimizer.get(), options.max_evaluations);
  nlopt_set_ftol_abs(optimizer.get(), 1e-6);
  double value = 0.0;
  // Its code only says what ended it; a line search that finds nothing better ends it too.
  nlopt_optimize(optimizer.get(), x.data(), &value);

  MotionDesign design;
  design.motion = *fitted;
  design.loss = ExpectLoss(problem, *fitted).value;
  if (const std::optional<Motion> improved = FitToBudget(problem, objective.best())) {
    const double loss = ExpectLoss(problem, *improved).value;
    if (loss < design.loss) {
      design.motion = *improved;
      design.loss = loss;
    }
  }
  design.num_information_evaluations = objective.num_evaluations() + 3 * NumEvaluations(problem);
  return design;
}

std::optional<MotionDesign> DesignFromManyStarts(const MotionDesignProblem& problem,
                                                 const MultistartOptions& options, const Rng& rng,
                                                 const DesignMany& design_many) {
  assert(options.num_starts >= 1);
  const DesignMany by_threads = [](size_t n, const auto& design) {
    return ParallelMap<std::optional<MotionDesign>>(n, design);
  };
  std::optional<MotionDesign> best;
  int64_t num_evaluations = 0;
  const auto keep_better = [&](std::optional<MotionDesign> design) {
    if (!design) return;
    num_evaluations += design->num_information_evaluations;
    if (!best || design->loss < best->loss) best = std::move(design);
  };
  for (auto& design : (design_many ? design_many : by_threads)(
           static_cast<size_t>(options.num_starts), [&](size_t k) {
             Rng draw = rng.Stream("start", k);
             Motion start = RandomMotion(problem.task, draw);
             const auto num_loops = static_cast<size_t>(problem.num_loops);
             while (start.loops.size() < num_loops) {
               start.loops.push_back(RandomMotion(problem.task, draw).loops.front());
             }
             start.loops.resize(num_loops);
             return DesignMotion(problem, start, {options.evaluations_per_start});
           })) {
    keep_better(std::move(design));
  }
  if (!best) return std::nullopt;
  const Motion start = best->motion;
  keep_better(DesignMotion(problem, start, {options.evaluations_of_best}));
  best->num_information_evaluations = num_evaluations;
  return best;
}

}  // namespace calibrato
