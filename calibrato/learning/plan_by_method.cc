#include "calibrato/learning/plan_by_method.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "calibrato/base/input_error.h"
#include "calibrato/base/parallel.h"
#include "calibrato/learning/search.h"
#include "calibrato/learning/swarm.h"

namespace calibrato {
namespace {

constexpr int kNumCoefficients = LoopCoefficients::RowsAtCompileTime;
constexpr int kNumRandomMotions = 1000;
constexpr double kWishedDuration = 5.0;  // [s]
constexpr const char* kFisher = "fisher";
constexpr const char* kBestOfMany = "best-of-1000";
constexpr const char* kPaperSwarm = "pso-paper";

Motion MotionAt(const MotionDesignProblem& problem, const Eigen::VectorXd& position) {
  Motion motion;
  motion.base_pose = problem.base_pose;
  for (int i = 0; i < problem.num_loops; ++i) {
    motion.loops.push_back(
        {ScaledAction(position.segment<kNumCoefficients>(i * kNumCoefficients)), kWishedDuration});
  }
  return motion;
}

// Keeps the best of all that is tried, and counts what it takes.
class Trials {
 public:
  explicit Trials(const MotionDesignProblem& problem) : problem_(problem) {}

  // Minus the losses of motions once they fit; their gradients, asked for, are those of the fitted
  // motions by the shape that was tried, as if the factor that fits them were given.
  SearchValues Values(const std::vector<Motion>& motions, bool want_gradients = false) {
    struct Outcome {
      std::optional<Motion> motion;
      ExpectedLoss loss{kNothingIsLearned, {}};
    };
    const auto outcomes = ParallelMap<Outcome>(motions.size(), [&](size_t i) {
      Outcome outcome{FitToBudget(problem_, motions[i]), {kNothingIsLearned, {}}};
      if (outcome.motion) outcome.loss = ExpectLoss(problem_, *outcome.motion, want_gradients);
      return outcome;
    });
    num_evaluations_ += static_cast<int64_t>(motions.size()) * NumEvaluations(problem_);
    const auto n = static_cast<Eigen::Index>(outcomes.size());
    SearchValues values{Eigen::VectorXd(n), {}};
    if (want_gradients) {
      values.gradients = Eigen::MatrixXd::Zero(problem_.num_loops * kNumCoefficients, n);
    }
    for (size_t i = 0; i < outcomes.size(); ++i) {
      const auto& [motion, loss] = outcomes[i];
      const auto column = static_cast<Eigen::Index>(i);
      values.values(column) = -loss.value;
      if (want_gradients && motion) {
        values.gradients.col(column) = -GradientByPosition(loss, *motion, motions[i]);
      }
      if (loss.value >= best_.loss) continue;
      best_.loss = loss.value;
      best_.motion = *motion;
    }
    return values;
  }

  [[nodiscard]] std::optional<MotionDesign> Best() const {
    if (best_.motion.loops.empty()) return std::nullopt;
    MotionDesign design = best_;
    design.num_information_evaluations = num_evaluations_;
    return design;
  }

 private:
  static Eigen::VectorXd GradientByPosition(const ExpectedLoss& loss, const Motion& fitted,
                                            const Motion& tried) {
    const LoopCoefficients scale = ScaledAction(LoopCoefficients::Ones());
    Eigen::VectorXd gradient =
        Eigen::VectorXd::Zero(static_cast<Eigen::Index>(tried.loops.size()) * kNumCoefficients);
    for (size_t loop = 0; loop < loss.gradient.size(); ++loop) {
      const double before = tried.loops[loop].coefficients.norm();
      if (!(before > 0.0)) continue;
      const double factor = fitted.loops[loop].coefficients.norm() / before;
      gradient.segment<kNumCoefficients>(static_cast<Eigen::Index>(loop) * kNumCoefficients) =
          factor * loss.gradient[loop].coefficients.cwiseProduct(scale);
    }
    return gradient;
  }

