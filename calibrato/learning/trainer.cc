#include "calibrato/learning/trainer.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>
#include <utility>

#include "calibrato/base/files.h"
#include "calibrato/base/input_error.h"
#include "calibrato/base/progress.h"
#include "calibrato/base/value.h"
#include "calibrato/learning/checkpoint.h"
#include "calibrato/learning/episode.h"
#include "calibrato/learning/mpc.h"
#include "calibrato/learning/networks.h"
#include "calibrato/learning/policy.h"

namespace calibrato {
namespace {

constexpr size_t kMaxCheckpointBytes = size_t{4} << 30;

std::string CheckpointPath(const std::string& folder) { return folder + "/checkpoint.bin"; }

// @return Whether it was missing.
bool MakeFolder(const std::string& folder) {
  std::error_code error;
  const bool is_new = std::filesystem::create_directories(folder, error);
  if (!std::filesystem::is_directory(folder)) {
    throw InputError({"cannot make output folder", folder, error ? error.message() : "",
                      "choose another one with --out"});
  }
  return is_new;
}

// training.jsonl as it grows: seen by who watches, and complete in every checkpoint.
class TrainingLog {
 public:
  TrainingLog(const std::string& folder, std::string lines)
      : path_(folder + "/training.jsonl"), lines_(std::move(lines)) {
    WriteFileAtomically(path_, lines_);
    file_.open(path_, std::ios::binary | std::ios::app);
  }

  void Append(const Value& line) {
    const std::string text = ToJsonLine(line) + "\n";
    lines_ += text;
    file_ << text << std::flush;
    if (!file_) {
      throw InputError(
          {"cannot write training log", path_, "", "free some space, then continue with --resume"});
    }
  }

  [[nodiscard]] const std::string& lines() const { return lines_; }

 private:
  std::string path_;
  std::string lines_;
  std::ofstream file_;
};

Checkpoint ReadCheckpoint(const std::string& folder) {
  const std::string path = CheckpointPath(folder);
  if (!std::filesystem::exists(path)) {
    throw InputError({"nothing to resume", path, "there is no such file",
                      "leave out --resume, or give the --out of the run to continue"});
  }
  return CheckpointFromBytes(ReadFile(path, kMaxCheckpointBytes), path);
}

[[noreturn]] void FailResume(const std::string& folder, const std::string& why,
                             const std::string& remedy) {
  throw InputError({"cannot resume", CheckpointPath(folder), why, remedy});
}

void CheckSameCourse(const Checkpoint& checkpoint, const LearnOptions& options,
                     const std::string& folder) {
  const auto expected = CourseOfTraining(options);
  if (checkpoint.options.size() != expected.size()) {
    FailResume(folder, "it was written with other options", "learn again without --resume");
  }
  for (size_t i = 0; i < expected.size(); ++i) {
    const auto& [name, value] = checkpoint.options[i];
    if (checkpoint.options[i] == expected[i]) continue;
    FailResume(folder,
               "its " + name + " is " + value + ", " + expected[i].second + " was asked for",
               "ask for " + value + ", or learn again without --resume");
  }
  if (checkpoint.num_episodes_done > options.num_episodes) {
    FailResume(folder,
               "it has " + std::to_string(checkpoint.num_episodes_done) + " episodes, " +
                   std::to_string(options.num_episodes) + " were asked for",
               "ask for at least " + std::to_string(checkpoint.num_episodes_done));
  }
}

void CheckSizes(const Checkpoint& checkpoint, const HistoryModel& model, int horizon,
                const std::string& folder) {
  const auto is_whole = [](const NetworkWeights& network, size_t size) {
    return network.weights.size() == size && network.first_moment.size() == size &&
           network.second_moment.size() == size;
  };
  bool fits = is_whole(checkpoint.model.dynamics, model.num_dynamics_weights()) &&
              is_whole(checkpoint.model.reward, model.num_reward_weights()) &&
              checkpoint.model.normalisation.observation_mean.size() == model.observation_size() &&
              checkpoint.particle_memory.size() == static_cast<size_t>(horizon);
  for (size_t t = 0; fits && t < checkpoint.particle_memory.size(); ++t) {
    const auto steps_left = horizon - static_cast<Eigen::Index>(t);
    fits = checkpoint.particle_memory[t].rows() == steps_left * LoopCoefficients::RowsAtCompileTime;
  }
  if (!fits) {
    FailResume(folder, "it belongs to another environment (observation size or horizon)",
               "learn again without --resume");
  }
}

LearnOptions Resolved(LearnOptions options, const Checkpoint* checkpoint) {
  if (!options.num_warm_up_episodes) {
    options.num_warm_up_episodes =
        checkpoint != nullptr ? checkpoint->num_warm_up_episodes : NumWarmUpEpisodes(options);
  }
  CheckOptions(options);
  return options;
}

class Trainer {
 public:
  Trainer(const LearnOptions& options, Environment& environment, std::string folder,
          const Checkpoint* checkpoint)
      : options_(options),
        environment_(environment),
        folder_(std::move(folder)),
        rng_(options.seed),
        model_(MakeModel()),
        replay_memory_(static_cast<size_t>(options.replay_capacity)),
        log_(folder_, FirstLines(checkpoint)) {
    for (int t = 0; t < environment_.horizon(); ++t) {
      particle_memory_.emplace_back(
          LoopCoefficients::RowsAtCompileTime * (environment_.horizon() - t), 0);
    }
    if (checkpoint != nullptr) {
      num_episodes_done_ = checkpoint->num_episodes_done;
      num_calibrations_ = checkpoint->num_calibrations;
      best_return_ = checkpoint->best_return;
      best_test_return_ = checkpoint->best_test_return;
      best_test_actions_ = checkpoint->best_test_actions;
      model_.Restore(checkpoint->model);
      replay_memory_ = checkpoint->replay_memory;
      particle_memory_ = checkpoint->particle_memory;
    } else {
      SaveCheckpoint();
    }
  }

