#include "calibrato/learning/trainer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <sstream>

#include "calibrato/base/files.h"
#include "calibrato/base/input_error.h"
#include "calibrato/base/parallel.h"
#include "calibrato/base/value.h"
#include "calibrato/learning/agent.h"
#include "calibrato/learning/checkpoint.h"
#include "calibrato/learning/known_environment.h"
#include "calibrato/learning/policy.h"
#include "calibrato/learning/team_of_threads.h"

namespace calibrato {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

std::string FreshFolder(const std::string& name) {
  const std::string folder = testing::TempDir() + "calibrato_trainer_" + name;
  std::filesystem::remove_all(folder);
  return folder;
}

// Small and quick: what is tested is the course of training, not how far it gets.
LearnOptions ShortRun() {
  LearnOptions options;
  options.num_episodes = 14;
  options.num_warm_up_episodes = 3;
  options.test_every = 4;
  options.checkpoint_every = 5;
  options.replay_capacity = 20;
  options.networks.hidden_size = 16;
  options.networks.minibatches_per_call = 2;
  return options;
}

std::map<std::string, std::string> FilesOf(const std::string& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    files[std::filesystem::relative(entry.path(), folder).string()] =
        ReadFile(entry.path().string());
  }
  return files;
}

void ExpectSameFiles(const std::string& a, const std::string& b) {
  const auto files_a = FilesOf(a);
  const auto files_b = FilesOf(b);
  EXPECT_EQ(files_a.size(), 5U);
  ASSERT_EQ(files_a.size(), files_b.size());
  for (const auto& [name, content] : files_a) {
    EXPECT_TRUE(files_b.count(name) > 0 && content == files_b.at(name)) << name << " differs";
  }
}

std::vector<Value> LinesOf(const std::string& folder) {
  std::istringstream text(ReadFile(folder + "/training.jsonl"));
  std::vector<Value> lines;
  for (std::string line; std::getline(text, line);) lines.push_back(ParseJson(line, "line"));
  return lines;
}

// Calls back before every reset, which is once an episode.
class WatchedEnvironment : public KnownEnvironment {
 public:
  explicit WatchedEnvironment(std::function<void(int)> on_reset) : on_reset_(std::move(on_reset)) {}
  Eigen::VectorXd Reset(const Rng& rng) override {
    on_reset_(++num_resets_);
    return KnownEnvironment::Reset(rng);
  }

 private:
  std::function<void(int)> on_reset_;
  int num_resets_ = 0;
};

TEST(Learn, FindsActionsMuchBetterThanRandomOnes) {
  LearnOptions options;
  options.num_episodes = 60;
  options.networks.hidden_size = 32;
  options.networks.learning_rate = 3e-3;
  options.networks.action_jitter = 0.0;  // The reward is smooth and free of noise.
  KnownEnvironment environment;
  const std::string folder = FreshFolder("better");
  const LearnResult result = Learn(options, environment, folder);
  EXPECT_EQ(result.termination, LearnTermination::kDone);
  EXPECT_EQ(result.num_episodes, 60);

  double random_return = 0.0;
  for (const Value& line : LinesOf(folder)) {
    if (line.At("kind").AsString() == "random") {
      random_return += line.At("return").AsDouble() / 10.0;
    }
  }
  // Two steps: 1.8 for random actions, at most 8.
  EXPECT_NEAR(random_return, 1.8, 0.8);
  const Value test = LinesOf(folder).back();
  EXPECT_EQ(test.At("kind").AsString(), "test");
  EXPECT_GT(test.At("return").AsDouble(), 5.0);
  EXPECT_NEAR(test.At("predicted_return").AsDouble(), test.At("return").AsDouble(), 2.0);
  EXPECT_GE(result.best_return, test.At("return").AsDouble());
}

TEST(Learn, WritesTheSameBytesForAnyNumberOfProcesses) {
  LearnOptions options = ShortRun();
  options.round = 3;
  KnownEnvironment environment;
  const std::string alone = FreshFolder("alone");
  (void)Learn(options, environment, alone);
  for (const int size : {2, 5}) {
    const std::string together = FreshFolder("together");
    const auto texts = RunAsTeam(size, [&](Team& team) {
      KnownEnvironment own;
      return Learn(options, own, together, nullptr, &team).termination_text;
    });
    for (const std::string& text : texts) EXPECT_EQ(text, "done: 14 episodes");
    ExpectSameFiles(alone, together);
  }
}

