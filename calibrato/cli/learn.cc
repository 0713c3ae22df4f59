#include <cstdio>
#include <filesystem>
#include <memory>
#include <sstream>
#include <string>

#include "calibrato/base/files.h"
#include "calibrato/base/input_error.h"
#include "calibrato/cli/command.h"
#include "calibrato/cli/output.h"
#include "calibrato/cli/parse.h"
#include "calibrato/learning/trainer.h"
#include "calibrato/mdp/intrinsic_environment.h"

namespace calibrato {
namespace {

struct Options {
  std::string task;
  std::string preset = "paper";
  std::string carrier = "free";
  std::string fidelity = "fast";
  std::string rigs = "paper";
  int episodes = 1000;
  bool resume = false;
  std::string out;
};

IntrinsicTask MakeTask(const Options& options) {
  IntrinsicTask task;
  task.carrier = CarrierFromName(options.carrier);
  if (std::filesystem::is_regular_file(options.rigs)) {
    task.fixed_rig = ReadRig(options.rigs);
  } else {
    task.rigs = RigDistributionFromName(options.rigs);
  }
  return task;
}

// The rigs by name, or the content of a rig's file by a digest of it.
std::string EnvironmentName(const Options& options, const IntrinsicTask& task) {
  if (!task.fixed_rig) return "rigs " + options.rigs;
  const uint64_t digest = Rng(0).Stream(ToYaml(ToValue(*task.fixed_rig))).NextBits();
  return "rig file of digest " + std::to_string(digest);
}

Value Result(const Options& options, const LearnResult& learned) {
  Value result = Value::Object();
  result.Set("kind", "learn")
      .Set("task", options.task)
      .Set("preset", learned.preset)
      .Set("carrier", options.carrier)
      .Set("rigs", options.rigs)
      .Set("termination", LearnTerminationName(learned.termination))
      .Set("termination_text", learned.termination_text)
      .Set("episodes", learned.num_episodes)
      .Set("calibrations", learned.num_calibrations)
      .Set("information_evaluations", learned.num_information_evaluations)
      .Set("best_return", learned.best_return)
      .Set("path_length_m", PathLength(learned.motion));
  return result;
}

// training.jsonl as one array.
Value TrainingLines(const std::string& folder) {
  const std::string path = folder + "/training.jsonl";
  std::istringstream lines(ReadFile(path));
  Value array = Value::Array();
  for (std::string line; std::getline(lines, line);) array.Append(ParseJson(line, path));
  return array;
}

ExitCode RunLearn(const Options& options, const GlobalOptions& global) {
  Stopwatch stopwatch;
  if (TaskFromName(options.task) != Task::kIntrinsic || options.preset != "paper" ||
      options.fidelity != "fast") {
    throw InputError({"not in this version: learn " + options.task + " --preset " + options.preset +
                          " --fidelity " + options.fidelity,
                      "", "", "use calibrato learn intrinsic --preset paper --fidelity fast"});
  }
  OutputFolder out(options.out);
  LearnOptions learn;
  learn.task = Task::kIntrinsic;
  learn.carrier = CarrierFromName(options.carrier);
  learn.seed = global.seed;
  learn.num_episodes = options.episodes;
  learn.resume = options.resume;
  const IntrinsicTask task = MakeTask(options);
  learn.environment = EnvironmentName(options, task);
  IntrinsicEnvironment environment(task);

  NoteInterruptions();
  stopwatch.Start("training_s");
  const LearnResult learned = Learn(learn, environment, options.out, &InterruptRequested());
  if (learned.termination == LearnTermination::kInterrupted) {
    std::fprintf(stderr, "%s\n", learned.termination_text.c_str());
    return kInterrupted;
  }
  const Value result = Result(options, learned);
  Value plots = Value::Object();
  plots.Set("training", TrainingLines(options.out));
  CommitResult("Learning", result, plots, &stopwatch, &out);
  if (global.json) {
    std::fputs(ToJson(result).c_str(), stdout);
  } else if (!global.quiet) {
    std::printf(
        "%d episodes, %lld calibrations, best return %.3f; motion of %.3f m: "
        "%s/policy/motion.yaml\nreport: %s/report.html\n",
        learned.num_episodes, static_cast<long long>(learned.num_calibrations), learned.best_return,
        PathLength(learned.motion), options.out.c_str(), options.out.c_str());
  }
  if (learned.termination == LearnTermination::kDone) return kDone;
  std::fprintf(stderr, "%s\n", learned.termination_text.c_str());
  return kNotTrusted;
}

}  // namespace

Action SetUpLearn(CLI::App& app, const GlobalOptions& global) {
  auto options = std::make_shared<Options>();
  app.add_option("task", options->task, "intrinsic")->required();
  app.add_option("--preset", options->preset, "paper")->capture_default_str();
  app.add_option("--carrier", options->carrier, "free or arm")->capture_default_str();
  app.add_option("--fidelity", options->fidelity, "fast")->capture_default_str();
  app.add_option("--rigs", options->rigs,
                 "paper, paper-undistorted, broad, paper-real, broad-real, or a RIG.yaml")
      ->capture_default_str();
  app.add_option("--episodes", options->episodes, "Episodes of four loops each")
      ->check(CLI::Range(2, 1000000))
      ->capture_default_str();
  app.add_flag("--resume", options->resume, "Go on from the checkpoint in --out");
  app.add_option("--out", options->out, "Folder for the policy and the result")->required();
  return [options, &global] { return RunLearn(*options, global); };
}

}  // namespace calibrato
