#include "calibrato/cli/learn_environment.h"

#include <filesystem>
#include <optional>

#include "calibrato/base/input_error.h"
#include "calibrato/base/value.h"
#include "calibrato/cli/parse.h"
#include "calibrato/mdp/extrinsic_environment.h"
#include "calibrato/mdp/intrinsic_environment.h"
#include "calibrato/mdp/joint_environment.h"
#include "calibrato/motion/paper_scene.h"

namespace calibrato {
namespace {

constexpr double kReprojectionWeight = 2.0;  // Paper, Table 5, both tasks.

DesignCriterion CriterionFromName(const std::string& name) {
  if (name == "a") return DesignCriterion::kA;
  if (name == "d") return DesignCriterion::kD;
  if (name == "e") return DesignCriterion::kE;
  throw InputError(
      {"unknown criterion '" + name + "'", "", "there are a, d and e", "use --criterion a"});
}

bool IsReprojection(const std::string& reward) {
  if (reward == "error" || reward == "reprojection") return reward == "reprojection";
  throw InputError({"unknown reward '" + reward + "'", "", "there are error and reprojection",
                    "use --reward error"});
}

[[noreturn]] void FailTerm(const std::string& term) {
  throw InputError(
      {"no such term of the reward: " + term, "", "the task does not have it", "leave it out"});
}

void LeaveOut(const std::vector<std::string>& terms, IntrinsicRewardWeights* weights) {
  for (const std::string& term : terms) {
    if (term == "coverage") {
      weights->coverage = 0.0;
    } else if (term == "relative_error") {
      weights->relative_error = 0.0;
    } else if (term == "path_length") {
      weights->path_length = 0.0;
    } else if (term == "accuracy_bonus") {
      weights->accuracy_bonus = 0.0;
    } else if (term == "refusal") {
      weights->refusal = 0.0;
    } else {
      FailTerm(term);
    }
  }
}

void LeaveOut(const std::vector<std::string>& terms, ExtrinsicRewardWeights* weights) {
  for (const std::string& term : terms) {
    if (term == "empirical") {
      weights->empirical = 0.0;
    } else if (term == "information") {
      weights->information = 0.0;
    } else if (term == "relative_error") {
      weights->relative_error = 0.0;
    } else if (term == "path_length") {
      weights->path_length = 0.0;
    } else if (term == "refusal") {
      weights->refusal = 0.0;
    } else {
      FailTerm(term);
    }
  }
}

// What all tasks have.
template <typename Environment, typename Task>
std::unique_ptr<Environment> Made(Task task, const LearnSetting& setting,
                                  const std::optional<Rig>& rig) {
  task.carrier = CarrierFromName(setting.carrier);
  task.fidelity = FidelityFromName(setting.fidelity);
  if (rig) {
    task.fixed_rig = rig;
  } else {
    task.rigs = RigDistributionFromName(setting.rigs);
  }
  task.criterion = CriterionFromName(setting.criterion);
  if (setting.num_loops > 0) task.num_loops = setting.num_loops;
  return std::make_unique<Environment>(std::move(task));
}

std::unique_ptr<Environment> MakeIntrinsic(const LearnSetting& setting,
                                           const std::optional<Rig>& rig) {
  IntrinsicTask task;
  task.mistakes = MistakesFromNames(setting.mistakes);
  if (setting.information_weight >= 0.0) task.weights.information = setting.information_weight;
  if (IsReprojection(setting.reward)) {
    task.weights.relative_error = 0.0;
    task.weights.accuracy_bonus = 0.0;
    task.weights.reprojection = kReprojectionWeight;
  }
  LeaveOut(setting.without, &task.weights);
  return Made<IntrinsicEnvironment>(std::move(task), setting, rig);
}

std::unique_ptr<Environment> MakeExtrinsic(const LearnSetting& setting,
                                           const std::optional<Rig>& rig) {
  ExtrinsicTask task;
  task.mistakes = MistakesFromNames(setting.mistakes);
  if (setting.information_weight >= 0.0) task.weights.information = setting.information_weight;
  if (IsReprojection(setting.reward)) {
    task.weights.relative_error = 0.0;
    task.weights.reprojection = kReprojectionWeight;
  }
  LeaveOut(setting.without, &task.weights);
  return Made<ExtrinsicEnvironment>(std::move(task), setting, rig);
}

std::unique_ptr<Environment> MakeJoint(const LearnSetting& setting, const std::optional<Rig>& rig) {
  JointTask task;
  if (!setting.without.empty()) FailTerm(setting.without.front());
  for (const Mistake mistake : MistakesFromNames(setting.mistakes)) {
    if (mistake >= Mistake::kFrozenSwarm) continue;  // Those of the learner.
    throw InputError({"no such mistake in the joint task: " + MistakeName(mistake), "",
                      "the original had no joint task",
                      "learn intrinsic or extrinsic, or leave it out"});
  }
  if (setting.information_weight >= 0.0) {
    task.weights.intrinsic_information = setting.information_weight;
    task.weights.extrinsic_information = setting.information_weight;
  }
  if (IsReprojection(setting.reward)) {
    task.weights.intrinsic_error = 0.0;
    task.weights.extrinsic_error = 0.0;
    task.weights.accuracy_bonus = 0.0;
    task.weights.reprojection = kReprojectionWeight;
  }
  return Made<JointEnvironment>(std::move(task), setting, rig);
}

}  // namespace

LearnEnvironment MakeEnvironment(const LearnSetting& setting) {
  const Task task = TaskFromName(setting.task);
  const bool needs_arm = FidelityFromName(setting.fidelity) == Fidelity::kPhysical;
  if (needs_arm && CarrierFromName(setting.carrier) != Carrier::kArm) {
    throw InputError({"fidelity physical is that of an arm", "",
                      "the carrier '" + setting.carrier + "' has no dynamics",
                      "use --carrier arm, or --fidelity fast"});
  }
  std::optional<Rig> rig;
  std::string rigs = "rigs " + setting.rigs;
  if (std::filesystem::is_regular_file(setting.rigs)) {
    rig = ReadRig(setting.rigs);
    const uint64_t digest = Rng(0).Stream(ToYaml(ToValue(*rig))).NextBits();
    rigs = "rig file of digest " + std::to_string(digest);
  }
  LearnEnvironment made;
  made.environment = task == Task::kIntrinsic   ? MakeIntrinsic(setting, rig)
                     : task == Task::kExtrinsic ? MakeExtrinsic(setting, rig)
                                                : MakeJoint(setting, rig);
  made.name = rigs + ", fidelity " + setting.fidelity + ", reward " + setting.reward +
              ", criterion " + setting.criterion + ", mistakes " +
              NamesOf(MistakesFromNames(setting.mistakes));
  if (setting.information_weight >= 0.0) {
    made.name += ", information weight " + FormatNumber(setting.information_weight);
  }
  for (const std::string& term : setting.without) made.name += ", without " + term;
  if (setting.num_loops > 0) made.name += ", " + std::to_string(setting.num_loops) + " loops";
  made.scene = rig.value_or(PaperRig());
  return made;
}

}  // namespace calibrato