// What one process sees ends all of them after the same round, and any number of others goes on.
TEST(Learn, InterruptedInOneOfManyProcessesGoesOnInOne) {
  LearnOptions options = ShortRun();
  options.round = 2;
  KnownEnvironment environment;
  const std::string whole = FreshFolder("whole_team");
  (void)Learn(options, environment, whole);
  const std::string parts = FreshFolder("parts_team");
  const auto ended = RunAsTeam(3, [&](Team& team) {
    std::atomic<bool> interrupt = false;
    WatchedEnvironment own([&](int num_resets) {
      if (team.rank() == 1 && num_resets == 2) interrupt = true;
    });
    const LearnResult result = Learn(options, own, parts, &interrupt, &team);
    return LearnTerminationName(result.termination) + std::to_string(result.num_episodes);
  });
  for (const std::string& text : ended) {
    EXPECT_EQ(text, ended.front());
    EXPECT_THAT(text, HasSubstr("interrupted"));
  }
  options.resume = true;
  (void)Learn(options, environment, parts);
  ExpectSameFiles(whole, parts);
}

TEST(Learn, LogsEveryEpisodeAndTest) {
  KnownEnvironment environment;
  const std::string folder = FreshFolder("log");
  const LearnResult result = Learn(ShortRun(), environment, folder);
  std::string kinds;
  for (const Value& line : LinesOf(folder)) {
    kinds += line.At("kind").AsString()[1];  // r[a]ndom, t[r]aining, t[e]st
    double sum = 0.0;
    for (const auto& [name, value] : line.At("terms").members()) sum += value.AsDouble();
    EXPECT_NEAR(line.At("return").AsDouble(), sum, 1e-12);
    EXPECT_EQ(line.Find("dynamics_loss") != nullptr, kinds.back() == 'r');
    EXPECT_EQ(line.Find("predicted_return") != nullptr, kinds.back() != 'a');
    EXPECT_GT(line.At("path_length_m").AsDouble(), 0.0);
  }
  // Tests after episodes 4, 8, 12 and at the end.
  EXPECT_EQ(kinds, "aaarerrrrerrrrerre");
  EXPECT_EQ(result.num_calibrations, 2 * (14 + 4));
}

TEST(Learn, GivesThePolicyTheMotionOfItsBestTest) {
  KnownEnvironment environment;
  const std::string folder = FreshFolder("best_test");
  LearnOptions options = ShortRun();
  options.test_every = 1;
  (void)Learn(options, environment, folder);
  double best_return = -1e9;
  double path_length = 0.0;
  double last_return = 0.0;
  for (const Value& line : LinesOf(folder)) {
    if (line.At("kind").AsString() != "test") continue;
    last_return = line.At("return").AsDouble();
    if (!(last_return > best_return)) continue;
    best_return = last_return;
    path_length = line.At("path_length_m").AsDouble();
  }
  EXPECT_GT(best_return, last_return);  // Else this test would show nothing.
  EXPECT_NEAR(PathLength(ReadPolicy(folder + "/policy").motion), path_length, 1e-9);
}

TEST(Learn, CanReplanTheMotionOfItsFinalTest) {
  KnownEnvironment environment;
  const std::string folder = FreshFolder("motion");
  LearnOptions options = ShortRun();
  options.test_every = 100;  // The final test is the only one.
  options.carrier = Carrier::kArm;
  options.loop_duration_s = 6.0;
  const LearnResult result = Learn(options, environment, folder);
  const Policy policy = ReadPolicy(folder + "/policy");
  ASSERT_EQ(policy.motion.loops.size(), 2U);
  EXPECT_EQ(policy.motion.carrier, Carrier::kArm);
  EXPECT_EQ(policy.motion.loops[0].duration_s, 6.0);
  EXPECT_EQ(result.motion.loops[1].coefficients, policy.motion.loops[1].coefficients);
  EXPECT_NEAR(PathLength(policy.motion), LinesOf(folder).back().At("path_length_m").AsDouble(),
              1e-9);
  // Replanned with what was loaded: the same first loop.
  Rng agent = Rng(options.seed).Stream("test agent", 14);
  const History start{{environment.Reset(Rng(options.seed).Stream("test"))}, {}};
  const Plan plan = PlanAction(ModelOf(policy), start, 2, policy.particle_memory[0],
                               policy.planning, Exploration::kTesting, agent);
  EXPECT_EQ(ScaledAction(plan.action), policy.motion.loops[0].coefficients);
}

