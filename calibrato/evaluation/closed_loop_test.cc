#include "calibrato/evaluation/closed_loop.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "calibrato/evaluation/contest.h"
#include "calibrato/evaluation/four_rows.h"
#include "calibrato/mdp/design_setting.h"
#include "calibrato/mdp/motion_design.h"
#include "calibrato/motion/paper_scene.h"

namespace calibrato {
namespace {

// Two short loops: what is tested is the course, not how far it gets.
MotionDesignProblem SmallProblem(Task task) {
  MotionDesignProblem problem;
  problem.task = task;
  problem.rigs = {AsEstimated(PaperRig())};
  problem.num_loops = 2;
  problem.max_path_m = 4.0;
  problem.max_duration_s = 10.0;
  problem.frames_per_loop = 16;
  return problem;
}

Motion SomeMotion(const MotionDesignProblem& problem) {
  Rng draws(4);
  Motion motion = RandomMotion(problem.task, draws);
  motion.loops.resize(2);
  return FitToBudget(problem, motion).value();
}

Rig DrawnRig(RigDistribution distribution, uint64_t seed) {
  Rng draws(seed);
  return DrawRig(distribution, draws);
}

TEST(BelievedAfter, IsWhatWasMeasured) {
  const Rig rig = DrawnRig(RigDistribution::kPaper, 3);
  const MotionDesignProblem problem = SmallProblem(Task::kIntrinsic);
  const ExecutableMotion motion = MakeExecutable(SomeMotion(problem), Carrier::kFree, rig);
  const auto believed =
      BelievedAfter(Task::kIntrinsic, rig,
                    RecordForTrial(Task::kIntrinsic, rig, motion, Fidelity::kFast, Rng(1)));
  ASSERT_TRUE(believed.has_value());
  const Eigen::Vector4d truth = rig.cameras[0].model.focal_and_centre();
  const Eigen::Vector4d estimate = believed->cameras[0].model.focal_and_centre();
  EXPECT_LT((estimate - truth).norm(), 0.03 * truth.norm());
  EXPECT_GT((estimate - truth).norm(), 0.0);
  EXPECT_EQ(believed->T_w_g.t, rig.T_w_g.t);
  // Nothing seen, nothing believed.
  EXPECT_FALSE(BelievedAfter(Task::kIntrinsic, rig, TrialRecording()).has_value());
  EXPECT_FALSE(BelievedAfter(Task::kExtrinsic, rig, TrialRecording()).has_value());
}

// What the rest was designed by is what the whole motion records: the first loop's frames.
TEST(PlayClosedLoop, AnswersWhatTheJudgeSees) {
  for (const Task task : {Task::kIntrinsic, Task::kExtrinsic}) {
    const MotionDesignProblem problem = SmallProblem(task);
    const Rig rig = DrawnRig(RigDistribution::kPaper, 5);
    const Motion start = SomeMotion(problem);
    const MotionForRig played =
        PlayClosedLoop(problem, start, Carrier::kFree, Fidelity::kFast, rig, Rng(2), {10});
    EXPECT_EQ(played.num_designs, 1);
    EXPECT_GE(played.num_information_evaluations, 10);
    const Motion& motion = played.motion.timed->motion;
    ASSERT_EQ(motion.loops.size(), 2U);
    // As this rig's carrier makes the start, which was fitted to another lens.
    const Motion begun = MakeExecutable(start, Carrier::kFree, rig).timed->motion;
    EXPECT_EQ(motion.loops[0].coefficients, begun.loops[0].coefficients);
    EXPECT_NE(motion.loops[1].coefficients, begun.loops[1].coefficients);
    EXPECT_LE(played.motion.path_length_m, problem.max_path_m * 1.001);
    EXPECT_LE(played.motion.path.duration_s, problem.max_duration_s * 1.001);
    // It is better than the start for this rig, as far as expectation goes.
    MotionDesignProblem truth = problem;
    truth.rigs = {AsEstimated(rig)};
    EXPECT_LT(ExpectLoss(truth, motion).value, ExpectLoss(truth, begun).value);

    Motion first = motion;
    first.loops.resize(1);
    const TrialRecording part = RecordForTrial(
        task, rig, MakeExecutable(first, Carrier::kFree, rig), Fidelity::kFast, Rng(2));
    const TrialRecording whole = RecordForTrial(task, rig, played.motion, Fidelity::kFast, Rng(2));
    ASSERT_GT(part.views.size(), 10U);
    ASSERT_GT(whole.views.size(), part.views.size());
    for (size_t k = 0; k < part.views.size(); ++k) {
      EXPECT_EQ(part.views[k].pixels, whole.views[k].pixels) << TaskName(task) << " " << k;
    }
  }
}

TEST(DesignForTruth, IsAtLeastAsGoodAsItsStart) {
  const MotionDesignProblem problem = SmallProblem(Task::kExtrinsic);
  const Rig rig = DrawnRig(RigDistribution::kBroad, 8);
  const Motion start = SomeMotion(problem);
  const MotionForRig made = DesignForTruth(problem, start, Carrier::kFree, rig, 20);
  MotionDesignProblem truth = problem;
  truth.rigs = {AsEstimated(rig)};
  truth.base_pose = BasePoseBeforeBoard(rig);
  EXPECT_EQ(made.motion.timed->motion.base_pose, truth.base_pose);
  EXPECT_LT(ExpectLoss(truth, made.motion.timed->motion).value,
            ExpectLoss(truth, FitToBudget(truth, start).value()).value);
}

TEST(FourRows, HaveTheirBudgetsAndTheRatiosOfEach) {
  ContestSetting setting;
  setting.task = Task::kExtrinsic;
  setting.rigs = RigDistribution::kBroad;
  setting.num_rigs = 3;
  FourRowsOptions options;
  options.num_believed = 1;
  options.num_starts = 1;
  options.evaluations_per_start = 8;
  options.evaluations_of_best = 8;
  options.robust_evaluations = 4;
  options.oracle_evaluations = 8;
  options.closed_loop.evaluations_per_design = 4;
  Motion theirs = HandcraftedMotion(Task::kExtrinsic);
  theirs.provenance = Value::Object().Set("episodes", 96);
  const FourRows rows = EvaluateFourRows(setting, {{"theirs", theirs, {}}}, options);
  const Value document = ToValue({rows});
  std::vector<std::string> names;
  for (const Value& row : document.At("rows").elements()) {
    const std::string name = row.At("policy").AsString();
    names.push_back(name);
    EXPECT_EQ(row.At("n").AsInt(), 3);
    EXPECT_EQ(row.At("episodes").AsInt(), name.starts_with("theirs") ? 96 : 0);
    const bool is_of_rig = name == "oracle" || name.ends_with("closed loop");
    EXPECT_EQ(row.At("information_evaluations_of_rig").AsDouble() > 0.0, is_of_rig) << name;
    const bool is_designed = name != "handcrafted" && !name.starts_with("theirs");
    EXPECT_EQ(row.At("design_information_evaluations").AsInt() > 0, is_designed) << name;
    EXPECT_EQ(row.Find("ratio_to_robust") != nullptr, name != "robust") << name;
    // All at the same budget.
    EXPECT_LE(row.At("path_length_m").AsDouble(), 3.3786 * 1.002) << name;
  }
  EXPECT_EQ(names, (std::vector<std::string>{"handcrafted", "nominal", "robust", "closed loop",
                                             "oracle", "theirs", "theirs, closed loop"}));
  // The same motion is the same row.
  EXPECT_EQ(document.At("rows").elements()[0].At("mean_error_percent").AsDouble(),
            document.At("rows").elements()[5].At("mean_error_percent").AsDouble());
  EXPECT_EQ(ChartsOf({rows}).front().series.size(), names.size());
}

}  // namespace
}  // namespace calibrato
