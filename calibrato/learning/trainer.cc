#include "calibrato/learning/trainer.h"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <deque>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "calibrato/base/files.h"
#include "calibrato/base/input_error.h"
#include "calibrato/base/progress.h"
#include "calibrato/base/value.h"
#include "calibrato/learning/agent.h"
#include "calibrato/learning/byte_stream.h"
#include "calibrato/learning/checkpoint.h"
#include "calibrato/learning/episode.h"
#include "calibrato/learning/policy.h"
#include "calibrato/learning/training_log.h"
#include "calibrato/learning/transition_bytes.h"

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

// The first process reads it for all.
Checkpoint ReadCheckpoint(const std::string& folder, Team& team) {
  const std::string path = CheckpointPath(folder);
  const std::string bytes = OfTheFirst(team, [&] {
    if (!std::filesystem::exists(path)) {
      throw InputError({"nothing to resume", path, "there is no such file",
                        "leave out --resume, or give the --out of the run to continue"});
    }
    return ReadFile(path, kMaxCheckpointBytes);
  });
  return CheckpointFromBytes(bytes, path);
}

// What remains of an episode, in bytes that its process sends to the others.
struct EpisodeSummary {
  int64_t num_executed = 0;
  double total_reward = 0.0;
  double final_relative_error = 0.0;
  std::string line;  // Of training.jsonl.
  double carried_over = 0.0;
};

std::string ToBytes(const EpisodeSummary& summary) {
  ByteWriter writer;
  writer.Write(summary.num_executed);
  writer.Write(summary.total_reward);
  writer.Write(summary.final_relative_error);
  writer.Write(std::string_view(summary.line));
  writer.Write(summary.carried_over);
  return writer.bytes();
}

EpisodeSummary SummaryFromBytes(std::string_view bytes) {
  ByteReader reader(bytes, "the summary of an episode");
  EpisodeSummary summary;
  summary.num_executed = reader.ReadInt();
  summary.total_reward = reader.ReadDouble();
  summary.final_relative_error = reader.ReadDouble();
  summary.line = reader.ReadText();
  summary.carried_over = reader.ReadDouble();
  reader.ExpectEnd();
  return summary;
}

void Write(const Rng::State& state, ByteWriter& writer) {
  writer.Write(static_cast<int64_t>(state.seed));
  for (const uint64_t word : state.words) writer.Write(static_cast<int64_t>(word));
  writer.Write(state.spare_normal);
  writer.Write(int64_t{state.has_spare_normal ? 1 : 0});
}