TEST(Learn, GivesTheSameBytesForTheSameSeedOnly) {
  KnownEnvironment environment;
  const std::string a = FreshFolder("seed_a");
  const std::string b = FreshFolder("seed_b");
  const std::string c = FreshFolder("seed_c");
  (void)Learn(ShortRun(), environment, a);
  (void)Learn(ShortRun(), environment, b);
  ExpectSameFiles(a, b);
  LearnOptions other = ShortRun();
  other.seed = 2;
  (void)Learn(other, environment, c);
  EXPECT_NE(ReadFile(a + "/training.jsonl"), ReadFile(c + "/training.jsonl"));
}

TEST(Learn, EndsTheSameWhenInterruptedAndResumed) {
  KnownEnvironment environment;
  const std::string whole = FreshFolder("whole");
  (void)Learn(ShortRun(), environment, whole);
  for (const int episode : {1, 4, 9}) {
    std::atomic<bool> interrupt = false;
    WatchedEnvironment watched([&](int reset) { interrupt = reset == episode; });
    const std::string folder = FreshFolder("interrupted");
    const LearnResult first = Learn(ShortRun(), watched, folder, &interrupt);
    EXPECT_EQ(first.termination, LearnTermination::kInterrupted);
    EXPECT_FALSE(std::filesystem::exists(folder + "/policy"));
    LearnOptions resumed = ShortRun();
    resumed.resume = true;
    const LearnResult second = Learn(resumed, environment, folder);
    EXPECT_EQ(second.termination, LearnTermination::kDone);
    EXPECT_EQ(second.num_calibrations, 2 * (14 + 4));
    ExpectSameFiles(whole, folder);
  }
}

TEST(Learn, EndsTheSameWhenKilledInAnyEpisodeAndResumed) {
  KnownEnvironment environment;
  const std::string whole = FreshFolder("unkilled");
  (void)Learn(ShortRun(), environment, whole);
  for (const int episode : {1, 3, 8, 18}) {
    // What the disk holds in the middle of an episode is what a kill leaves, with half a line.
    const std::string running = FreshFolder("running");
    const std::string killed = FreshFolder("killed");
    WatchedEnvironment watched([&](int reset) {
      if (reset != episode) return;
      std::filesystem::copy(running, killed, std::filesystem::copy_options::recursive);
    });
    (void)Learn(ShortRun(), watched, running);
    WriteFileAtomically(killed + "/training.jsonl",
                        ReadFile(killed + "/training.jsonl") + "{\"episode\":");
    LearnOptions resumed = ShortRun();
    resumed.resume = true;
    (void)Learn(resumed, environment, killed);
    ExpectSameFiles(whole, killed);
  }
}

TEST(Learn, ContinuesAFinishedRunAsIfItHadBeenLonger) {
  KnownEnvironment environment;
  const std::string at_once = FreshFolder("at_once");
  (void)Learn(ShortRun(), environment, at_once);
  const std::string folder = FreshFolder("continued");
  LearnOptions options = ShortRun();
  options.num_episodes = 8;
  (void)Learn(options, environment, folder);
  options.num_episodes = 14;
  options.num_warm_up_episodes.reset();
  options.resume = true;
  (void)Learn(options, environment, folder);
  ExpectSameFiles(at_once, folder);
}

