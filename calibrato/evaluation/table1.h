#pragma once

#include <string>
#include <vector>

#include "calibrato/evaluation/contest.h"
#include "calibrato/evaluation/contestant.h"
#include "calibrato/evaluation/statistics.h"
#include "calibrato/evaluation/trial.h"
#include "calibrato/sensors/measurements.h"

namespace calibrato {

/// The paper's Table 1, one task of it: how well rigs are calibrated by each policy's motion.
struct Table1Options {
  ContestSetting setting;
  /// Beside `random` and `handcrafted`, which are always there, and the other simple rivals.
  std::vector<MotionUnderTrial> motions;
};

/// A mean ratio to another row, paired rig by rig.
struct Comparison {
  double ratio = 0.0;
  Interval ci95;
  double probability = 0.0;           ///< Of such a difference by chance (permutation test).
  double adjusted_probability = 0.0;  ///< By Holm, over the rows compared with the same rival.
};

/// A row of the table; figures are over the trials that did not fail.
struct Table1Row {
  std::string policy;
  std::vector<std::vector<Trial>> trials;  ///< [member][rig]
  int num_failures = 0;
  double mean_error = 0.0;  ///< [-]
  Interval mean_error_ci95;
  double median_error = 0.0;  ///< [-]
  Comparison to_handcrafted;
  Comparison to_random;
  Comparison to_best_simple_rival;
  ConsistencyTest consistency;  ///< Of NeesDimension(task).
  double scale = 1.0;           ///< Least factor by which a motion was shrunk to fit the carrier.
  ExecutableMotion example;     ///< As it ran; for `random`, the first rig's.
  std::vector<BoardView> example_views;  ///< What it showed to the camera of the scene.

  [[nodiscard]] size_t num_members() const { return trials.size(); }
  [[nodiscard]] int num_trials() const;
  /// Mean over the trials that have the figure; NaN for none.
  [[nodiscard]] double MeanOf(double Trial::*figure) const;
  [[nodiscard]] double MedianOf(double Trial::*figure) const;
};

struct Table1 {
  Table1Options options;
  std::vector<Table1Row> rows;
  /// The row with the least mean error among `handcrafted` and those simple rivals that are no
  /// longer than it: what everyone has without learning.
  std::string best_simple_rival;
};

/// Every policy is judged on the same rigs, none of which training draws, with the same noise. A
/// motion that its carrier can't make is scaled to fit, and its row says so.
///
/// Rows: random (a fresh draw for every rig); handcrafted; what was brought, and, where that is
/// longer than the mean of the random ones, the same "at random's path"; and the simple rivals
/// "random at handcrafted's path", "expert" (ExpertMotion), "expert at handcrafted's path".
/// @throws InputError if a motion can't be made at any scale.
[[nodiscard]] Table1 EvaluateTable1(const Table1Options& options);

}  // namespace calibrato
