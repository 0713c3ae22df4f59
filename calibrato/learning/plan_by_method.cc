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

// Keeps the best of all that is tried.
class Trials {
 public:
  explicit Trials(const MotionDesignProblem& problem) : problem_(problem) {}

  // Minus the losses of motions once they fit.
  Eigen::VectorXd Values(const std::vector<Motion>& motions) {
    struct Outcome {
      std::optional<Motion> motion;
      double loss = kNothingIsLearned;
    };
    const auto outcomes = ParallelMap<Outcome>(motions.size(), [&](size_t i) {
      Outcome outcome{FitToBudget(problem_, motions[i])};
      if (outcome.motion) outcome.loss = ExpectLoss(problem_, *outcome.motion).value;
      return outcome;
    });
    Eigen::VectorXd values(static_cast<Eigen::Index>(outcomes.size()));
    for (size_t i = 0; i < outcomes.size(); ++i) {
      values(static_cast<Eigen::Index>(i)) = -outcomes[i].loss;
      if (outcomes[i].loss >= best_.loss) continue;
      best_.loss = outcomes[i].loss;
      best_.motion = *outcomes[i].motion;
    }
    num_motions_ += static_cast<int64_t>(motions.size());
    return values;
  }

  [[nodiscard]] std::optional<MotionDesign> Best() const {
    if (best_.motion.loops.empty()) return std::nullopt;
    MotionDesign design = best_;
    design.num_information_evaluations = num_motions_ * static_cast<int64_t>(problem_.rigs.size());
    return design;
  }

 private:
  const MotionDesignProblem& problem_;
  MotionDesign best_{{}, kNothingIsLearned, 0};
  int64_t num_motions_ = 0;
};

std::optional<MotionDesign> PlanByFisher(const MotionDesignProblem& problem, int num_evaluations,
                                         const Rng& rng) {
  // Half of the evaluations for the first rig; more rigs share the other half.
  const auto num_rigs = static_cast<int>(problem.rigs.size());
  const int for_one = num_rigs == 1 ? num_evaluations : num_evaluations / 2;
  constexpr int kShortest = 25;  // Evaluations below which a start shows nothing.
  MultistartOptions options;
  options.num_starts = std::clamp(for_one / 2 / kShortest, 1, 6);
  options.evaluations_per_start = std::max(1, for_one / 2 / options.num_starts);
  options.evaluations_of_best = std::max(1, for_one / 2);
  MotionDesignProblem one = problem;
  one.rigs.resize(1);
  std::optional<MotionDesign> design = DesignFromManyStarts(one, options, rng);
  if (!design || num_rigs == 1) return design;
  const int64_t spent = design->num_information_evaluations;
  const int left = std::max(1, (num_evaluations - for_one) / num_rigs);
  std::optional<MotionDesign> robust = DesignMotion(problem, design->motion, {left});
  if (robust) robust->num_information_evaluations += spent;
  return robust;
}

std::vector<Motion> RandomMotions(const MotionDesignProblem& problem, const Rng& rng) {
  std::vector<Motion> motions;
  for (int i = 0; i < kNumRandomMotions; ++i) {
    Rng draw = rng.Stream("random motion", static_cast<uint64_t>(i));
    Motion motion;
    while (motion.loops.size() < static_cast<size_t>(problem.num_loops)) {
      for (Loop& loop : RandomMotion(problem.task, draw).loops) motion.loops.push_back(loop);
    }
    motion.loops.resize(static_cast<size_t>(problem.num_loops));
    motions.push_back(std::move(motion));
  }
  return motions;
}

SearchValues ValuesAt(const MotionDesignProblem& problem, const Eigen::MatrixXd& positions,
                      bool want_gradients, Trials* trials) {
  std::vector<Motion> motions;
  for (const auto& position : positions.colwise()) motions.push_back(MotionAt(problem, position));
  SearchValues values{trials->Values(motions), {}};
  if (!want_gradients) return values;
  // Of the loss as if the motion had fitted as it is: shrinking for path and time keeps its shape.
  const LoopCoefficients scale = ScaledAction(LoopCoefficients::Ones());
  values.gradients = Eigen::MatrixXd::Zero(positions.rows(), positions.cols());
  const auto losses = ParallelMap<ExpectedLoss>(
      motions.size(), [&](size_t i) { return ExpectLoss(problem, motions[i], true); });
  for (size_t i = 0; i < losses.size(); ++i) {
    for (int loop = 0; loop < problem.num_loops; ++loop) {
      values.gradients.block<kNumCoefficients, 1>(loop * kNumCoefficients,
                                                  static_cast<Eigen::Index>(i)) =
          -losses[i].gradient[static_cast<size_t>(loop)].coefficients.cwiseProduct(scale);
    }
  }
  return values;
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
  if (method == kBestOfMany) {
    trials.Values(RandomMotions(problem, rng));
    return trials.Best();
  }
  const int num_motions = std::max(1, num_evaluations / static_cast<int>(problem.rigs.size()));
  const int dimension = problem.num_loops * kNumCoefficients;
  const SearchObjective objective = [&](const Eigen::MatrixXd& positions, bool want_gradients) {
    return ValuesAt(problem, positions, want_gradients, &trials);
  };
  Rng draw = rng.Stream("search");
  if (method == kPaperSwarm) {
    SwarmOptions options;
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