TEST(Learn, TrainsTheSameHoweverOftenItTests) {
  KnownEnvironment environment;
  const std::string often = FreshFolder("often");
  const std::string seldom = FreshFolder("seldom");
  LearnOptions options = ShortRun();
  options.test_every = 1;
  (void)Learn(options, environment, often);
  options.test_every = 100;
  (void)Learn(options, environment, seldom);
  EXPECT_EQ(ReadFile(often + "/policy/policy.bin"), ReadFile(seldom + "/policy/policy.bin"));
}

TEST(Learn, RefusesToResumeWhatItCannot) {
  KnownEnvironment environment;
  const std::string folder = FreshFolder("refused");
  LearnOptions options = ShortRun();
  options.resume = true;
  EXPECT_THAT([&] { (void)Learn(options, environment, folder); },
              ThrowsMessage<InputError>(HasSubstr("nothing to resume")));
  EXPECT_FALSE(std::filesystem::exists(folder));

  options.resume = false;
  (void)Learn(options, environment, folder);
  const auto before = FilesOf(folder);
  options.resume = true;
  LearnOptions other = options;
  other.seed = 2;
  EXPECT_THAT([&] { (void)Learn(other, environment, folder); },
              ThrowsMessage<InputError>(HasSubstr("its seed is 1, 2 was asked for")));
  other = options;
  other.networks.hidden_size = 32;
  EXPECT_THAT([&] { (void)Learn(other, environment, folder); },
              ThrowsMessage<InputError>(HasSubstr("its hidden size is 16")));
  other = options;
  other.num_episodes = 9;
  EXPECT_THAT([&] { (void)Learn(other, environment, folder); },
              ThrowsMessage<InputError>(HasSubstr("ask for at least 14")));
  KnownEnvironment longer(3);
  EXPECT_THAT([&] { (void)Learn(options, longer, folder); },
              ThrowsMessage<InputError>(HasSubstr("another environment")));
  EXPECT_EQ(FilesOf(folder), before);

  const std::string bytes = before.at("checkpoint.bin");
  for (const std::string& broken : {bytes.substr(0, bytes.size() - 1), bytes + "x",
                                    std::string("no checkpoint"), std::string()}) {
    WriteFileAtomically(folder + "/checkpoint.bin", broken);
    EXPECT_THAT(
        [&] { (void)Learn(options, environment, folder); },
        ThrowsMessage<InputError>(AllOf(HasSubstr("checkpoint.bin"), Not(HasSubstr("\n")))));
  }
}

TEST(Learn, CountsRefusedActionsAndLearnsFromThem) {
  KnownEnvironment environment(/*horizon=*/2, /*refuse_above=*/0.0);
  const std::string folder = FreshFolder("refusing");
  const LearnResult result = Learn(ShortRun(), environment, folder);
  int64_t num_refused = 0;
  for (const Value& line : LinesOf(folder)) {
    num_refused += line.At("refused").AsInt();
    const Value* penalty = line.At("terms").Find("refusal");
    EXPECT_EQ(penalty != nullptr ? penalty->AsDouble() : 0.0,
              -2.0 * static_cast<double>(line.At("refused").AsInt()));
  }
  EXPECT_GT(num_refused, 0);
  EXPECT_EQ(result.num_calibrations, 2 * (14 + 4) - num_refused);
}

TEST(Learn, SaysSoWhenNothingCouldBeExecuted) {
  KnownEnvironment environment(/*horizon=*/2, /*refuse_above=*/-1.0);
  const std::string folder = FreshFolder("nothing");
  const LearnResult result = Learn(ShortRun(), environment, folder);
  EXPECT_EQ(result.termination, LearnTermination::kNothingExecuted);
  EXPECT_FALSE(std::filesystem::exists(folder + "/policy"));
}

// After some steps every reward is infinite.
class BreakingEnvironment : public KnownEnvironment {
 public:
  StepResult Step(const LoopCoefficients& action) override {
    StepResult result = KnownEnvironment::Step(action);
    if (++num_steps_ > 12) result.reward = std::numeric_limits<double>::infinity();
    return result;
  }

 private:
  int num_steps_ = 0;
};

