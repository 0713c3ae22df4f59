#pragma once

#include <optional>
#include <string>

#include "calibrato/motion/motion.h"

namespace calibrato {

/// What the paper states of a policy, in its own simulator with its own estimators (Tables 1 and
/// 6): means over few runs, without intervals. Never ours.
struct PaperFigures {
  double mean_error_percent;
  double path_length_m;  ///< To be compared with path_length_original_m.
  /// Conditional and not normalised; to be compared with a_optimality_original. Extrinsic only.
  std::optional<double> a_optimality;
};

/// Of "random", "handcrafted", "learned", "fine-tuned" (extrinsic only) and "reprojection" (trained
/// on reprojection error, Table 6); nothing for others.
[[nodiscard]] std::optional<PaperFigures> FiguresOfPaper(Task task, const std::string& policy);

}  // namespace calibrato
