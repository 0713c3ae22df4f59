#include "calibrato/learning/trainer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <sstream>

#include "calibrato/base/files.h"
#include "calibrato/base/input_error.h"
#include "calibrato/base/value.h"
#include "calibrato/learning/known_environment.h"
#include "calibrato/learning/policy.h"

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

}  // namespace
}  // namespace calibrato