TEST(Learn, StopsWhereANumberIsNotFiniteAndKeepsTheCheckpointBefore) {
  BreakingEnvironment environment;
  const std::string folder = FreshFolder("diverged");
  const LearnResult result = Learn(ShortRun(), environment, folder);
  EXPECT_EQ(result.termination, LearnTermination::kDiverged);
  // Twelve steps are episodes 1 to 4, the test after them and episode 5.
  EXPECT_THAT(result.termination_text, HasSubstr("diverged at episode 6, reward not finite"));
  LearnOptions resumed = ShortRun();
  resumed.resume = true;
  KnownEnvironment sound;
  EXPECT_EQ(Learn(resumed, sound, folder).termination, LearnTermination::kDone);
}

TEST(Learn, StopsWhenTheNetworksDiverge) {
  KnownEnvironment environment;
  LearnOptions options = ShortRun();
  options.networks.learning_rate = 1e30;
  const LearnResult result = Learn(options, environment, FreshFolder("exploded"));
  EXPECT_EQ(result.termination, LearnTermination::kDiverged);
  EXPECT_THAT(result.termination_text, HasSubstr("diverged at episode 4, "));
  EXPECT_THAT(result.termination_text, HasSubstr("not finite"));
}

LearnOptions RoundsOfThree() {
  LearnOptions options = ShortRun();
  options.round = 3;
  options.num_episodes = 15;
  return options;
}

TEST(Rounds, GiveTheSameBytesForAnyNumberOfThreads) {
  KnownEnvironment environment;
  const std::string one = FreshFolder("one_thread");
  const std::string two = FreshFolder("two_threads");
  SetNumThreads(1);
  (void)Learn(RoundsOfThree(), environment, one);
  SetNumThreads(2);
  (void)Learn(RoundsOfThree(), environment, two);
  SetNumThreads(0);
  ExpectSameFiles(one, two);
}

TEST(Rounds, EndTheSameWhenKilledOrInterruptedAndResumed) {
  KnownEnvironment environment;
  const std::string whole = FreshFolder("round_whole");
  const LearnOptions options = RoundsOfThree();
  (void)Learn(options, environment, whole);
  // The watched environment is the first of each round.
  for (const int reset : {2, 3, 5}) {
    const std::string running = FreshFolder("round_running");
    const std::string killed = FreshFolder("round_killed");
    std::atomic<bool> interrupt = false;
    WatchedEnvironment watched([&](int count) {
      if (count != reset) return;
      std::filesystem::copy(running, killed, std::filesystem::copy_options::recursive);
      interrupt = true;
    });
    (void)Learn(options, watched, running, &interrupt);
    for (const std::string& folder : {running, killed}) {
      LearnOptions resumed = options;
      resumed.resume = true;
      EXPECT_EQ(Learn(resumed, environment, folder).termination, LearnTermination::kDone);
      ExpectSameFiles(whole, folder);
    }
  }
}

TEST(Rounds, KillsLoseNoMoreThanTheRunningRound) {
  const std::string folder = FreshFolder("round_lost");
  LearnOptions options = RoundsOfThree();
  options.checkpoint_every = 1;
  int reset = 0;
  WatchedEnvironment watched([&](int) {
    // Episodes 0-2 at random, then rounds from 3, 6, 9, 12; tests in between and before the end.
    if (++reset == 1) return;
    const Checkpoint checkpoint =
        CheckpointFromBytes(ReadFile(folder + "/checkpoint.bin"), "checkpoint.bin");
    EXPECT_GE(checkpoint.num_episodes_done, 3 * ((reset - 1) / 2));
  });
  (void)Learn(options, watched, folder);
  EXPECT_GT(reset, 5);
}

TEST(Rounds, FindGoodActionsToo) {
  LearnOptions options;
  options.num_episodes = 64;
  options.round = 4;
  options.networks.hidden_size = 32;
  options.networks.learning_rate = 3e-3;
  options.networks.action_jitter = 0.0;
  KnownEnvironment environment;
  const std::string folder = FreshFolder("round_better");
  (void)Learn(options, environment, folder);
  EXPECT_GT(LinesOf(folder).back().At("return").AsDouble(), 5.0);
}