Rng::State ReadRngState(ByteReader& reader) {
  Rng::State state;
  state.seed = static_cast<uint64_t>(reader.ReadInt());
  for (uint64_t& word : state.words) word = static_cast<uint64_t>(reader.ReadInt());
  state.spare_normal = reader.ReadDouble();
  state.has_spare_normal = reader.ReadInt() != 0;
  return state;
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

LearnOptions Resolved(LearnOptions options, const Checkpoint* checkpoint) {
  if (!options.num_warm_up_episodes) {
    options.num_warm_up_episodes =
        checkpoint != nullptr ? checkpoint->num_warm_up_episodes : NumWarmUpEpisodes(options);
  }
  if (checkpoint != nullptr && checkpoint->stage_episodes.size() == options.stages.size()) {
    for (size_t i = 0; i + 1 < options.stages.size(); ++i) {
      options.stages[i].num_episodes = checkpoint->stage_episodes[i];
    }
  }
  CheckOptions(options);
  return options;
}

class Trainer {
 public:
  Trainer(const LearnOptions& options, Environment& environment, std::string folder,
          const Checkpoint* checkpoint, Team& team)
      : options_(options),
        team_(team),
        environments_({&environment}),
        horizon_(environment.horizon()),
        folder_(std::move(folder)),
        rng_(options.seed),
        agent_(MakeAgent(options, environment.observation_size(), environment.horizon(),
                         rng_.Stream("weights"))),
        replay_memory_(static_cast<size_t>(options.replay_capacity)),
        log_(folder_, FirstLines(checkpoint), team.is_first()) {
    for (int i = 1; i < options_.round; ++i) {
      clones_.push_back(environment.Clone());
      environments_.push_back(clones_.back().get());
    }
    if (checkpoint != nullptr) {
      GoOnFrom(*checkpoint);
    } else {
      SaveCheckpoint();
    }
  }

  LearnResult Run(const std::atomic<bool>* interrupt) {
    Progress progress("learning", options_.num_episodes);
    progress.Advance(num_episodes_done_);
    while (true) {
      if (AnyOf(team_, interrupt != nullptr && interrupt->load())) {
        SaveCheckpoint();
        return Ended(LearnTermination::kInterrupted, "interrupted after episode " +
                                                         std::to_string(num_episodes_done_) +
                                                         "; continue with --resume");
      }
      const bool is_last = num_episodes_done_ == options_.num_episodes;
      const std::optional<std::string> divergence = is_last ? PlayTest() : PlayOn(&progress);
      if (is_last && !divergence) return Finish();
      if (!divergence) continue;
      if (num_rollbacks_ >= options_.max_rollbacks) return Diverged(*divergence);
      RollBack(*divergence);
    }
  }

 private:
  // Checks first: nothing may be written over if the checkpoint is of no use.
  std::string FirstLines(const Checkpoint* checkpoint) {
    if (checkpoint == nullptr) return "";
    if (!agent_->Restore(checkpoint->agent, CheckpointPath(folder_))) {
      FailResume(folder_, "it belongs to another environment (observation size or horizon)",
                 "learn again without --resume");
    }
    return checkpoint->training_jsonl;
  }

  // @pre agent_ was restored from it.
  void GoOnFrom(const Checkpoint& checkpoint) {
    num_episodes_done_ = checkpoint.num_episodes_done;
    // What comes at the end of a stage comes again.
    stage_ = StageOf(options_, std::max(0, num_episodes_done_ - 1));
    num_calibrations_ = checkpoint.num_calibrations;
    best_return_ = checkpoint.best_return;
    best_test_return_ = checkpoint.best_test_return;
    best_test_actions_ = checkpoint.best_test_actions;
    num_rollbacks_ = checkpoint.num_rollbacks;
    agent_->ScaleLearningRate(std::pow(kRollbackFactor, num_rollbacks_));
    for (size_t i = 0; i < environments_.size(); ++i) {
      environments_[i]->CarryOver(checkpoint.carried_over[static_cast<Eigen::Index>(i)]);
    }
    replay_memory_ = checkpoint.replay_memory;
  }

  void SaveCheckpoint() const {
    Checkpoint checkpoint;
    checkpoint.options = CourseOfTraining(options_);
    for (size_t i = 0; i < options_.stages.size(); ++i) {
      checkpoint.stage_episodes.push_back(FirstEpisode(options_, i + 1) -
                                          FirstEpisode(options_, i));
    }
    checkpoint.num_warm_up_episodes = *options_.num_warm_up_episodes;
    checkpoint.num_episodes_done = num_episodes_done_;
    checkpoint.num_calibrations = num_calibrations_;
    checkpoint.best_return = best_return_;
    checkpoint.best_test_return = best_test_return_;
    checkpoint.best_test_actions = best_test_actions_;
    checkpoint.num_rollbacks = num_rollbacks_;
    checkpoint.carried_over.resize(static_cast<Eigen::Index>(environments_.size()));
    for (size_t i = 0; i < environments_.size(); ++i) {
      checkpoint.carried_over[static_cast<Eigen::Index>(i)] = environments_[i]->carried_over();
    }
    checkpoint.agent = agent_->Bytes();
    checkpoint.replay_memory = replay_memory_;
    checkpoint.training_jsonl = log_.lines();
    const std::string bytes = ToBytes(checkpoint);
    ExpectAlike(team_, bytes);
    if (team_.is_first()) WriteFileAtomically(CheckpointPath(folder_), bytes);
  }

  // Back to the last checkpoint, to go on with smaller steps: episodes meet the same rigs and draws
  // as before, and what the networks make of them differs.
  void RollBack(const std::string& divergence) {
    const int episode = num_episodes_done_ + 1;
    const Checkpoint checkpoint = ReadCheckpoint(folder_, team_);
    [[maybe_unused]] const bool fits = agent_->Restore(checkpoint.agent, CheckpointPath(folder_));
    assert(fits);
    GoOnFrom(checkpoint);
    ++num_rollbacks_;
    const double factor = std::pow(kRollbackFactor, num_rollbacks_);
    agent_->ScaleLearningRate(factor);
    log_.Rewind(checkpoint.training_jsonl);
    log_.Append(Value::Object()
                    .Set("episode", num_episodes_done_)
                    .Set("kind", "rollback")
                    .Set("diverged_at_episode", episode)
                    .Set("why", divergence)
                    .Set("learning_rate", factor * options_.networks.learning_rate));
    SaveCheckpoint();
  }

  static std::string Remark(const EpisodeSummary& summary) {
    char text[80];
    std::snprintf(text, sizeof(text), "return %.3g  error %.3g %%", summary.total_reward,
                  100.0 * summary.final_relative_error);
    return text;
  }

  // @param episode  Its number, from 1; that of the training episode before, of a test.
  EpisodeSummary Summarised(const EpisodeRecord& record, int episode,
                            const Environment& environment) const {
    return {static_cast<int64_t>(record.executed.size()), record.total_reward,
            record.final_relative_error,
            ToJsonLine(ToValue(record, episode, options_.stages[stage_].name)),
            environment.carried_over()};
  }

  void Account(const EpisodeSummary& summary) {
    num_calibrations_ += summary.num_executed;
    best_return_ = std::max(best_return_, summary.total_reward);
    log_.Append(summary.line);
  }

  bool IsWarmUp() const { return num_episodes_done_ < *options_.num_warm_up_episodes; }

  // Whether a round ended at a test's turn or just before it. Tests come before the next round, not
  // after the last: so they stand outside the checkpoint between, and a run that ends here and is
  // continued later is the run that never ended.
  bool IsTestDue() const {
    return num_episodes_done_ > *options_.num_warm_up_episodes &&
           num_episodes_done_ % options_.test_every < options_.round;
  }

  // The end of a stage, if it is due; a test, if it is due; the next round. @return A divergence.
  std::optional<std::string> PlayOn(Progress* progress) {
    if (num_episodes_done_ == FirstEpisode(options_, stage_ + 1)) {
      if (auto divergence = PlayTest()) return divergence;
      WriteStagePolicy("policy-" + options_.stages[stage_].name);
      ++stage_;
      replay_memory_ = ReplayMemory(replay_memory_.capacity());
      best_test_actions_.resize(Eigen::NoChange, 0);
    }
    if (IsTestDue()) {
      if (auto divergence = PlayTest()) return divergence;
    }
    const int before = num_episodes_done_;
    if (auto divergence = PlayRound(progress)) return divergence;
    const bool is_checkpoint_due =
        before / options_.checkpoint_every != num_episodes_done_ / options_.checkpoint_every;
    if (is_checkpoint_due || num_episodes_done_ == FirstEpisode(options_, stage_ + 1)) {
      SaveCheckpoint();
    }
    return std::nullopt;
  }

  // One of the episodes that are played side by side.
  struct Seat {
    Rng agent_rng;
    std::unique_ptr<Episode> episode;  // In the process whose turn it is; else null.
  };

  // MapOver, its time taken.
  std::vector<std::string> Divide(size_t n, const std::function<std::string(size_t)>& function) {
    const auto start = std::chrono::steady_clock::now();
    std::vector<std::string> results = MapOver(team_, n, function);
    divided_s_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return results;
  }

  Decision DrawAction(Rng& rng) const {
    Decision decision;
    const double limit = options_.planning.swarm.limit;
    for (double& coefficient : decision.action) coefficient = rng.Uniform(-limit, limit);
    return decision;
  }

  // One step of one episode, in bytes: why it diverged, if it did; else what came of it.
  std::string PlaySeat(int step, bool is_random, Seat& seat,
                       const std::optional<TrainingLoss>& loss) const {
    ByteWriter writer;
    const auto diverged = [&] {
      writer.Write(std::string_view(seat.episode->Record().divergence.value()));
      return writer.bytes();
    };
    if (seat.episode->diverged()) return diverged();
    Decision decision = is_random ? DrawAction(seat.agent_rng)
                                  : agent_->Decide(step, seat.episode->history(),
                                                   Exploration::kTraining, seat.agent_rng);
    decision.loss = loss;
    const std::optional<Transition> transition = seat.episode->Execute(decision);
    if (seat.episode->diverged()) return diverged();
    writer.Write(std::string_view());
    Write(*transition, writer);
    writer.Write(decision.best);
    Write(seat.agent_rng.state(), writer);
    return writer.bytes();
  }

  // One step of all episodes (Algorithm 1, lines 7 to 17). @return A divergence.
  std::optional<std::string> PlayStep(int step, bool is_random, std::deque<Seat>& seats) {
    std::vector<std::optional<TrainingLoss>> losses(seats.size());
    if (!is_random && replay_memory_.size() > 0) {
      for (size_t i = 0; i < seats.size(); ++i) {
        losses[i] = agent_->Train(replay_memory_, seats[i].agent_rng);
      }
    }
    const std::vector<std::string> outcomes = Divide(
        seats.size(), [&](size_t i) { return PlaySeat(step, is_random, seats[i], losses[i]); });
    // What Remember() asks for.
    std::vector<Decision> decisions;
    for (size_t i = 0; i < seats.size(); ++i) {
      ByteReader reader(outcomes[i], "the outcome of a step");
      std::string divergence = reader.ReadText();
      if (!divergence.empty()) return divergence;
      replay_memory_.Add(ReadTransition(reader));
      Decision& decision = decisions.emplace_back();
      decision.action = replay_memory_[replay_memory_.size() - 1].action;
      decision.best = reader.ReadMatrix();
      seats[i].agent_rng.Restore(ReadRngState(reader));
      reader.ExpectEnd();
    }
    if (!is_random) agent_->Remember(step, decisions);
    return std::nullopt;
  }

  // The next random or training episodes (Algorithm 1, lines 3 and 5 to 18). @return A divergence.
  std::optional<std::string> PlayRound(Progress* progress) {
    const bool is_random = IsWarmUp();
    if (num_episodes_done_ == *options_.num_warm_up_episodes) agent_->BeginTraining(replay_memory_);
    const int end =
        is_random ? std::min(*options_.num_warm_up_episodes, FirstEpisode(options_, stage_ + 1))
                  : FirstEpisode(options_, stage_ + 1);
    const auto count = static_cast<size_t>(std::min(options_.round, end - num_episodes_done_));
    std::deque<Seat> seats;
    for (size_t i = 0; i < count; ++i) {
      const uint64_t index = static_cast<uint64_t>(num_episodes_done_) + i;
      Seat& seat = seats.emplace_back(Seat{rng_.Stream("agent", index), nullptr});
      if (!IsMine(team_, i)) continue;
      environments_[i]->SetConditions(options_.stages[stage_].training);
      seat.episode = std::make_unique<Episode>(
          *environments_[i], is_random ? EpisodeKind::kRandom : EpisodeKind::kTraining,
          rng_.Stream("episode", index));
    }
    for (int step = 0; step < horizon_; ++step) {
      if (auto divergence = PlayStep(step, is_random, seats)) return divergence;
    }
    const std::vector<std::string> summaries = MapOver(team_, count, [&](size_t i) {
      return ToBytes(Summarised(seats[i].episode->Record(),
                                num_episodes_done_ + static_cast<int>(i) + 1, *environments_[i]));
    });
    for (size_t i = 0; i < count; ++i) {
      const EpisodeSummary summary = SummaryFromBytes(summaries[i]);
      ++num_episodes_done_;
      Account(summary);
      if (!IsMine(team_, i)) environments_[i]->CarryOver(summary.carried_over);
      progress->Advance(1, Remark(summary));
    }
    return std::nullopt;
  }

  // The rig and the noise of every test are the same, so that tests compare with each other. Every
  // process plays it: there is but one, and the others would wait.
  // @return A divergence.
  std::optional<std::string> PlayTest() {
    Rng agent_rng = rng_.Stream("test agent", static_cast<uint64_t>(num_episodes_done_));
    Environment& environment = *environments_.front();
    environment.SetConditions(options_.stages[stage_].test);
    Episode episode(environment, EpisodeKind::kTest, rng_.Stream("test"));
    for (int step = 0; step < horizon_ && !episode.diverged(); ++step) {
      Decision decision = agent_->Decide(step, episode.history(), Exploration::kTesting, agent_rng);
      (void)episode.Execute(decision);
      if (options_.mistakes.contains(Mistake::kTestsRemembered)) {
        agent_->Remember(step, {std::move(decision)});
      }
    }
    const EpisodeRecord record = episode.Record();
    if (record.divergence) return record.divergence;
    Account(Summarised(record, num_episodes_done_, environment));
    KeepIfBest(record);
    return std::nullopt;
  }

  void KeepIfBest(const EpisodeRecord& test) {
    const bool is_first = best_test_actions_.cols() == 0;
    const bool is_best = is_first || test.total_reward > best_test_return_ ||
                         options_.mistakes.contains(Mistake::kLastTest);
    if (test.executed.empty() || !is_best) return;
    best_test_return_ = test.total_reward;
    best_test_actions_.resize(LoopCoefficients::RowsAtCompileTime,
                              static_cast<Eigen::Index>(test.executed.size()));
    for (size_t t = 0; t < test.executed.size(); ++t) {
      best_test_actions_.col(static_cast<Eigen::Index>(t)) = test.executed[t];
    }
  }

  // Its motion is what the agent chose in a test, as in the paper; of all tests of the stage, which
  // meet the same rig and noise, the one with the highest return. The last is not the best: the
  // swarm finds what the model overrates. Nothing where the carrier refused every action of every
  // test.
  void WriteStagePolicy(const std::string& name) const {
    if (best_test_actions_.cols() == 0 || !team_.is_first()) return;
    Policy policy;
    policy.task = options_.task;
    policy.preset = options_.preset;
    policy.stage = options_.stages[stage_].name;
    policy.mistakes = NamesOf(options_.mistakes);
    policy.seed = options_.seed;
    policy.num_episodes = num_episodes_done_;
    policy.horizon = horizon_;
    policy.observation_size = environments_.front()->observation_size();
    policy.networks = options_.networks;
    policy.planning = options_.planning;
    if (auto model = agent_->model()) {
      policy.model = std::move(model->networks);
      policy.particle_memory = std::move(model->particle_memory);
    } else {
      policy.agent = agent_->Bytes();
    }
    policy.motion = BestTestMotion();
    WritePolicy(policy, folder_ + "/" + name);
  }

  LearnResult Ended(LearnTermination termination, std::string text) const {
    LearnResult result;
    result.task = options_.task;
    result.preset = options_.preset;
    result.num_episodes = num_episodes_done_;
    result.num_calibrations = num_calibrations_;
    result.num_rollbacks = num_rollbacks_;
    result.best_return = best_return_;
    result.divided_s = divided_s_;
    result.termination = termination;
    result.termination_text = std::move(text);
    return result;
  }

  LearnResult Diverged(const std::string& what) const {
    const std::string tried =
        num_rollbacks_ == 0
            ? ""
            : ", and again after each of " + std::to_string(num_rollbacks_) +
                  " returns to the last checkpoint, the learning rate being halved each time";
    return Ended(LearnTermination::kDiverged,
                 "training diverged at episode " + std::to_string(num_episodes_done_ + 1) + ", " +
                     what + tried +
                     ": the networks can't be used; try another seed or a smaller learning "
                     "rate");
  }

  LearnResult Finish() const {
    if (best_test_actions_.cols() == 0) {
      return Ended(LearnTermination::kNothingExecuted,
                   "the carrier refused every action of every test: nothing was learned; try "
                   "more episodes");
    }
    WriteStagePolicy("policy");
    LearnResult result =
        Ended(LearnTermination::kDone, "done: " + std::to_string(num_episodes_done_) + " episodes");
    result.motion = BestTestMotion();
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
                            .Set("method", options_.stages[stage_].name)
                            .Set("planner", options_.planning.planner)
                            .Set("task", TaskName(options_.task))
                            .Set("preset", options_.preset)
                            .Set("seed", std::to_string(options_.seed))
                            .Set("episodes", num_episodes_done_);
    return motion;
  }

  static constexpr double kRollbackFactor = 0.5;

  const LearnOptions options_;
  Team& team_;
  std::vector<Environment*> environments_;  // As many as a round has episodes.
  std::vector<std::unique_ptr<Environment>> clones_;
  const int horizon_;
  const std::string folder_;
  const Rng rng_;
  std::unique_ptr<Agent> agent_;
  ReplayMemory replay_memory_;
  TrainingLog log_;
  size_t stage_ = 0;
  int num_episodes_done_ = 0;
  int64_t num_calibrations_ = 0;
  int num_rollbacks_ = 0;
  double divided_s_ = 0.0;
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
                  const std::atomic<bool>* interrupt, Team* team) {
  Alone alone;
  Team& those = team != nullptr ? *team : alone;
  CheckOptions(Resolved(options, nullptr));
  std::optional<Checkpoint> checkpoint;
  if (options.resume) checkpoint = ReadCheckpoint(folder, those);
  const Checkpoint* const start = checkpoint ? &*checkpoint : nullptr;
  const LearnOptions resolved = Resolved(options, start);
  if (start != nullptr) CheckSameCourse(*start, resolved, folder);
  const bool is_new = those.is_first() && MakeFolder(folder);
  std::optional<Trainer> trainer;
  try {
    trainer.emplace(resolved, environment, folder, start, those);
  } catch (const InputError&) {
    // The disk was full before anything was learned: leave nothing behind.
    std::error_code ignored;
    if (is_new) std::filesystem::remove_all(folder, ignored);
    throw;
  }
  return trainer->Run(interrupt);
}

}  // namespace calibrato
