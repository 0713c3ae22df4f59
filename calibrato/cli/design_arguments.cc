#include "calibrato/cli/design_arguments.h"

#include <utility>

#include "calibrato/cli/number_range.h"
#include "calibrato/mdp/design_setting.h"
#include "calibrato/simulation/rig_distribution.h"

namespace calibrato {
void AddDesignArguments(CLI::App& app, DesignArguments* arguments) {
  app.add_option("--believed", arguments->num_believed,
                 "Rigs that a design must suit, drawn beside the nominal one")
      ->check(CLI::Range(0, 1000))
      ->capture_default_str();
  app.add_option("--max-path", arguments->max_path_m,
                 "Path of the motion [m] (that of the handcrafted one)")
      ->check(FinitePositive());
  app.add_option("--max-time", arguments->max_time_s,
                 "Duration of the motion [s] (that of the handcrafted one)")
      ->check(FinitePositive());
}

MotionDesignProblem MakeDesignProblem(Task task, Carrier carrier, std::vector<Rig> rigs,
                                      const DesignArguments& arguments) {
  MotionDesignProblem problem;
  problem.task = task;
  problem.rigs = std::move(rigs);
  problem.num_loops = NumLoops(task);
  problem.base_pose = BasePoseBeforeBoard(problem.rigs.front());
  Motion handcrafted = HandcraftedMotion(task);
  handcrafted.carrier = carrier;
  handcrafted.base_pose = problem.base_pose;
  const MotionBudget budget = BudgetOf(handcrafted, problem.rigs.front());
  problem.max_path_m = arguments.max_path_m > 0.0 ? arguments.max_path_m : budget.path_m;
  problem.max_duration_s = arguments.max_time_s > 0.0 ? arguments.max_time_s : budget.duration_s;
  return problem;
}

}  // namespace calibrato