// Rewards ten times as much once calibrations are on; keeps what it was told.
class StagedEnvironment : public KnownEnvironment {
 public:
  void SetConditions(const EpisodeConditions& conditions) override { conditions_ = conditions; }
  StepResult Step(const LoopCoefficients& action) override {
    StepResult result = KnownEnvironment::Step(action);
    const double iterations = conditions_.max_iterations.value_or(0);
    result.terms.push_back({"iterations", "iterations", iterations, 1.0});
    result.reward += iterations;
    return result;
  }

 private:
  EpisodeConditions conditions_;
};

LearnOptions TwoStages() {
  LearnOptions options = ShortRun();
  options.task = Task::kExtrinsic;
  options.stages = PaperStages(Task::kExtrinsic, 13);
  options.num_episodes = 13;
  return options;
}

TEST(Stages, FollowEachOtherUnderTheirOwnConditions) {
  StagedEnvironment environment;
  const std::string folder = FreshFolder("stages");
  (void)Learn(TwoStages(), environment, folder);
  int num_learned = 0;
  int num_fine_tuned = 0;
  for (const Value& line : LinesOf(folder)) {
    const bool is_first = line.At("stage").AsString() == "learned";
    const bool is_test = line.At("kind").AsString() == "test";
    const double iterations = is_first ? 0.0 : is_test ? 20.0 : 2.0;  // Two steps.
    EXPECT_EQ(line.At("increments").At("iterations").AsDouble(), iterations);
    if (is_test) continue;
    ++(is_first ? num_learned : num_fine_tuned);
  }
  // 13 * 1000 / 1650 = 7.9
  EXPECT_EQ(num_learned, 8);
  EXPECT_EQ(num_fine_tuned, 5);
  const Policy learned = ReadPolicy(folder + "/policy-learned");
  const Policy fine_tuned = ReadPolicy(folder + "/policy");
  EXPECT_EQ(learned.stage, "learned");
  EXPECT_EQ(learned.num_episodes, 8);
  EXPECT_EQ(learned.motion.provenance.At("method").AsString(), "learned");
  EXPECT_EQ(fine_tuned.stage, "fine-tuned");
  EXPECT_EQ(fine_tuned.num_episodes, 13);
  EXPECT_EQ(fine_tuned.motion.provenance.At("method").AsString(), "fine-tuned");
  // What is remembered is of the second stage alone: 5 episodes of two steps.
  const Checkpoint checkpoint =
      CheckpointFromBytes(ReadFile(folder + "/checkpoint.bin"), "checkpoint.bin");
  EXPECT_EQ(checkpoint.replay_memory.size(), 10U);
}

TEST(Stages, EndTheSameWhenKilledAnywhereAndWhenContinued) {
  StagedEnvironment environment;
  const std::string whole = FreshFolder("stages_whole");
  LearnOptions options = TwoStages();
  options.checkpoint_every = 1;
  (void)Learn(options, environment, whole);
  const auto files = FilesOf(whole);
  EXPECT_EQ(files.size(), 8U);
  // A kill at the boundary, and in the first episode after it.
  for (int done = 7; done <= 9; ++done) {
    const std::string folder = FreshFolder("stages_killed");
    const std::string killed = FreshFolder("stages_copy");
    bool is_copied = false;
    class Watched : public StagedEnvironment {
     public:
      explicit Watched(std::function<void()> on_reset) : on_reset_(std::move(on_reset)) {}
      Eigen::VectorXd Reset(const Rng& rng) override {
        on_reset_();
        return StagedEnvironment::Reset(rng);
      }

     private:
      std::function<void()> on_reset_;
    };
    Watched watched([&] {
      const Checkpoint checkpoint =
          CheckpointFromBytes(ReadFile(folder + "/checkpoint.bin"), "checkpoint.bin");
      if (is_copied || checkpoint.num_episodes_done != done) return;
      is_copied = true;
      std::filesystem::copy(folder, killed, std::filesystem::copy_options::recursive);
    });
    (void)Learn(options, watched, folder);
    LearnOptions resumed = options;
    resumed.resume = true;
    (void)Learn(resumed, environment, killed);
    EXPECT_EQ(FilesOf(killed), files) << done;
  }
  // Continued, the first stage stays as long as it was.
  LearnOptions longer = options;
  longer.num_episodes = 20;
  longer.stages = PaperStages(Task::kExtrinsic, 20);
  longer.resume = true;
  (void)Learn(longer, environment, whole);
  EXPECT_EQ(ReadPolicy(whole + "/policy-learned").num_episodes, 8);
  EXPECT_EQ(ReadPolicy(whole + "/policy").num_episodes, 20);
  const std::string at_once = FreshFolder("stages_at_once");
  longer.stages.front().num_episodes = 8;
  longer.resume = false;
  (void)Learn(longer, environment, at_once);
  EXPECT_EQ(FilesOf(at_once), FilesOf(whole));
}

