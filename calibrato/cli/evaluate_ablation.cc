// `calibrato evaluate ablation`: what each difference of the paper's learner costs or brings.

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "calibrato/base/input_error.h"
#include "calibrato/base/parallel.h"
#include "calibrato/base/progress.h"
#include "calibrato/cli/evaluate_options.h"
#include "calibrato/cli/evaluate_parts.h"
#include "calibrato/cli/learn_environment.h"
#include "calibrato/cli/output.h"
#include "calibrato/evaluation/ablation.h"
#include "calibrato/learning/agent.h"
#include "calibrato/learning/trainer.h"
#include "calibrato/simulation/rig_distribution.h"

namespace calibrato {
namespace {

struct Options {
  EvaluateOptions evaluate;
  int episodes = 200;
  std::vector<std::string> variants;  // Groups or names; empty: all.
};

// One way to learn.
struct Variant {
  std::string group;
  std::string name;
  LearnSetting setting;
  LearnOptions learn;
};

// Those that the task's episodes or its learner can make.
std::vector<std::string> MistakesOf(Task task) {
  std::vector<std::string> names = {"constant-accuracy"};
  const std::vector<std::string> of_task =
      task == Task::kIntrinsic
          ? std::vector<std::string>{"carried-coverage", "lost-coverage"}
          : std::vector<std::string>{"duration-entropy", "conditional-covariance", "swapped-noise",
                                     "wrong-truth"};
  names.insert(names.end(), of_task.begin(), of_task.end());
  for (const char* of_all : {"silent-refusals", "frozen-swarm", "masked-histories",
                             "tests-remembered", "last-test", "all"}) {
    names.emplace_back(of_all);
  }
  return names;
}

std::vector<std::string> RewardsOf(Task task) {
  if (task == Task::kIntrinsic) {
    return {"coverage", "relative_error", "path_length", "accuracy_bonus", "refusal"};
  }
  return {"empirical", "information", "relative_error", "path_length", "refusal"};
}

// The baseline first.
std::vector<Variant> VariantsOf(Task task, const Options& options, uint64_t seed) {
  Variant baseline{"baseline", "baseline", {}, {}};
  baseline.setting.task = TaskName(task);
  baseline.setting.carrier = options.evaluate.carrier;
  baseline.setting.fidelity = options.evaluate.fidelity;
  baseline.setting.rigs =
      options.evaluate.rig_file.empty() ? options.evaluate.rigs : options.evaluate.rig_file;
  baseline.learn.task = task;
  baseline.learn.carrier = CarrierFromName(options.evaluate.carrier);
  baseline.learn.seed = seed;
  baseline.learn.num_episodes = options.episodes;
  baseline.learn.stages = PaperStages(task, options.episodes);
  std::vector<Variant> variants = {baseline};
  const auto add = [&](const std::string& group, const std::string& name,
                       const std::function<void(Variant*)>& change) {
    Variant variant = baseline;
    variant.group = group;
    variant.name = name;
    change(&variant);
    variants.push_back(std::move(variant));
  };
  for (const std::string& name : MistakesOf(task)) {
    add("mistakes", "mistake " + name, [&](Variant* v) {
      v->setting.mistakes = name == "all" ? "" : name;
      if (name == "all") {
        for (const std::string& each : MistakesOf(task)) {
          if (each != "all") v->setting.mistakes += (v->setting.mistakes.empty() ? "" : ",") + each;
        }
      }
      v->learn.mistakes = MistakesFromNames(v->setting.mistakes);
      v->learn.networks.mask_histories = v->learn.mistakes.contains(Mistake::kMaskedHistories);
      v->learn.planning.swarm.frozen = v->learn.mistakes.contains(Mistake::kFrozenSwarm);
    });
  }
  for (const std::string& term : RewardsOf(task)) {
    add("rewards", "without " + term, [&](Variant* v) { v->setting.without = {term}; });
  }
  for (const char* criterion : {"a", "d", "e"}) {
    // The extrinsic baseline has the first; the intrinsic one has no information at all.
    if (task == Task::kExtrinsic && *criterion == 'a') continue;
    add("criteria", std::string("information ") + criterion, [&](Variant* v) {
      v->setting.criterion = criterion;
      v->setting.information_weight = 1.0;
    });
  }
  for (const int loops : {2, 6}) {
    add("loops", std::to_string(loops) + " loops",
        [&](Variant* v) { v->setting.num_loops = loops; });
  }
  for (const char* limit : {"0.0075", "0.03"}) {
    add("limits", std::string("limit ") + limit,
        [&](Variant* v) { v->learn.planning.swarm.limit = std::stod(limit); });
  }
  for (const int units : {64, 512}) {
    add("networks", std::to_string(units) + " units",
        [&](Variant* v) { v->learn.networks.hidden_size = units; });
  }
  for (const std::string& planner : AgentNames()) {
    if (planner == kPaperPlanner) continue;
    add("planners", "planner " + planner, [&](Variant* v) { v->learn.planning.planner = planner; });
  }
  return variants;
}

// Those asked for, and the baseline.
std::vector<Variant> Chosen(std::vector<Variant> variants, const std::vector<std::string>& wanted) {
  if (wanted.empty()) return variants;
  std::string all;
  for (const std::string& word : wanted) {
    const bool is_known = std::any_of(variants.begin(), variants.end(), [&](const Variant& each) {
      return each.name == word || each.group == word;
    });
    if (is_known) continue;
    std::string groups;
    for (const Variant& each : variants) {
      if (groups.find(each.group) == std::string::npos) {
        groups += (groups.empty() ? "" : ", ") + each.group;
      }
    }
    throw InputError({"no variant '" + word + "'", "", "the groups are " + groups,
                      "name one of them, or a row of the table"});
  }
  std::erase_if(variants, [&](const Variant& each) {
    return each.group != "baseline" &&
           std::none_of(wanted.begin(), wanted.end(), [&](const std::string& word) {
             return each.name == word || each.group == word;
           });
  });
  return variants;
}

std::string FolderOf(const std::string& out, const Variant& variant) {
  std::string name = variant.name;
  std::replace(name.begin(), name.end(), ' ', '-');
  return out + "/" + variant.setting.task + "/" + name;
}

// @return Nothing if it was interrupted.
std::optional<AblationVariant> Learned(const Variant& variant, const std::string& folder) {
  const LearnEnvironment made = MakeEnvironment(variant.setting);
  LearnOptions learn = variant.learn;
  learn.environment = made.name;
  learn.base_pose = BasePoseBeforeBoard(made.scene);
  learn.resume = std::filesystem::exists(folder + "/checkpoint.bin");
  const LearnResult learned = Learn(learn, *made.environment, folder, &InterruptRequested());
  if (learned.termination == LearnTermination::kInterrupted) return std::nullopt;
  AblationVariant result{
      variant.name, {}, learned.termination_text, learned.num_episodes, learned.num_calibrations};
  if (learned.termination == LearnTermination::kDone) result.motion = learned.motion;
  return result;
}

ExitCode RunAblation(const Options& options, const GlobalOptions& global) {
  if (!options.evaluate.policies.empty() || !options.evaluate.motions.empty() ||
      !options.evaluate.trajectories.empty()) {
    throw InputError({"evaluate ablation learns what it judges", "",
                      "--policy, --motion and --trajectory have no use here",
                      "use evaluate table1 for them"});
  }
  Stopwatch stopwatch;
  OutputFolder out(options.evaluate.out);
  NoteInterruptions();
  std::vector<std::vector<Variant>> of_tasks;
  for (const Task task : TasksOf(options.evaluate)) {
    of_tasks.push_back(Chosen(VariantsOf(task, options, global.seed), options.variants));
    for (const Variant& variant : of_tasks.back()) {
      CheckOptions(variant.learn);
      (void)MakeEnvironment(variant.setting);
    }
  }
  std::vector<Ablation> tasks;
  for (const std::vector<Variant>& variants : of_tasks) {
    const Task task = variants.front().learn.task;
    stopwatch.Start(TaskName(task) + "_training_s");
    const auto learned = ParallelMap<std::optional<AblationVariant>>(
        variants.size(), [&](size_t k) -> std::optional<AblationVariant> {
          const std::string folder = FolderOf(options.evaluate.out, variants[k]);
          auto result = Learned(variants[k], folder);
          if (result && !global.quiet && !global.json) {
            std::fprintf(stderr, "%s, %s: %s\n", TaskName(task).c_str(), variants[k].name.c_str(),
                         result->termination.c_str());
          }
          return result;
        });
    std::vector<AblationVariant> finished;
    for (const auto& each : learned) {
      if (each) finished.push_back(*each);
    }
    if (finished.size() < variants.size()) {
      std::fprintf(stderr, "interrupted; the same command goes on from where it stopped\n");
      return kInterrupted;
    }
    stopwatch.Start(TaskName(task) + "_evaluation_s");
    tasks.push_back(
        EvaluateAblation(SettingOf(options.evaluate, global, task, {500, 50, 20}), finished));
  }
  return CommitPart(PartOfAblation(tasks), options.evaluate.out, global, &stopwatch, &out);
}

}  // namespace

Action SetUpEvaluateAblation(CLI::App& app, const GlobalOptions& global) {
  auto options = std::make_shared<Options>();
  AddEvaluateOptions(app, &options->evaluate);
  app.add_option("--episodes", options->episodes, "Of each variant")
      ->check(CLI::Range(4, 1000000))
      ->capture_default_str();
  app.add_option("--variants", options->variants,
                 "Only these beside the baseline: mistakes, rewards, criteria, loops, limits, "
                 "networks, planners, or a row's name")
      ->delimiter(',');
  return [options, &global] {
    Progress::Silence();
    return RunAblation(*options, global);
  };
}

}  // namespace calibrato
