#pragma once

#include <string_view>

namespace calibrato {

/// How a solve ended. Only kConverged is a result to be trusted.
enum class Termination {
  kConverged,       ///< The cost no longer falls.
  kIterationLimit,  ///< Stopped at the limit while it still fell.
  kRankDeficient,   ///< The data leave some parameter undetermined.
  kNoStart,         ///< No start values: fewer than three usable views, or none that fits any lens.
};

[[nodiscard]] constexpr std::string_view TerminationName(Termination termination) {
  switch (termination) {
    case Termination::kConverged:
      return "converged";
    case Termination::kIterationLimit:
      return "iteration limit";
    case Termination::kRankDeficient:
      return "rank deficient";
    case Termination::kNoStart:
      return "no start values";
  }
  return "";
}

}  // namespace calibrato