// One reward, the thirteenth, is infinite; never again.
class StumblingEnvironment : public KnownEnvironment {
 public:
  StepResult Step(const LoopCoefficients& action) override {
    StepResult result = KnownEnvironment::Step(action);
    if (++num_steps_ == 13) result.reward = std::numeric_limits<double>::infinity();
    return result;
  }

 private:
  int num_steps_ = 0;
};

TEST(Learn, GoesBackToItsCheckpointAndOnWithSmallerStepsWhereItDiverged) {
  StumblingEnvironment environment;
  const std::string folder = FreshFolder("rolled_back");
  const LearnResult result = Learn(ShortRun(), environment, folder);
  EXPECT_EQ(result.termination, LearnTermination::kDone);
  EXPECT_EQ(result.num_episodes, 14);
  EXPECT_EQ(result.num_rollbacks, 1);
  int num_rollbacks = 0;
  int last_episode = 0;
  for (const Value& line : LinesOf(folder)) {
    const auto episode = static_cast<int>(line.At("episode").AsInt());
    if (line.At("kind").AsString() == "rollback") {
      ++num_rollbacks;
      // The checkpoint of episode 5; twelve steps are episodes 1 to 4, the test and episode 5.
      EXPECT_EQ(episode, 5);
      EXPECT_EQ(line.At("diverged_at_episode").AsInt(), 6);
      EXPECT_EQ(line.At("why").AsString(), "reward not finite");
      EXPECT_EQ(line.At("learning_rate").AsDouble(), 0.5e-4);
    }
    EXPECT_GE(episode, last_episode);
    last_episode = episode;
  }
  EXPECT_EQ(num_rollbacks, 1);
  // A resumed run keeps the smaller steps: its continuation is that of the run that went on.
  LearnOptions longer = ShortRun();
  longer.num_episodes = 18;
  longer.resume = true;
  KnownEnvironment sound;
  (void)Learn(longer, sound, folder);
  StumblingEnvironment again;
  const std::string at_once = FreshFolder("rolled_back_at_once");
  longer.resume = false;
  (void)Learn(longer, again, at_once);
  ExpectSameFiles(folder, at_once);
}

TEST(Learn, FindsGoodActionsWithEveryPlannerThatHasAModelOrALibrary) {
  for (const std::string& planner : AgentNames()) {
    SCOPED_TRACE(planner);
    LearnOptions options;
    options.num_episodes = 36;
    options.networks.hidden_size = 16;
    options.networks.learning_rate = 5e-3;
    options.networks.action_jitter = 0.0;
    options.planning.planner = planner;
    options.test_every = 40;
    KnownEnvironment environment;
    const std::string folder = FreshFolder("planner_" + planner);
    const LearnResult result = Learn(options, environment, folder);
    ASSERT_EQ(result.termination, LearnTermination::kDone);
    EXPECT_EQ(ReadPolicy(folder + "/policy").planning.planner, planner);
    // Without a model or a library 36 episodes are too few: the next test has more.
    if (planner == "sac") continue;
    // 1.8 for random actions, with a standard deviation of about 0.3.
    EXPECT_GT(LinesOf(folder).back().At("return").AsDouble(), 2.8);
  }
}