  LearnResult Run(const std::atomic<bool>* interrupt) {
    Progress progress("learning", options_.num_episodes);
    progress.Advance(num_episodes_done_);
    while (num_episodes_done_ < options_.num_episodes) {
      if (interrupt != nullptr && interrupt->load()) {
        SaveCheckpoint();
        return Ended(LearnTermination::kInterrupted, "interrupted after episode " +
                                                         std::to_string(num_episodes_done_) +
                                                         "; continue with --resume");
      }
      // Before the next episode, not after the last: so it stands outside the checkpoint between,
      // and a run that ends here and is continued later is the run that never ended.
      if (num_episodes_done_ % options_.test_every == 0 &&
          num_episodes_done_ > *options_.num_warm_up_episodes) {
        const EpisodeRecord test = PlayTest();
        if (test.divergence) return Diverged(*test.divergence);
      }
      const EpisodeRecord record = PlayNext();
      if (record.divergence) return Diverged(*record.divergence);
      progress.Advance(1, Remark(record));
      if (num_episodes_done_ % options_.checkpoint_every == 0 ||
          num_episodes_done_ == options_.num_episodes) {
        SaveCheckpoint();
      }
    }
    return Finish();
  }

 private:
  HistoryModel MakeModel() const {
    Rng rng = rng_.Stream("weights");
    return {environment_.observation_size(), options_.networks, options_.planning.swarm.limit, rng};
  }

  // Checks first: nothing may be written over if the checkpoint is of no use.
  std::string FirstLines(const Checkpoint* checkpoint) const {
    if (checkpoint == nullptr) return "";
    CheckSizes(*checkpoint, model_, environment_.horizon(), folder_);
    return checkpoint->training_jsonl;
  }

  static std::string Remark(const EpisodeRecord& record) {
    char text[80];
    std::snprintf(text, sizeof(text), "return %.3g  error %.3g %%", record.total_reward,
                  100.0 * record.final_relative_error);
    return text;
  }

  void Account(const EpisodeRecord& record) {
    num_calibrations_ += static_cast<int64_t>(record.executed.size());
    best_return_ = std::max(best_return_, record.total_reward);
    log_.Append(ToValue(record, num_episodes_done_));
  }

