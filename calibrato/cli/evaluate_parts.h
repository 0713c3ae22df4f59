#pragma once

#include <map>
#include <string>
#include <vector>

#include "calibrato/base/files.h"
#include "calibrato/base/value.h"
#include "calibrato/cli/command.h"
#include "calibrato/cli/evaluate_options.h"
#include "calibrato/cli/output.h"
#include "calibrato/evaluation/ablation.h"
#include "calibrato/evaluation/planner_comparison.h"

namespace calibrato {

/// A table or figure, ready to be written.
struct EvaluationPart {
  std::string title;
  Value result;
  Value plots;                               ///< What the report draws beside it.
  std::map<std::string, std::string> files;  ///< The same as lists, by name.
  std::string text;                          ///< For the terminal.
  std::map<std::string, double> seconds;     ///< For timing.json: what took how long.
};

/// @param num_rigs  How many rigs it takes unless --num-rigs says.
using MakeEvaluationPart = EvaluationPart (*)(const EvaluateOptions& options,
                                              const GlobalOptions& global, const NumRigs& num_rigs);

[[nodiscard]] EvaluationPart MakeTable1(const EvaluateOptions& options, const GlobalOptions& global,
                                        const NumRigs& num_rigs);
[[nodiscard]] EvaluationPart MakeTable6(const EvaluateOptions& options, const GlobalOptions& global,
                                        const NumRigs& num_rigs);
[[nodiscard]] EvaluationPart MakeFigure4(const EvaluateOptions& options,
                                         const GlobalOptions& global, const NumRigs& num_rigs);
[[nodiscard]] EvaluationPart MakeFigure5(const EvaluateOptions& options,
                                         const GlobalOptions& global, const NumRigs& num_rigs);
[[nodiscard]] EvaluationPart MakeFigure7(const EvaluateOptions& options,
                                         const GlobalOptions& global, const NumRigs& num_rigs);
[[nodiscard]] EvaluationPart MakePareto(const EvaluateOptions& options, const GlobalOptions& global,
                                        const NumRigs& num_rigs);
[[nodiscard]] EvaluationPart PartOfAblation(const std::vector<Ablation>& tasks);
[[nodiscard]] EvaluationPart PartOfPlanners(const std::vector<PlannerComparison>& tasks);
[[nodiscard]] EvaluationPart MakeRows(const EvaluateOptions& options, const GlobalOptions& global,
                                      const NumRigs& num_rigs);
[[nodiscard]] EvaluationPart MakeRivals(const EvaluateOptions& options, const GlobalOptions& global,
                                        const NumRigs& num_rigs);

/// Writes a part and tells of it.
[[nodiscard]] ExitCode CommitPart(const EvaluationPart& part, const std::string& folder,
                                  const GlobalOptions& global, Stopwatch* stopwatch,
                                  OutputFolder* out);

}  // namespace calibrato
