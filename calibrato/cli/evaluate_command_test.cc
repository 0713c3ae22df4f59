// `calibrato evaluate` as its users run it: what they bring, and what they bring that is no good.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "calibrato/base/value.h"
#include "calibrato/cli/program_for_test.h"

namespace calibrato {
namespace {

Arguments With(Arguments arguments, const Arguments& more) {
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

const Arguments kTable1 = {"evaluate", "table1", "--task", "intrinsic", "--num-rigs", "2"};

void ExpectRefused(const ScratchFolder& scratch, const Arguments& arguments,
                   const std::vector<std::string>& words) {
  const std::string out = scratch.Path("out");
  const Ended ended = RunProgram(With(arguments, {"--out", out}));
  EXPECT_EQ(ended.exit_code, 2);
  EXPECT_EQ(ended.out, "");
  EXPECT_FALSE(std::filesystem::exists(out));
  for (const std::string& word : words) EXPECT_PRED_FORMAT2(testing::IsSubstring, word, ended.err);
}

// Half a turn about an axis before the board, at 20 Hz.
std::string Trajectory() {
  std::string text = "# stamp tx ty tz qx qy qz qw\n";
  for (int i = 0; i <= 80; ++i) {
    const double s = i / 80.0;
    const double turn = 0.3 * (s - 0.5);
    char line[200];
    std::snprintf(line, sizeof(line), "%.3f %.4f %.4f %.4f %.5f %.5f 0 0\n", 100.0 + 0.05 * i,
                  0.18 + 0.3 * (s - 0.5), 0.15, 1.1 + 0.2 * s, 1.0 - 0.5 * turn * turn, turn);
    text += line;
  }
  return text;
}

// policy -> row.
Value RowOf(const std::string& json, const std::string& policy) {
  const Value document = ParseJson(json, "stdout");
  for (const Value& row : document.At("rows").elements()) {
    if (row.At("policy").AsString() == policy) return row;
  }
  ADD_FAILURE() << "no row " << policy;
  return {};
}

TEST(Evaluate, JudgesWhatStrangersBring) {
  const ScratchFolder scratch;
  const std::string motion = scratch.Write("theirs.yaml", MotionYaml(0.1));
  const std::string hand = scratch.Write("hand.txt", Trajectory());
  const std::string rig = scratch.Write("rig.yaml", RigYaml());
  const std::string policy = scratch.MakeFolder("policy");
  const std::string tuned = scratch.MakeFolder("tuned");
  (void)scratch.Write("policy/motion.yaml", MotionYaml(0.1));
  (void)scratch.Write("policy/policy.yaml", "task: intrinsic\n");
  (void)scratch.Write("tuned/policy/motion.yaml", MotionYaml(0.12));
  const std::string out = scratch.Path("out");
  const Ended ended = RunProgram(With(
      kTable1, {"--motion", motion, "--trajectory", hand, "--rig-file", rig, "--policy", policy,
                "--policy", policy, "--policy", "fine-tuned=" + tuned, "--json", "--out", out}));
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_EQ(RowOf(ended.out, "learned").At("num_training_seeds").AsInt(), 2);
  EXPECT_EQ(RowOf(ended.out, "learned").At("n").AsInt(), 4);
  EXPECT_EQ(RowOf(ended.out, "fine-tuned").At("n").AsInt(), 2);
  EXPECT_EQ(RowOf(ended.out, "theirs").At("rigs").AsString(), "file");
  EXPECT_NEAR(RowOf(ended.out, "hand").At("motion_s").AsDouble(), 4.0, 1e-9);
  for (const char* name : {"table1.json", "result.json", "trials.csv", "report.html"}) {
    EXPECT_TRUE(std::filesystem::exists(out + "/" + name)) << name;
  }
}

TEST(Evaluate, RefusesMalformedFilesWithLineAndKey) {
  const ScratchFolder scratch;
  const std::string motion = scratch.Write(
      "theirs.yaml", "carrier: free\nbase_pose: {xyz_m: [0, 0], rpy_rad: [0, 0, 0]}\n");
  ExpectRefused(scratch, With(kTable1, {"--motion", motion}),
                {"theirs.yaml line 2", "base_pose.xyz_m"});
  const std::string hand = scratch.Write("hand.txt", "# stamp\n1 0 0 1 0 0 0 1\n1 0 0 1\n");
  ExpectRefused(scratch, With(kTable1, {"--trajectory", hand}), {"hand.txt line 3", "8 numbers"});
  const std::string rig = scratch.Write("rig.yaml", "cameras: 3\n");
  ExpectRefused(scratch, With(kTable1, {"--rig-file", rig}), {"rig.yaml"});
  const std::string outside = scratch.Write("kalibr.yaml", "name: kalibr\ncommand: run\n");
  ExpectRefused(
      scratch,
      {"evaluate", "rivals", "--task", "extrinsic", "--num-rigs", "2", "--outside", outside},
      {"kalibr.yaml line 2", "command"});
}

TEST(Evaluate, RefusesWhatDoesNotExist) {
  const ScratchFolder scratch;
  ExpectRefused(scratch, {"evaluate", "table1", "--fidelity", "physical", "--num-rigs", "2"},
                {"physical", "--carrier arm"});
  ExpectRefused(scratch, {"evaluate", "figure4", "--task", "extrinsic"}, {"figure 4", "intrinsic"});
  ExpectRefused(scratch, {"evaluate", "table1", "--task", "joint"}, {"joint", "intrinsic"});
  ExpectRefused(scratch, {"evaluate", "table1", "--rigs", "papre"}, {"papre", "paper"});
}

}  // namespace
}  // namespace calibrato
