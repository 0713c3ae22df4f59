#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "calibrato/base/rng.h"
#include "calibrato/mdp/design_problem.h"

namespace calibrato {

/// What those commands that design motions were told of the problem, in the words of their options.
struct DesignArguments {
  int num_believed = 8;     ///< Rigs drawn beside the nominal one.
  double max_path_m = 0.0;  ///< 0: that of the handcrafted motion on this carrier.
  double max_time_s = 0.0;  ///< Likewise.
};

/// Adds --believed, --max-path and --max-time.
void AddDesignArguments(CLI::App& app, DesignArguments* arguments);

/// @param rigs  What is believed, the nominal one first.
[[nodiscard]] MotionDesignProblem MakeDesignProblem(Task task, Carrier carrier,
                                                    std::vector<Rig> rigs,
                                                    const DesignArguments& arguments);

}  // namespace calibrato