// The best return is 8, random actions have 1.8 with a standard deviation of about 0.3.
TEST(Learn, FindsGoodActionsWithoutAModelInMoreEpisodes) {
  LearnOptions options;
  options.num_episodes = 120;
  options.num_warm_up_episodes = 30;
  options.networks.hidden_size = 128;
  options.planning.planner = "sac";
  options.test_every = 200;
  options.checkpoint_every = 60;
  KnownEnvironment environment;
  const std::string folder = FreshFolder("sac");
  ASSERT_EQ(Learn(options, environment, folder).termination, LearnTermination::kDone);
  const Value test = LinesOf(folder).back();
  EXPECT_GT(test.At("return").AsDouble(), 4.0);
  // Critics that believed every slope would promise far more than there is.
  EXPECT_LT(test.At("predicted_return").AsDouble(), test.At("return").AsDouble() + 1.0);
}

// A search on the networks, and the two agents that have none.
TEST(Learn, GoesOnAsIfItHadNeverStoppedWithEveryAgent) {
  for (const std::string planner : {"icem", "q-library", "sac"}) {
    SCOPED_TRACE(planner);
    LearnOptions options = ShortRun();
    options.planning.planner = planner;
    KnownEnvironment environment;
    const std::string at_once = FreshFolder("agent_at_once");
    (void)Learn(options, environment, at_once);
    const std::string folder = FreshFolder("agent_continued");
    options.num_episodes = 9;
    (void)Learn(options, environment, folder);
    options.num_episodes = 14;
    options.resume = true;
    (void)Learn(options, environment, folder);
    ExpectSameFiles(at_once, folder);
  }
}

TEST(Learn, LogsWhatTheNetworksExpectedAndHowTheSearchConverged) {
  KnownEnvironment environment;
  const std::string folder = FreshFolder("expected");
  (void)Learn(ShortRun(), environment, folder);
  for (const Value& line : LinesOf(folder)) {
    const bool is_random = line.At("kind").AsString() == "random";
    EXPECT_EQ(line.Find("reward_prediction_error") == nullptr, is_random);
    EXPECT_EQ(line.Find("observation_prediction_error") == nullptr, is_random);
    EXPECT_EQ(line.Find("best_so_far") == nullptr, is_random);
    if (is_random) continue;
    EXPECT_GT(line.At("reward_prediction_error").AsDouble(), 0.0);
    EXPECT_GT(line.At("observation_prediction_error").AsDouble(), 0.0);
    EXPECT_EQ(line.At("best_so_far").size(), 6U);  // Before five iterations, and after.
    EXPECT_GE(line.At("best_so_far").AsDoubles(6).back(),
              line.At("best_so_far").AsDoubles(6).front());
  }
}

TEST(Mistakes, TestsRememberedChangeWhatIsTrained) {
  KnownEnvironment environment;
  const std::string right = FreshFolder("tests_right");
  const std::string wrong = FreshFolder("tests_wrong");
  LearnOptions options = ShortRun();
  (void)Learn(options, environment, right);
  options.mistakes = {Mistake::kTestsRemembered};
  (void)Learn(options, environment, wrong);
  EXPECT_NE(ReadFile(right + "/policy/policy.bin"), ReadFile(wrong + "/policy/policy.bin"));
  EXPECT_EQ(ReadPolicy(wrong + "/policy").mistakes, "tests-remembered");
}

TEST(Mistakes, LastTestGivesTheMotionOfTheLastTestThoughItIsWorse) {
  KnownEnvironment environment;
  const std::string folder = FreshFolder("last_test");
  LearnOptions options = ShortRun();
  options.test_every = 1;
  options.mistakes = {Mistake::kLastTest};
  (void)Learn(options, environment, folder);
  const std::vector<Value> lines = LinesOf(folder);
  EXPECT_NEAR(PathLength(ReadPolicy(folder + "/policy").motion),
              lines.back().At("path_length_m").AsDouble(), 1e-9);
  double best_return = -1e9;
  for (const Value& line : lines) {
    if (line.At("kind").AsString() == "test") {
      best_return = std::max(best_return, line.At("return").AsDouble());
    }
  }
  EXPECT_GT(best_return, lines.back().At("return").AsDouble());
}

}  // namespace
}  // namespace calibrato
