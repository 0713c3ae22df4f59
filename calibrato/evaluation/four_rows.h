#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "calibrato/base/value.h"
#include "calibrato/evaluation/chart.h"
#include "calibrato/evaluation/closed_loop.h"
#include "calibrato/evaluation/contest.h"

namespace calibrato {

/// What one way of planning did, and what it took. Budgets are kept apart.
struct PlanningRow {
  std::string policy;
  std::vector<std::vector<Trial>> trials;
  int64_t num_episodes = 0;  ///< At some judge's fidelity, before the first rig of the trial.
  int64_t num_design_evaluations = 0;    ///< Of expected information, before the first rig.
  double mean_evaluations_of_rig = 0.0;  ///< Of expected information, for each rig.
};

/// Why learn at all? The same path and time for all, those of the handcrafted motion:
///
///     handcrafted
///     nominal       designed for the nominal rig, played open loop
///     robust        designed for the nominal rig and draws of the distribution, open loop
///     closed loop   the robust motion, its rest designed anew after each loop for the rig as
///                   calibrated so far (PlayClosedLoop)
///     oracle        designed for the rig as it is (DesignForTruth): nobody can do better but by
///                   designing better
///
/// and for each policy that was brought, NAME as it is and `NAME, closed loop`. Rigs of which one's
/// motion is impossible before their board are failed trials.
struct FourRows {
  ContestSetting setting;
  std::vector<PlanningRow> rows;
  std::map<std::string, double> seconds;  ///< CPU time of designs, by row: of all rigs together.
};

struct FourRowsOptions {
  int num_believed = 8;             ///< Draws beside the nominal rig, >= 0.
  int num_starts = 6;               ///< Of the nominal design, as MultistartOptions.
  int evaluations_per_start = 200;  ///< Likewise.
  int evaluations_of_best = 600;    ///< Likewise.
  int robust_evaluations = 150;     ///< Of the robust design, from the nominal one.
  int oracle_evaluations = 300;     ///< From the robust design, for each rig.
  ClosedLoopOptions closed_loop;
};

/// @throws InputError as RunContest; or if no motion teaches anything about the nominal rig.
[[nodiscard]] FourRows EvaluateFourRows(const ContestSetting& setting,
                                        const std::vector<MotionUnderTrial>& motions,
                                        const FourRowsOptions& options = {});

/// {"kind": "rows", "rows": [..]}: the rows of MethodRow with "episodes",
/// "design_information_evaluations", "information_evaluations_of_rig", and the paired ratios of the
/// mean errors to `handcrafted`, `robust` and `oracle`: "ratio_to_robust", "ratio_to_robust_ci95".
[[nodiscard]] Value ToValue(const std::vector<FourRows>& tasks);
[[nodiscard]] std::vector<Chart> ChartsOf(const std::vector<FourRows>& tasks);

}  // namespace calibrato
