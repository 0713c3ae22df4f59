#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "calibrato/base/value.h"
#include "calibrato/evaluation/chart.h"
#include "calibrato/evaluation/contest.h"
#include "calibrato/motion/motion.h"

namespace calibrato {

/// What one way of learning came to.
struct AblationVariant {
  std::string name;              ///< "baseline", "mistake frozen-swarm", ..
  std::optional<Motion> motion;  ///< None if nothing was learned.
  std::string termination;       ///< Why it ended, for people.
  int64_t num_episodes = 0;
  int64_t num_calibrations = 0;
};

/// What each difference of a learner costs or brings: variants that learned from as many episodes
/// each, on the same rigs with the same noise, beside the first, the baseline, and the handcrafted
/// motion.
struct Ablation {
  struct Row {
    AblationVariant variant;
    std::vector<std::vector<Trial>> trials;  ///< None without a motion.
  };
  ContestSetting setting;
  std::vector<Row> rows;  ///< In the order of the variants.
  std::vector<std::vector<Trial>> handcrafted;
};

/// @throws InputError as RunContest. @pre there is a first variant, with a motion or without.
[[nodiscard]] Ablation EvaluateAblation(const ContestSetting& setting,
                                        const std::vector<AblationVariant>& variants);

/// {"kind": "ablation", "rows": [..]}: the rows of MethodRow with "episodes", "calibrations",
/// "termination", and the paired ratios "ratio_to_baseline" and "ratio_to_handcrafted" with their
/// intervals; "probability_as_baseline" is that of so large a difference by chance, adjusted for
/// the number of rows (HolmAdjusted).
[[nodiscard]] Value ToValue(const std::vector<Ablation>& tasks);
/// The ratios to the baseline, a chart a task.
[[nodiscard]] std::vector<Chart> ChartsOf(const std::vector<Ablation>& tasks);

}  // namespace calibrato
