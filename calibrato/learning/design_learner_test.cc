#include "calibrato/learning/design_learner.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <variant>

#include "calibrato/base/files.h"
#include "calibrato/base/input_error.h"
#include "calibrato/base/parallel.h"
#include "calibrato/learning/team_of_threads.h"
#include "calibrato/motion/paper_scene.h"

namespace calibrato {
namespace {

DesignLearnOptions SmallRun() {
  DesignLearnOptions options;
  MotionDesignProblem& problem = options.problem;
  problem.task = Task::kExtrinsic;
  problem.rigs = {PaperRig()};
  problem.num_loops = 2;
  problem.max_path_m = 2.0;
  problem.max_duration_s = 10.0;
  problem.frames_per_loop = 16;
  options.starts = {.num_starts = 2, .evaluations_per_start = 15, .evaluations_of_best = 15};
  options.robust_evaluations = 5;
  options.evaluations_of_round = 10;
  options.episodes_per_round = 4;
  options.num_episodes = 32;
  return options;
}

Motion Executed(const TimedMotion& timed) {
  Motion motion = timed.motion;
  for (size_t i = 0; i < motion.loops.size(); ++i) {
    motion.loops[i].duration_s = timed.loop_duration_s[i];
  }
  return motion;
}

double FastestTurn(const TimedMotion& timed) {
  double fastest = 0.0;
  for (double t = 0.0; t < timed.duration_s(); t += 0.02) {
    fastest = std::max(fastest, timed.At(t).angular_velocity_b.norm());
  }
  return fastest;
}

// A world that is as the model says, but for what it charges from 0.5 rad/s on.
MotionJudgement JudgeWith(const DesignLearnOptions& options, double charge,
                          const TimedMotion& motion) {
  const double blur = charge * std::max(0.0, FastestTurn(motion) - 0.5);
  return {ExpectLoss(options.problem, Executed(motion)).value + blur, 6.0, 6, 0.01};
}

std::string NewFolder(const std::string& name) {
  const std::string folder = testing::TempDir() + "calibrato_design_" + name;
  std::filesystem::remove_all(folder);
  return folder;
}

TEST(RealisedLoss, IsWhatIsStatedTimesWhatItIsOffBy) {
  DesignRound round;
  // Eight rigs whose squared errors are four times what they should be, and four that are believed:
  // (4 + 4 * 8) / 12 = 3.
  round.judgements.assign(8, {1.5, 4.0 * 6.0, 6, 0.0});
  EXPECT_NEAR(RealisedLoss(round), 1.5 + 0.5 * std::log(3.0), 1e-12);
}

TEST(LearnByDesign, LearnsNotToTurnFastWhereThatCosts) {
  const DesignLearnOptions options = SmallRun();
  const Judge judge = [&](const TimedMotion& motion, uint64_t) {
    return JudgeWith(options, 2.0, motion);
  };
  const std::string folder = NewFolder("fast");
  const LearnResult learned = LearnByDesign(options, judge, folder);
  EXPECT_EQ(learned.termination, LearnTermination::kDone);
  EXPECT_EQ(learned.num_episodes, 32);
  const auto loss = [&](const Motion& motion) {
    return judge(std::get<TimedMotion>(PlanMotion(motion, PaperRig())), 0).stated_loss;
  };
  const Value rounds = ParseJson(ReadFile(folder + "/checkpoint.json"), "").At("rounds");
  ASSERT_EQ(rounds.size(), 8U);
  const double trusting =
      rounds.elements()[0].At("judgements").elements()[0].At("stated_loss").AsDouble();
  // At least a tenth of a sigma's logarithm better than the design that trusts the model.
  EXPECT_LT(loss(learned.motion), trusting - 0.1);
  EXPECT_EQ(ToYaml(ToValue(MotionFromValue(ReadYaml(folder + "/policy/motion.yaml"), nullptr))),
            ToYaml(ToValue(learned.motion)));
}

TEST(LearnByDesign, KeepsTheDesignWhereTheModelIsRight) {
  DesignLearnOptions options = SmallRun();
  options.num_episodes = 16;
  const Judge judge = [&](const TimedMotion& motion, uint64_t) {
    return JudgeWith(options, 0.0, motion);
  };
  const LearnResult learned = LearnByDesign(options, judge, NewFolder("right"));
  EXPECT_NE(learned.termination_text.find("round 1 of 4"), std::string::npos)
      << learned.termination_text;
}

TEST(LearnByDesign, WritesTheSameBytesForAnyNumberOfProcesses) {
  DesignLearnOptions options = SmallRun();
  options.num_episodes = 12;
  const Judge judge = [&](const TimedMotion& motion, uint64_t index) {
    MotionJudgement judgement = JudgeWith(options, 1.0, motion);
    judgement.nees += 0.1 * static_cast<double>(index);
    return judgement;
  };
  const std::string alone = NewFolder("alone");
  const LearnResult result = LearnByDesign(options, judge, alone);
  const std::string together = NewFolder("together");
  const auto texts = RunAsTeam(3, [&](Team& team) {
    const LearnResult own = LearnByDesign(options, judge, together, nullptr, &team);
    return own.termination_text + std::to_string(own.num_information_evaluations);
  });
  for (const std::string& text : texts) {
    EXPECT_EQ(text, result.termination_text + std::to_string(result.num_information_evaluations));
  }
  for (const char* file :
       {"training.jsonl", "checkpoint.json", "policy/motion.yaml", "policy/policy.yaml"}) {
    EXPECT_EQ(ReadFile(alone + "/" + file), ReadFile(together + "/" + file)) << file;
  }
}

// What every round states of the same rigs is not smoothed away: a narrow valley between rounds
// that are worse is kept.
TEST(LearnByDesign, KeepsTheRoundThatIsStatedToBeBest) {
  DesignLearnOptions options = SmallRun();
  options.num_episodes = 24;
  int num_judged = 0;
  // The fourth round is better by more than its noise, the others are alike.
  const Judge judge = [&](const TimedMotion& motion, uint64_t) {
    const int round = num_judged++ / options.episodes_per_round;
    return MotionJudgement{
        ExpectLoss(options.problem, Executed(motion)).value + (round == 3 ? -0.25 : 0.3), 6.0, 6,
        0.01};
  };
  SetNumThreads(1);
  const LearnResult learned = LearnByDesign(options, judge, NewFolder("valley"));
  SetNumThreads(0);
  EXPECT_NE(learned.termination_text.find("round 4 of 6"), std::string::npos)
      << learned.termination_text;
}

TEST(LearnByDesign, ResumesToTheSameBytes) {
  DesignLearnOptions options = SmallRun();
  options.num_episodes = 12;
  const Judge judge = [&](const TimedMotion& motion, uint64_t index) {
    MotionJudgement judgement = JudgeWith(options, 1.0, motion);
    judgement.nees += static_cast<double>(index);
    return judgement;
  };
  const std::string whole = NewFolder("whole");
  (void)LearnByDesign(options, judge, whole);
  const std::string parts = NewFolder("parts");
  std::atomic<bool> interrupt = false;
  int num_judged = 0;
  const Judge interrupting = [&](const TimedMotion& motion, uint64_t index) {
    if (index == 3 && ++num_judged == 2) interrupt = true;
    return judge(motion, index);
  };
  EXPECT_EQ(LearnByDesign(options, interrupting, parts, &interrupt).termination,
            LearnTermination::kInterrupted);
  EXPECT_FALSE(std::filesystem::exists(parts + "/policy"));
  options.resume = true;
  (void)LearnByDesign(options, judge, parts);
  for (const char* file :
       {"training.jsonl", "checkpoint.json", "policy/motion.yaml", "policy/policy.yaml"}) {
    EXPECT_EQ(ReadFile(whole + "/" + file), ReadFile(parts + "/" + file)) << file;
  }

  options.seed = 2;
  EXPECT_THROW((void)LearnByDesign(options, judge, parts), InputError);
  EXPECT_THROW((void)LearnByDesign(options, judge, NewFolder("nothing")), InputError);
}

}  // namespace
}  // namespace calibrato
