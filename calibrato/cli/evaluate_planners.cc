// `calibrato evaluate planners`: all planners under equal budgets.

#include <cstdio>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calibrato/base/cpu_time.h"
#include "calibrato/base/input_error.h"
#include "calibrato/base/parallel.h"
#include "calibrato/base/progress.h"
#include "calibrato/cli/design_arguments.h"
#include "calibrato/cli/evaluate_options.h"
#include "calibrato/cli/evaluate_parts.h"
#include "calibrato/evaluation/planner_comparison.h"
#include "calibrato/learning/plan_by_method.h"
#include "calibrato/mdp/design_setting.h"

namespace calibrato {
namespace {

struct Options {
  EvaluateOptions evaluate;
  DesignArguments design;
  std::vector<int> budgets = {250, 1000, 4000, 16000};
  int repetitions = 3;
};

struct TimedDesign {
  std::optional<MotionDesign> design;
  double cpu_s = 0.0;
};

// Every method, budget and repetition, side by side.
std::vector<PlannerRun> RunPlanners(const MotionDesignProblem& problem, const Options& options,
                                    const Rng& rng, std::map<std::string, double>* seconds) {
  const std::vector<std::string> methods = PlanMethodNames();
  const auto num_repetitions = static_cast<size_t>(options.repetitions);
  const size_t num_budgets = options.budgets.size();
  const size_t n = methods.size() * num_budgets * num_repetitions;
  Progress progress("planning", static_cast<int64_t>(n));
  const auto method_of = [&](size_t i) { return methods[i / num_repetitions / num_budgets]; };
  const auto budget_of = [&](size_t i) {
    return options.budgets[i / num_repetitions % num_budgets];
  };
  const auto designs = ParallelMap<TimedDesign>(n, [&](size_t i) {
    const double start = ThreadCpuSeconds();
    TimedDesign made;
    made.design = PlanByMethod(method_of(i), problem, budget_of(i),
                               rng.Stream("repetition", i % num_repetitions));
    made.cpu_s = ThreadCpuSeconds() - start;
    progress.Advance();
    return made;
  });
  std::vector<PlannerRun> runs;
  for (size_t i = 0; i < n; ++i) {
    if (i % num_repetitions == 0) runs.push_back({method_of(i), budget_of(i), {}});
    // A repetition that found nothing leaves its method with fewer.
    if (designs[i].design) runs.back().designs.push_back(*designs[i].design);
    (*seconds)[TaskName(problem.task) + ", " + method_of(i) + ", " + std::to_string(budget_of(i)) +
               ", cpu_s"] += designs[i].cpu_s / static_cast<double>(num_repetitions);
  }
  std::erase_if(runs, [](const PlannerRun& run) { return run.designs.empty(); });
  return runs;
}

std::string SecondsText(const std::map<std::string, double>& seconds) {
  std::string text = "\nCPU seconds of one plan\n";
  char line[160];
  for (const auto& [name, cpu_s] : seconds) {
    std::snprintf(line, sizeof(line), "%-50s %10.3f\n", name.c_str(), cpu_s);
    text += line;
  }
  return text;
}

ExitCode RunComparison(const Options& options, const GlobalOptions& global) {
  const EvaluateOptions& evaluate = options.evaluate;
  if (!evaluate.policies.empty() || !evaluate.motions.empty() || !evaluate.trajectories.empty()) {
    throw InputError({"evaluate planners plans what it judges", "",
                      "--policy, --motion and --trajectory have no use here",
                      "use evaluate table1 for them"});
  }
  Stopwatch stopwatch;
  OutputFolder out(evaluate.out);
  stopwatch.Start("evaluation_s");
  std::vector<PlannerComparison> tasks;
  std::map<std::string, double> seconds;
  if (!evaluate.rig_file.empty() && options.design.num_believed > 0) {
    throw InputError({"--believed has no use here", "", "--rig-file names one rig",
                      "leave it out, or use --rigs"});
  }
  for (const Task task : TasksOf(evaluate)) {
    const ContestSetting setting = SettingOf(evaluate, global, task, {200, 50, 20});
    CheckFidelity(setting);
    const Rng rng = Rng(global.seed).Stream("planners");
    const MotionDesignProblem problem = MakeDesignProblem(
        task, setting.carrier,
        BelievedRigs(setting.rigs, options.design.num_believed, rng, PlanningScene(setting)),
        options.design);
    tasks.push_back(
        ComparePlanners(setting, problem, RunPlanners(problem, options, rng, &seconds)));
  }
  EvaluationPart part = PartOfPlanners(tasks);
  part.text += SecondsText(seconds);
  part.seconds = std::move(seconds);
  return CommitPart(part, evaluate.out, global, &stopwatch, &out);
}

}  // namespace

Action SetUpEvaluatePlanners(CLI::App& app, const GlobalOptions& global) {
  auto options = std::make_shared<Options>();
  // The nominal rig alone: so as many motions are tried as there are evaluations.
  options->design.num_believed = 0;
  AddEvaluateOptions(app, &options->evaluate);
  AddDesignArguments(app, &options->design);
  app.add_option("--budgets", options->budgets, "Information evaluations of one plan")
      ->delimiter(',')
      ->check(CLI::Range(15, 100000000))
      ->capture_default_str();
  app.add_option("--repetitions", options->repetitions, "Plans of each, with draws of their own")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  return [options, &global] { return RunComparison(*options, global); };
}

}  // namespace calibrato
