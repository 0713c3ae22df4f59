#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>

#include "calibrato/base/files.h"
#include "calibrato/base/input_error.h"
#include "calibrato/base/progress.h"
#include "calibrato/cli/command.h"
#include "calibrato/cli/learn_best.h"
#include "calibrato/cli/learn_document.h"
#include "calibrato/cli/learn_environment.h"
#include "calibrato/cli/number_range.h"
#include "calibrato/cli/output.h"
#include "calibrato/learning/mpi_team.h"
#include "calibrato/learning/trainer.h"
#include "calibrato/page/live_page.h"
#include "calibrato/report/report.h"
#include "calibrato/simulation/rig_distribution.h"

namespace calibrato {
namespace {

struct Options {
  LearnSetting setting;
  std::string preset = "best";
  DesignArguments design;
  std::string planner = kPaperPlanner;
  int evaluations = 0;  // 0: those of the paper's swarm.
  int round = 1;
  int episodes = 0;  // 0: the paper's.
  int live_port = -1;
  bool resume = false;
  std::string out;
};

LearnOptions MakeLearnOptions(const Options& options, const GlobalOptions& global) {
  LearnOptions learn;
  learn.task = TaskFromName(options.setting.task);
  learn.carrier = CarrierFromName(options.setting.carrier);
  learn.seed = global.seed;
  learn.num_episodes = options.episodes > 0 ? options.episodes : PaperNumEpisodes(learn.task);
  learn.stages = PaperStages(learn.task, learn.num_episodes);
  learn.round = options.round;
  learn.resume = options.resume;
  learn.mistakes = MistakesFromNames(options.setting.mistakes);
  learn.networks.mask_histories = learn.mistakes.contains(Mistake::kMaskedHistories);
  learn.planning.planner = options.planner;
  SwarmOptions& swarm = learn.planning.swarm;
  swarm.frozen = learn.mistakes.contains(Mistake::kFrozenSwarm);
  if (options.evaluations > 0) {
    swarm.num_iterations = options.evaluations / swarm.num_particles - 1;
  }
  return learn;
}

Value Result(const Options& options, const LearnOptions& learn, const LearnResult& learned) {
  Value result = Value::Object();
  result.Set("kind", "learn")
      .Set("task", options.setting.task)
      .Set("preset", learned.preset)
      .Set("planner", learn.planning.planner)
      .Set("evaluations_a_plan", NumEvaluations(learn.planning))
      .Set("carrier", options.setting.carrier)
      .Set("fidelity", options.setting.fidelity)
      .Set("rigs", options.setting.rigs)
      .Set("reward", options.setting.reward)
      .Set("mistakes", NamesOf(learn.mistakes))
      .Set("round", learn.round)
      .Set("termination", LearnTerminationName(learned.termination))
      .Set("termination_text", learned.termination_text)
      .Set("episodes", learned.num_episodes)
      .Set("calibrations", learned.num_calibrations)
      .Set("information_evaluations", learned.num_information_evaluations)
      .Set("rollbacks", learned.num_rollbacks)
      .Set("best_return", learned.best_return)
      .Set("path_length_m", PathLength(learned.motion));
  return result;
}

// What is shown while it learns: the report of all episodes so far.
LivePage::Content LiveContent(const Options& options) {
  const auto page = [options] {
    Value document = Value::Object();
    document.Set("kind", "learn")
        .Set("task", options.setting.task)
        .Set("preset", options.preset)
        .Set("planner", options.planner)
        .Set("training", TrainingLines(options.out));
    return ReportHtml("Learning, so far", {document});
  };
  const auto data = [options] { return ReadFile(options.out + "/training.jsonl"); };
  return {page, data};
}

// Commits what was learned and tells of it.
ExitCode Tell(const LearnResult& learned, const Value& result, const Rig& scene,
              const Options& options, const GlobalOptions& global, Stopwatch* stopwatch,
              OutputFolder* out) {
  Value plots = Value::Object();
  plots.Set("training", TrainingLines(options.out));
  const Value drawing = LearnedMotionDrawing(learned.motion, scene);
  if (!drawing.IsNull()) plots.Set("motion", drawing);
  CommitResult("Learning", result, plots, stopwatch, out);
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

// What was asked for that only the preset `best` has; empty if nothing.
std::string OptionOfBest(const Options& options) {
  const DesignArguments standard;
  if (options.design.num_believed != standard.num_believed) return "--believed";
  if (options.design.max_path_m != standard.max_path_m) return "--max-path";
  if (options.design.max_time_s != standard.max_time_s) return "--max-time";
  return "";
}

// What was asked for that only the preset `paper` has; empty if nothing.
std::string OptionOfPaper(const Options& options) {
  const Options standard;
  if (options.planner != standard.planner) return "--planner";
  if (options.evaluations != standard.evaluations) return "--evaluations";
  if (options.round != standard.round) return "--round";
  if (options.live_port != standard.live_port) return "--live";
  if (options.setting.criterion != standard.setting.criterion) return "--criterion";
  if (options.setting.information_weight >= 0.0) return "--information-weight";
  if (options.setting.reward != standard.setting.reward) return "--reward";
  if (!options.setting.mistakes.empty()) return "--mistakes";
  return "";
}

// How a process ends that is not the first: that one tells of it.
ExitCode EndedSilently(const LearnResult& learned) {
  switch (learned.termination) {
    case LearnTermination::kDone:
      return kDone;
    case LearnTermination::kInterrupted:
      return kInterrupted;
    default:
      return kNotTrusted;
  }
}

ExitCode RunLearnBest(const Options& options, const GlobalOptions& global, Team& team) {
  const std::string other = OptionOfPaper(options);
  if (!other.empty()) {
    throw InputError({"preset best has no " + other, "", "that is an option of the paper's learner",
                      "add --preset paper, or leave out " + other});
  }
  Stopwatch stopwatch;
  OutputFolder out(options.out);
  LearnBestArguments arguments;
  arguments.setting = options.setting;
  arguments.design = options.design;
  arguments.num_episodes = options.episodes;
  arguments.seed = global.seed;
  arguments.resume = options.resume;
  arguments.out = options.out;
  arguments.team = &team;
  if (team.is_first() && !global.quiet && options.episodes > 0 &&
      NumEpisodesOfBest(options.episodes) != options.episodes) {
    std::fprintf(stderr, "note: preset best plays whole rounds of %d: %d of the %d episodes\n",
                 EpisodesPerRoundOfBest(options.episodes), NumEpisodesOfBest(options.episodes),
                 options.episodes);
  }
  const Rig scene = MakeEnvironment(options.setting).scene;
  stopwatch.Start("training_s");
  const LearnResult learned = LearnBest(arguments);
  if (!team.is_first()) return EndedSilently(learned);
  stopwatch.Add("divided_s", learned.divided_s);
  if (learned.termination == LearnTermination::kInterrupted) {
    std::fprintf(stderr, "%s\n", learned.termination_text.c_str());
    return kInterrupted;
  }
  Value result = Value::Object();
  result.Set("kind", "learn")
      .Set("task", options.setting.task)
      .Set("preset", learned.preset)
      .Set("carrier", options.setting.carrier)
      .Set("fidelity", options.setting.fidelity)
      .Set("rigs", options.setting.rigs)
      .Set("termination", LearnTerminationName(learned.termination))
      .Set("termination_text", learned.termination_text)
      .Set("episodes", learned.num_episodes)
      .Set("calibrations", learned.num_calibrations)
      .Set("information_evaluations", learned.num_information_evaluations)
      .Set("best_return", learned.best_return)
      .Set("path_length_m", PathLength(learned.motion));
  return Tell(learned, result, scene, options, global, &stopwatch, &out);
}

ExitCode RunLearn(const Options& options, const GlobalOptions& global) {
  Stopwatch stopwatch;
  const std::unique_ptr<Team> team = MakeMpiTeam();
  if (!team->is_first()) Progress::Silence();
  if (options.preset == "best") return RunLearnBest(options, global, *team);
  if (options.preset != "paper") {
    throw InputError({"unknown preset '" + options.preset + "'", "", "there are best and paper",
                      "use --preset best"});
  }
  const std::string other = OptionOfBest(options);
  if (!other.empty()) {
    throw InputError({"preset paper has no " + other, "", "that is an option of preset best",
                      "leave out " + other + ", or --preset paper"});
  }
  OutputFolder out(options.out);
  LearnOptions learn = MakeLearnOptions(options, global);
  CheckOptions(learn);
  const LearnEnvironment made = MakeEnvironment(options.setting);
  learn.environment = made.name;
  learn.base_pose = BasePoseBeforeBoard(made.scene);
  if (team->is_first() && team->size() > learn.round && !global.quiet) {
    std::fprintf(stderr,
                 "note: %d processes share rounds of %d: add --round %d, or some will have nothing "
                 "to do\n",
                 team->size(), learn.round, team->size());
  }
  std::optional<LivePage> live;
  if (options.live_port >= 0 && team->is_first()) {
    live.emplace(options.live_port, "--live", LiveContent(options));
    if (!global.quiet) std::fprintf(stderr, "live: %s\n", live->address().c_str());
  }

  NoteInterruptions();
  stopwatch.Start("training_s");
  const LearnResult learned =
      Learn(learn, *made.environment, options.out, &InterruptRequested(), team.get());
  if (!team->is_first()) return EndedSilently(learned);
  stopwatch.Add("divided_s", learned.divided_s);
  if (learned.termination == LearnTermination::kInterrupted) {
    std::fprintf(stderr, "%s\n", learned.termination_text.c_str());
    return kInterrupted;
  }
  const Value result = Result(options, learn, learned);
  return Tell(learned, result, made.scene, options, global, &stopwatch, &out);
}

}  // namespace

Action SetUpLearn(CLI::App& app, const GlobalOptions& global) {
  auto options = std::make_shared<Options>();
  LearnSetting& setting = options->setting;
  app.add_option("task", setting.task, "intrinsic, extrinsic or joint")->required();
  app.add_option("--preset", options->preset, "best or paper")->capture_default_str();
  app.add_option("--carrier", setting.carrier, "free or arm")->capture_default_str();
  app.add_option("--fidelity", setting.fidelity, "fast, physical or rendered")
      ->capture_default_str();
  app.add_option("--rigs", setting.rigs,
                 "paper, paper-undistorted, broad, paper-real, broad-real, or a RIG.yaml")
      ->capture_default_str();
  app.add_option("--reward", setting.reward, "error, or reprojection where the truth is not known")
      ->capture_default_str();
  app.add_option("--criterion", setting.criterion, "Of the information: a, d or e")
      ->capture_default_str();
  app.add_option("--information-weight", setting.information_weight,
                 "Of the information in the reward, per nat (intrinsic 0, else 1)")
      ->check(NumberBetween(0.0, 1e9));
  app.add_option("--mistakes", setting.mistakes,
                 "Of the original implementation, to measure what they cost: names with commas "
                 "between, or all (docs/differences.md)");
  app.add_option("--planner", options->planner,
                 "pso-paper, random-shooting, pso, pso-p, cem, icem, cma-es, q-library, sac")
      ->capture_default_str();
  app.add_option("--evaluations", options->evaluations,
                 "Sequences that a plan may evaluate, in fifteens (90)")
      ->check(CLI::Range(15, 1500000));
  app.add_option("--round", options->round, "Episodes played side by side")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--episodes", options->episodes,
                 "Of all stages (best: 96, in whole rounds of 8; paper: 1000, extrinsic 1650, 1000 "
                 "of them without "
                 "calibrations)")
      ->check(CLI::Range(2, 1000000));
  app.add_option("--live", options->live_port,
                 "Port of a page on this machine that shows the training; 0 for any")
      ->check(CLI::Range(0, 65535));
  AddDesignArguments(app, &options->design);
  app.add_flag("--resume", options->resume, "Go on from the checkpoint in --out");
  app.add_option("--out", options->out, "Folder for the policy and the result")->required();
  return [options, &global] { return RunLearn(*options, global); };
}

}  // namespace calibrato
