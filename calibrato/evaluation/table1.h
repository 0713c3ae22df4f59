#pragma once

#include <string>
#include <vector>

#include "calibrato/evaluation/statistics.h"
#include "calibrato/motion/carrier.h"
#include "calibrato/sensors/measurements.h"
#include "calibrato/simulation/rig_distribution.h"

namespace calibrato {

/// A motion under trial, with the name that its row carries.
struct NamedMotion {
  std::string policy;  ///< "learned", or a file's name.
  Motion motion;
};

/// The paper's Table 1, intrinsic task: how well cameras are calibrated by each policy's motion.
struct Table1Options {
  Carrier carrier = Carrier::kFree;
  RigDistribution rigs = RigDistribution::kPaper;
  int num_rigs = 500;  ///< 2 to 1e6
  uint64_t seed = 1;
  /// Beside `random` (a fresh draw for every rig) and `handcrafted`, which are always there.
  std::vector<NamedMotion> motions;
};

/// One rig calibrated by one policy's motion.
struct Trial {
  bool converged = false;
  double relative_error = 0.0;  ///< Of fu fv pu pv [-].
  double focal_error_px = 0.0;  ///< Root mean square over fu and fv.
  double prediction_error_px = 0.0;
  double a_optimality = 0.0;
  double nees = 0.0;  ///< Squared error over the stated covariance; 4 on average.
  double path_length_m = 0.0;
  double path_length_original_m = 0.0;
  double motion_s = 0.0;
  double scale = 1.0;  ///< By which the motion was shrunk to fit the carrier.
};

/// A row of the table; means are over the converged trials.
struct Table1Row {
  std::string policy;
  std::vector<Trial> trials;  ///< One a rig.
  int num_failures = 0;
  double mean_error = 0.0;  ///< [-]
  Interval mean_error_ci95;
  double median_error = 0.0;  ///< [-]
  /// Mean error over that of `handcrafted`, over the rigs that both calibrated.
  double ratio_to_handcrafted = 0.0;
  Interval ratio_ci95;
  /// The same over `random`.
  double ratio_to_random = 0.0;
  Interval ratio_to_random_ci95;
  double scale = 1.0;   ///< Least factor by which a motion was shrunk to fit the carrier.
  TimedMotion example;  ///< As it ran; for `random`, the first rig's.
  std::vector<BoardView> example_views;  ///< What it showed to the camera of the paper's scene.
};

struct Table1 {
  Table1Options options;
  std::vector<Table1Row> rows;
};

/// Every policy is judged on the same rigs, none of which training draws, with the same noise. A
/// motion that its carrier can't make is scaled to fit, and its row says so.
/// @throws InputError if a motion can't be made at any scale.
[[nodiscard]] Table1 EvaluateTable1(const Table1Options& options);

}  // namespace calibrato