  Plan PlanStep(int step, const History& history, Exploration exploration, Rng& rng) const {
    return PlanAction(model_, history, environment_.horizon() - step,
                      particle_memory_[static_cast<size_t>(step)], options_.planning, exploration,
                      rng);
  }

  // The next random or training episode (Algorithm 1, lines 3 and 5 to 18).
  EpisodeRecord PlayNext() {
    const auto index = static_cast<uint64_t>(num_episodes_done_);
    const bool is_random = num_episodes_done_ < *options_.num_warm_up_episodes;
    if (num_episodes_done_ == *options_.num_warm_up_episodes) {
      model_.SetNormalisation(NormalisationOf(replay_memory_));
    }
    Rng agent_rng = rng_.Stream("agent", index);
    const auto draw = [&](int, const History&) {
      Decision decision;
      const double limit = options_.planning.swarm.limit;
      for (double& coefficient : decision.action) coefficient = agent_rng.Uniform(-limit, limit);
      return decision;
    };
    const auto learn_and_plan = [&](int step, const History& history) {
      Decision decision;
      decision.loss = model_.Train(replay_memory_, agent_rng);
      Plan plan = PlanStep(step, history, Exploration::kTraining, agent_rng);
      particle_memory_[static_cast<size_t>(step)] = std::move(plan.best);
      decision.action = plan.action;
      decision.predicted_return = plan.predicted_return;
      return decision;
    };
    const auto store = [this](const Transition& transition) { replay_memory_.Add(transition); };
    const Rng environment_rng = rng_.Stream("episode", index);
    EpisodeRecord record =
        is_random ? PlayEpisode(environment_, EpisodeKind::kRandom, environment_rng, draw, store)
                  : PlayEpisode(environment_, EpisodeKind::kTraining, environment_rng,
                                learn_and_plan, store);
    if (!record.divergence) {
      ++num_episodes_done_;
      Account(record);
    }
    return record;
  }

  // The rig and the noise of every test are the same, so that tests compare with each other.
  EpisodeRecord PlayTest() {
    Rng agent_rng = rng_.Stream("test agent", static_cast<uint64_t>(num_episodes_done_));
    const auto plan_best = [&](int step, const History& history) {
      const Plan plan = PlanStep(step, history, Exploration::kTesting, agent_rng);
      return Decision{plan.action, std::nullopt, plan.predicted_return};
    };
    EpisodeRecord record = PlayEpisode(environment_, EpisodeKind::kTest, rng_.Stream("test"),
                                       plan_best, [](const Transition&) {});
    if (!record.divergence) {
      Account(record);
      KeepIfBest(record);
    }
    return record;
  }

  void KeepIfBest(const EpisodeRecord& test) {
    const bool is_first = best_test_actions_.cols() == 0;
    if (test.executed.empty() || !(is_first || test.total_reward > best_test_return_)) return;
    best_test_return_ = test.total_reward;
    best_test_actions_.resize(LoopCoefficients::RowsAtCompileTime,
                              static_cast<Eigen::Index>(test.executed.size()));
    for (size_t t = 0; t < test.executed.size(); ++t) {
      best_test_actions_.col(static_cast<Eigen::Index>(t)) = test.executed[t];
    }
  }

  void SaveCheckpoint() const {
    Checkpoint checkpoint;
    checkpoint.options = CourseOfTraining(options_);
    checkpoint.num_warm_up_episodes = *options_.num_warm_up_episodes;
    checkpoint.num_episodes_done = num_episodes_done_;
    checkpoint.num_calibrations = num_calibrations_;
    checkpoint.best_return = best_return_;
    checkpoint.best_test_return = best_test_return_;
    checkpoint.best_test_actions = best_test_actions_;
    checkpoint.model = model_.state();
    checkpoint.replay_memory = replay_memory_;
    checkpoint.particle_memory = particle_memory_;
    checkpoint.training_jsonl = log_.lines();
    WriteFileAtomically(CheckpointPath(folder_), ToBytes(checkpoint));
  }

  LearnResult Ended(LearnTermination termination, std::string text) const {
    LearnResult result;
    result.task = options_.task;
    result.preset = options_.preset;
    result.num_episodes = num_episodes_done_;
    result.num_calibrations = num_calibrations_;
    result.best_return = best_return_;
    result.termination = termination;
    result.termination_text = std::move(text);
    return result;
  }

