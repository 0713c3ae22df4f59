#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "calibrato/base/value.h"
#include "calibrato/evaluation/chart.h"
#include "calibrato/evaluation/contest.h"
#include "calibrato/mdp/motion_design.h"

namespace calibrato {

/// What one planner found with one budget.
struct PlannerRun {
  std::string method;
  int64_t budget = 0;                 ///< Of information evaluations (NumEvaluations).
  std::vector<MotionDesign> designs;  ///< One for each repetition, with draws of its own; >= 1.
};

/// Planners under equal budgets of information evaluations: by the loss that they minimise, and by
/// the errors of their motions on the same rigs with the same noise.
struct PlannerComparison {
  struct Row {
    PlannerRun run;
    std::vector<std::vector<Trial>> trials;  ///< A member for each repetition.
  };
  ContestSetting setting;
  double handcrafted_loss = 0.0;  ///< ExpectLoss of the handcrafted motion as executed.
  std::vector<Row> rows;
  std::vector<std::vector<Trial>> handcrafted;
};

/// @param problem  What the planners were given.
/// @throws InputError as RunContest.
[[nodiscard]] PlannerComparison ComparePlanners(const ContestSetting& setting,
                                                const MotionDesignProblem& problem,
                                                const std::vector<PlannerRun>& runs);

/// {"kind": "planners", "rows": [..]}: the rows of MethodRow with "budget", "method" (of which
/// "policy" is method and budget), "information_evaluations" (mean), "expected_loss" (mean over
/// repetitions less that of the handcrafted motion) with "expected_loss_range" [least, largest],
/// "ratio_to_handcrafted" and its interval.
[[nodiscard]] Value ToValue(const std::vector<PlannerComparison>& tasks);
/// Loss against the budget, a chart a task and a line a method.
[[nodiscard]] std::vector<Chart> ChartsOf(const std::vector<PlannerComparison>& tasks);

}  // namespace calibrato