  const MotionDesignProblem& problem_;
  MotionDesign best_{{}, kNothingIsLearned, 0};
  int64_t num_evaluations_ = 0;
};

// Half of the evaluations for the first rig; more rigs share the other half.
std::optional<MotionDesign> PlanByFisher(const MotionDesignProblem& problem, int num_evaluations,
                                         const Rng& rng) {
  MotionDesignProblem one = problem;
  one.rigs.resize(1);
  const auto share = [](int evaluations, const MotionDesignProblem& of) {
    return std::max(1, static_cast<int>(evaluations / NumEvaluations(of)));
  };
  const bool is_robust = problem.rigs.size() > 1;
  const int for_one = share(is_robust ? num_evaluations / 2 : num_evaluations, one);
  constexpr int kShortest = 25;  // Evaluations below which a start shows nothing.
  constexpr int kBesides = 3;    // Of each start and of the best: before and after (DesignMotion).
  MultistartOptions options;
  options.num_starts = std::clamp(for_one / 2 / kShortest, 1, 6);
  options.evaluations_per_start = std::max(1, for_one / 2 / options.num_starts - kBesides);
  options.evaluations_of_best = std::max(1, for_one / 2 - kBesides);
  std::optional<MotionDesign> design = DesignFromManyStarts(one, options, rng);
  if (!design || !is_robust) return design;
  const int64_t spent = design->num_information_evaluations;
  const int left = share(num_evaluations - num_evaluations / 2, problem) - kBesides;
  std::optional<MotionDesign> robust = DesignMotion(problem, design->motion, {std::max(1, left)});
  if (robust) robust->num_information_evaluations += spent;
  return robust;
}

// Uniform in the same box that all search.
std::vector<Motion> RandomMotions(const MotionDesignProblem& problem, int64_t num_motions,
                                  const Rng& rng) {
  std::vector<Motion> motions;
  for (int64_t i = 0; i < num_motions; ++i) {
    Rng draw = rng.Stream("random motion", static_cast<uint64_t>(i));
    Eigen::VectorXd position(problem.num_loops * kNumCoefficients);
    for (double& x : position) {
      x = draw.Uniform(-problem.coefficient_limit, problem.coefficient_limit);
    }
    motions.push_back(MotionAt(problem, position));
  }
  return motions;
}

}  // namespace

std::vector<std::string> PlanMethodNames() {
  std::vector<std::string> names = {kFisher, kBestOfMany, kPaperSwarm};
  for (const std::string& name : SearchNames()) names.push_back(name);
  return names;
}

std::optional<MotionDesign> PlanByMethod(const std::string& method,
                                         const MotionDesignProblem& problem, int num_evaluations,
                                         const Rng& rng) {
  if (method == "q-library" || method == "sac") {
    throw InputError(
        {"method '" + method + "' plans from what it learned", "", "it needs a policy",
         "learn one with calibrato learn --planner " + method + ", then plan with --policy"});
  }
  if (method == kFisher) return PlanByFisher(problem, num_evaluations, rng);
  Trials trials(problem);
  const int num_motions = std::max(1, static_cast<int>(num_evaluations / NumEvaluations(problem)));
  if (method == kBestOfMany) {
    (void)trials.Values(
        RandomMotions(problem, std::min<int64_t>(kNumRandomMotions, num_motions), rng));
    return trials.Best();
  }
  const int dimension = problem.num_loops * kNumCoefficients;
  const SearchObjective objective = [&](const Eigen::MatrixXd& positions, bool want_gradients) {
    std::vector<Motion> motions;
    for (const auto& position : positions.colwise()) {
      motions.push_back(MotionAt(problem, position));
    }
    return trials.Values(motions, want_gradients);
  };
  Rng draw = rng.Stream("search");
  if (method == kPaperSwarm) {
    SwarmOptions options;
    options.limit = problem.coefficient_limit;
    options.num_iterations = std::max(0, num_motions / options.num_particles - 1);
    (void)MaximiseBySwarm(objective, dimension, Eigen::MatrixXd(dimension, 0), options, draw);
    return trials.Best();
  }
  const Search search = SearchFromName(method);
  SearchOptions options;
  options.limit = problem.coefficient_limit;
  options.num_evaluations = num_motions;
  (void)search(objective, dimension, options, draw);
  return trials.Best();
}

}  // namespace calibrato