  LearnResult Diverged(const std::string& what) const {
    return Ended(LearnTermination::kDiverged,
                 "training diverged at episode " + std::to_string(num_episodes_done_ + 1) + ", " +
                     what +
                     ": the networks can't be used; try another seed or a smaller learning "
                     "rate");
  }

  // The motion is what the model chose in a test, as in the paper; of all tests, which meet the
  // same rig and noise, the one with the highest return. The last is not the best: the swarm finds
  // what the model overrates.
  LearnResult Finish() {
    const EpisodeRecord test = PlayTest();
    if (test.divergence) return Diverged(*test.divergence);
    if (best_test_actions_.cols() == 0) {
      return Ended(LearnTermination::kNothingExecuted,
                   "the carrier refused every action of every test: nothing was learned; try "
                   "more episodes");
    }
    Policy policy;
    policy.task = options_.task;
    policy.preset = options_.preset;
    policy.seed = options_.seed;
    policy.num_episodes = num_episodes_done_;
    policy.horizon = environment_.horizon();
    policy.observation_size = environment_.observation_size();
    policy.networks = options_.networks;
    policy.planning = options_.planning;
    policy.model = model_.state();
    policy.particle_memory = particle_memory_;
    policy.motion = BestTestMotion();
    WritePolicy(policy, folder_ + "/policy");
    LearnResult result =
        Ended(LearnTermination::kDone, "done: " + std::to_string(num_episodes_done_) + " episodes");
    result.motion = std::move(policy.motion);
    return result;
  }

  Motion BestTestMotion() const {
    Motion motion;
    motion.carrier = options_.carrier;
    motion.base_pose = options_.base_pose;
    for (const auto& action : best_test_actions_.colwise()) {
      motion.loops.push_back({ScaledAction(action), options_.loop_duration_s});
    }
    motion.provenance = Value::Object()
                            .Set("method", "learned")
                            .Set("task", TaskName(options_.task))
                            .Set("preset", options_.preset)
                            .Set("seed", std::to_string(options_.seed))
                            .Set("episodes", num_episodes_done_);
    return motion;
  }

  const LearnOptions options_;
  Environment& environment_;
  const std::string folder_;
  const Rng rng_;
  HistoryModel model_;
  ReplayMemory replay_memory_;
  ParticleMemory particle_memory_;
  TrainingLog log_;
  int num_episodes_done_ = 0;
  int64_t num_calibrations_ = 0;
  double best_return_ = -std::numeric_limits<double>::infinity();
  double best_test_return_ = 0.0;
  Eigen::MatrixXd best_test_actions_{LoopCoefficients::RowsAtCompileTime, 0};
};

}  // namespace

std::string LearnTerminationName(LearnTermination termination) {
  switch (termination) {
    case LearnTermination::kDone:
      return "done";
    case LearnTermination::kInterrupted:
      return "interrupted";
    case LearnTermination::kDiverged:
      return "diverged";
    case LearnTermination::kNothingExecuted:
      return "nothing executed";
  }
  return "";
}

LearnResult Learn(const LearnOptions& options, Environment& environment, const std::string& folder,
                  const std::atomic<bool>* interrupt) {
  CheckOptions(Resolved(options, nullptr));
  std::optional<Checkpoint> checkpoint;
  if (options.resume) checkpoint = ReadCheckpoint(folder);
  const Checkpoint* const start = checkpoint ? &*checkpoint : nullptr;
  const LearnOptions resolved = Resolved(options, start);
  if (start != nullptr) CheckSameCourse(*start, resolved, folder);
  const bool is_new = MakeFolder(folder);
  std::optional<Trainer> trainer;
  try {
    trainer.emplace(resolved, environment, folder, start);
  } catch (const InputError&) {
    // The disk was full before anything was learned: leave nothing behind.
    std::error_code ignored;
    if (is_new) std::filesystem::remove_all(folder, ignored);
    throw;
  }
  return trainer->Run(interrupt);
}

}  // namespace calibrato
