#pragma once

#include <string_view>

namespace calibrato {

/// How a solve ended. Only kConverged is a result to be trusted.
enum class Termination {
  kConverged,       ///< The cost no longer falls.
  kIterationLimit,  ///< Stopped before.
  kNoStepHelps,     ///< Stopped before: no step from there makes the cost fall.
  kRankDeficient,   ///< The data leave some parameter undetermined.
  kNoStart,         ///< No start values: fewer than three usable views, or none that fits any lens.
  kNotTried,        ///< Not begun: the check of the recording says that it can't come out right.
};

[[nodiscard]] constexpr std::string_view TerminationName(Termination termination) {
  switch (termination) {
    case Termination::kConverged:
      return "converged";
    case Termination::kIterationLimit:
      return "iteration limit";
    case Termination::kNoStepHelps:
      return "no step helps";
    case Termination::kRankDeficient:
      return "rank deficient";
    case Termination::kNoStart:
      return "no start values";
    case Termination::kNotTried:
      return "not tried";
  }
  return "";
}

}  // namespace calibrato
