#pragma once

#include <string>
#include <vector>

#include "calibrato/base/value.h"
#include "calibrato/evaluation/chart.h"
#include "calibrato/evaluation/contest.h"
#include "calibrato/evaluation/contestant.h"

namespace calibrato {

/// One method with a smaller budget.
struct ParetoPoint {
  std::string method;
  double scale = 1.0;  ///< Of all coefficients.
  int num_loops = 0;   ///< Of the first loops; 0: all.
  std::vector<std::vector<Trial>> trials;
};

/// Error against budget: path alone is the wrong one, since information accrues per frame and per
/// second. Every method (`random`, `handcrafted`, `expert`, and what was brought) is tried whole,
/// scaled to three quarters, a half and a quarter, and cut after each of its loops (of more than
/// six, after six evenly spread ones). Recorded trajectories are tried whole.
struct Pareto {
  ContestSetting setting;
  std::vector<ParetoPoint> points;
};
[[nodiscard]] Pareto EvaluatePareto(const ContestSetting& setting,
                                    const std::vector<MotionUnderTrial>& motions);

/// {"kind": "pareto", "rows": [..]}: the rows of MethodRow with "scale" and "num_loops" (null:
/// all).
[[nodiscard]] Value ToValue(const std::vector<Pareto>& tasks);

/// Of each task: against path, seconds and frames, a line for each method scaled and one for each
/// cut.
[[nodiscard]] std::vector<Chart> ChartsOf(const std::vector<Pareto>& tasks);

}  // namespace calibrato
