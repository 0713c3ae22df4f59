#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "calibrato/base/input_error.h"
#include "calibrato/cli/command.h"
#include "calibrato/cli/output.h"
#include "calibrato/cli/parse.h"
#include "calibrato/evaluation/table1.h"
#include "calibrato/evaluation/table1_document.h"

namespace calibrato {
namespace {

constexpr int kNumRigs = 500;
constexpr int kNumRigsQuick = 100;

struct Options {
  std::string task = "intrinsic";
  std::string policy;
  std::vector<std::string> motions;
  std::string carrier = "free";
  std::string fidelity = "fast";
  std::string rigs = "paper";
  int num_rigs = kNumRigs;
  bool quick = false;
  std::string out;
};

// The motion of a policy's folder, or of the folder that `learn` wrote it into.
Motion PolicyMotion(const std::string& folder) {
  namespace fs = std::filesystem;
  for (const fs::path& path :
       {fs::path(folder) / "motion.yaml", fs::path(folder) / "policy" / "motion.yaml"}) {
    if (fs::exists(path)) return ReadMotion(path.string());
  }
  throw InputError({"no policy", folder, "neither motion.yaml nor policy/motion.yaml is there",
                    "give the folder that calibrato learn wrote, once it has finished"});
}

ExitCode RunEvaluateTable1(const Options& options, const GlobalOptions& global) {
  Stopwatch stopwatch;
  OutputFolder out(options.out);
  if (TaskFromName(options.task) != Task::kIntrinsic || options.fidelity != "fast") {
    throw InputError(
        {"not in this version: --task " + options.task + " --fidelity " + options.fidelity, "", "",
         "use --task intrinsic --fidelity fast"});
  }
  Table1Options table_options;
  table_options.carrier = CarrierFromName(options.carrier);
  table_options.rigs = RigDistributionFromName(options.rigs);
  table_options.num_rigs = options.quick ? kNumRigsQuick : options.num_rigs;
  table_options.seed = global.seed;
  if (!options.policy.empty()) {
    table_options.motions.push_back({"learned", PolicyMotion(options.policy)});
  }
  for (const std::string& path : options.motions) {
    table_options.motions.push_back(
        {std::filesystem::path(path).stem().string(), ReadMotion(path)});
  }
  stopwatch.Start("evaluation_s");
  const Table1 table = EvaluateTable1(table_options);
  const Value result = ToValue(table);
  Value plots = Value::Object();
  plots.Set("plots", Table1Plots(table));
  out.Add("table1.json", ToJson(result));
  CommitResult("Table 1", result, plots, &stopwatch, &out);
  if (global.json) {
    std::fputs(ToJson(result).c_str(), stdout);
  } else if (!global.quiet) {
    std::printf("%sreport: %s/report.html\n", Table1Text(table).c_str(), options.out.c_str());
  }
  return kDone;
}

}  // namespace

Action SetUpEvaluateTable1(CLI::App& app, const GlobalOptions& global) {
  auto options = std::make_shared<Options>();
  app.add_option("--task", options->task, "intrinsic")->capture_default_str();
  app.add_option("--policy", options->policy, "Folder of a learned policy");
  app.add_option("--motion", options->motions, "MOTION.yaml files of others, a row each");
  app.add_option("--carrier", options->carrier, "free or arm")->capture_default_str();
  app.add_option("--fidelity", options->fidelity, "fast")->capture_default_str();
  app.add_option("--rigs", options->rigs,
                 "paper, paper-undistorted, broad, paper-real or broad-real")
      ->capture_default_str();
  CLI::Option* num_rigs =
      app.add_option("--num-rigs", options->num_rigs, "How many rigs each policy is tried on")
          ->check(CLI::Range(2, 1000000))
          ->capture_default_str();
  app.add_flag("--quick", options->quick, "100 rigs")->excludes(num_rigs);
  app.add_option("--out", options->out, "Folder for the result")->required();
  return [options, &global] { return RunEvaluateTable1(*options, global); };
}

}  // namespace calibrato
