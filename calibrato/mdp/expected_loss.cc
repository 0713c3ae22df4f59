#include <cassert>
#include <cmath>
#include <utility>

#include "calibrato/base/parallel.h"
#include "calibrato/mdp/design_problem.h"
#include "calibrato/mdp/motion_information.h"

namespace calibrato {
namespace {

// One rig, one set of parameters.
ExpectedLoss Expect(const MotionDesignProblem& problem, const Rig& rig, Task task,
                    const Motion& motion, bool want_gradient) {
  MotionInformationOptions options;
  options.criterion = problem.criterion;
  options.want_gradient = want_gradient;
  options.extra_margin_px = problem.extra_margin_px;
  options.frames_per_loop = problem.frames_per_loop;
  std::optional<MotionInformation> information =
      task == Task::kIntrinsic ? ExpectIntrinsicInformation(rig, motion, options)
                               : ExpectExtrinsicInformation(rig, motion, options);
  if (!information) return {kNothingIsLearned, {}};
  ExpectedLoss loss{0.0, std::move(information->gradient)};
  double by_criterion = 0.0;
  if (problem.criterion == DesignCriterion::kD) {
    by_criterion = 0.5 / (task == Task::kIntrinsic ? 4.0 : 6.0);  // Eigenvalues.
    loss.value = by_criterion * information->criterion;
  } else {
    by_criterion = 0.5 / information->criterion;
    loss.value = 0.5 * std::log(information->criterion);
  }
  for (LoopGradient& gradient : loss.gradient) {
    gradient.coefficients *= by_criterion;
    gradient.duration_s *= by_criterion;
  }
  return loss;
}

}  // namespace

int64_t NumEvaluations(const MotionDesignProblem& problem) {
  const int64_t num_tasks = problem.task == Task::kJoint ? 2 : 1;
  return num_tasks * static_cast<int64_t>(problem.rigs.size());
}

ExpectedLoss ExpectLoss(const MotionDesignProblem& problem, const Motion& motion,
                        bool want_gradient) {
  assert(!problem.rigs.empty());
  std::vector<Task> tasks = {problem.task};
  if (problem.task == Task::kJoint) tasks = {Task::kIntrinsic, Task::kExtrinsic};
  const size_t num_tasks = tasks.size();
  const size_t n = problem.rigs.size() * num_tasks;
  const auto losses = ParallelMap<ExpectedLoss>(n, [&](size_t i) {
    return Expect(problem, problem.rigs[i / num_tasks], tasks[i % num_tasks], motion,
                  want_gradient);
  });
  const double share = 1.0 / static_cast<double>(n);
  ExpectedLoss mean;
  if (want_gradient) mean.gradient.resize(motion.loops.size());
  for (const ExpectedLoss& loss : losses) {
    mean.value += share * loss.value;
    for (size_t loop = 0; loop < loss.gradient.size(); ++loop) {
      mean.gradient[loop].coefficients += share * loss.gradient[loop].coefficients;
      mean.gradient[loop].duration_s += share * loss.gradient[loop].duration_s;
    }
  }
  return mean;
}

}  // namespace calibrato
