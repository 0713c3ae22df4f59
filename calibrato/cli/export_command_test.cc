// calibrato export as its users run it; what it writes is read by Python.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "calibrato/base/value.h"
#include "calibrato/cli/program_for_test.h"

namespace calibrato {
namespace {

constexpr char kPython[] = "/usr/bin/python3";

bool Succeeds(const std::string& command) { return std::system(command.c_str()) == 0; }

// Reads all three files, holds them against each other, and differentiates the commands as the
// arm's controller does: velocity, acceleration and jerk of the data sheet.
constexpr char kReader[] = R"(
import csv, math, sys, yaml

with open(sys.argv[1]) as file:
    table = list(csv.DictReader(file))
with open(sys.argv[2]) as file:
    commands = [[float(cell) for cell in row] for row in csv.reader(file)]
with open(sys.argv[3]) as file:
    trajectory = yaml.safe_load(file)['joint_trajectory']
assert len(table) == len(commands)
for k, (row, command) in enumerate(zip(table, commands)):
    assert abs(float(row['t [s]']) - 1e-3 * k) < 1e-9
    for i in range(7):
        assert float(row['q%d [rad]' % (i + 1)]) == command[i]
assert trajectory['joint_names'] == ['panda_joint%d' % i for i in range(1, 8)]
points = trajectory['points']
assert len(points) == math.ceil((len(commands) - 1) / 10) + 1
for k, point in enumerate(points):
    time = point['time_from_start']
    assert time['sec'] * 10**9 + time['nanosec'] == k * 10**7
    if 10 * k < len(commands):
        row = table[10 * k]
        for i in range(7):
            assert abs(point['positions'][i] - commands[10 * k][i]) < 1e-12
            assert abs(point['velocities'][i] - float(row['dq%d [rad/s]' % (i + 1)])) < 1e-9
            assert abs(point['accelerations'][i] - float(row['ddq%d [rad/s^2]' % (i + 1)])) < 1e-6
velocity = [2.175] * 4 + [2.61] * 3
acceleration = [15, 7.5, 10, 12.5, 15, 20, 20]
jerk = [7500, 3750, 5000, 6250, 7500, 10000, 10000]
for i in range(7):
    values = [c[i] for c in commands]
    values = [values[0]] * 3 + values + [values[-1]] * 3
    assert max(values) - min(values) > 1e-3 or i == 6
    for bound in (velocity[i], acceleration[i], jerk[i]):
        values = [(b - a) / 1e-3 for a, b in zip(values, values[1:])]
        assert max(abs(v) for v in values) < bound
)";

TEST(ExportCommand, WritesWhatAnotherProgramReadsAndTheArmAccepts) {
  if (!Succeeds(std::string(kPython) + " -c 'import yaml' 2>/dev/null")) {
    GTEST_SKIP() << "needs Debian's python3-yaml";
  }
  const ScratchFolder scratch;
  const std::string motion = scratch.Write("motion.yaml", MotionYaml(0.05));
  const std::string reader = scratch.Write("reader.py", kReader);
  for (const std::string timing : {"quintic", "optimal"}) {
    std::string files;
    for (const std::string format : {"joint-csv", "franka-csv", "moveit"}) {
      const std::string out = scratch.Path(timing + format);
      const Ended ended = RunProgram(
          {"export", motion, "--format", format, "--timing", timing, "--json", "--out", out});
      ASSERT_EQ(ended.exit_code, 0) << ended.err;
      const Value summary = ParseJson(ended.out, "stdout");
      EXPECT_EQ(summary.At("format").AsString(), format);
      EXPECT_EQ(summary.At("timing").AsString(), timing);
      files += " " + out;
    }
    EXPECT_TRUE(Succeeds(std::string(kPython) + " " + reader + files));
  }
}

TEST(ExportCommand, DrawsADryRun) {
  const ScratchFolder scratch;
  const std::string motion = scratch.Write("motion.yaml", MotionYaml(0.05));
  const std::string page = scratch.Path("dry-run.html");
  const Ended ended = RunProgram({"export", motion, "--format", "joint-csv", "--html", page,
                                  "--out", scratch.Path("joints.csv")});
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  const std::string html = ContentOf(page);
  // The document that the page draws: all seven joints at rest at both ends, the arm at each step.
  const std::string opening = "<script type=\"application/json\" id=\"documents\">";
  const size_t begin = html.find(opening);
  ASSERT_NE(begin, std::string::npos);
  const size_t end = html.find("</script>", begin);
  const Value documents = ParseJson(
      html.substr(begin + opening.size(), end - begin - opening.size()), "documents of the page");
  const Value& drawn = documents.elements().at(0);
  EXPECT_EQ(drawn.At("kind").AsString(), "dry-run");
  EXPECT_EQ(drawn.At("joints").At("names").size(), 7U);
  for (const Value& quantity : drawn.At("joints").At("quantities").elements()) {
    EXPECT_LE(quantity.At("largest_share").AsDouble(), 1.001) << quantity.At("name").AsString();
  }
  const Value& played = drawn.At("motion").At("played");
  EXPECT_EQ(played.At("arm_b").size(), played.At("camera_b").size());
  const Ended folder = RunProgram({"export", scratch.MakeFolder("result"), "--format", "ros",
                                   "--html", page, "--out", scratch.Path("ros")});
  EXPECT_EQ(folder.exit_code, 2);
  EXPECT_NE(folder.err.find("--html has no use here"), std::string::npos) << folder.err;
}

TEST(ExportCommand, WritesNothingWhereOneOfItsFilesCannotBe) {
  const ScratchFolder scratch;
  const std::string motion = scratch.Write("motion.yaml", MotionYaml(0.05));
  const std::string rig = scratch.Write("rig.yaml", RigYaml());
  const auto before = FilesBelow(scratch.Path(""));
  const auto refused = [&](const std::string& out, const std::string& html,
                           const std::string& why) {
    const Ended ended = RunProgram(
        {"export", motion, "--rig", rig, "--format", "joint-csv", "--out", out, "--html", html});
    EXPECT_EQ(ended.exit_code, 2) << why;
    EXPECT_NE(ended.err.find(why), std::string::npos) << ended.err;
    EXPECT_EQ(FilesBelow(scratch.Path("")), before);
  };
  const std::string out = scratch.Path("joints.csv");
  refused(out, out, "it is that of --out and that of --html");
  refused(motion, scratch.Path("page.html"), "it is that of the motion and that of --out");
  refused(out, rig, "it is that of --rig and that of --html");
  refused(out, scratch.Path("nowhere/page.html"), "cannot write file");
}

// What two files can't have is told before the work; what the disk refuses, after it.
TEST(ExportCommand, LeavesNothingIfThePageDoesNotFitOnTheDisk) {
  const ScratchFolder scratch;
  const std::string motion = scratch.Write("motion.yaml", MotionYaml(0.05));
  const auto before = FilesBelow(scratch.Path(""));
  const Arguments arguments = {"export",   motion,
                               "--format", "moveit",
                               "--out",    scratch.Path("trajectory.yaml"),
                               "--html",   scratch.Path("page.html")};
  const Ended whole = RunProgram(arguments);
  ASSERT_EQ(whole.exit_code, 0) << whole.err;
  EXPECT_NE(whole.out.find("1 loop in"), std::string::npos) << whole.out;
  // The trajectory fits, the page is one byte too large.
  const auto size = ContentOf(scratch.Path("page.html")).size();
  ASSERT_GT(size, ContentOf(scratch.Path("trajectory.yaml")).size());
  std::filesystem::remove(scratch.Path("page.html"));
  std::filesystem::remove(scratch.Path("trajectory.yaml"));
  const Ended full = RunProgram(arguments, size - 1);
  EXPECT_EQ(full.exit_code, 2);
  EXPECT_EQ(FilesBelow(scratch.Path("")), before);
}

TEST(ExportCommand, RefusesAMotionThatTheArmCannotMakeAndUnknownFormats) {
  const ScratchFolder scratch;
  const std::string out = scratch.Path("out");
  const std::string far = scratch.Write("far.yaml", MotionYaml(0.5));
  const Ended refused = RunProgram({"export", far, "--format", "moveit", "--out", out});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.err.find("the arm can't make this motion"), std::string::npos) << refused.err;
  const Ended scaled =
      RunProgram({"export", far, "--format", "moveit", "--scale-to-fit", "--out", out});
  EXPECT_EQ(scaled.exit_code, 0) << scaled.err;
  const Ended unknown = RunProgram({"export", far, "--format", "urscript", "--out", out});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_NE(unknown.err.find("joint-csv, moveit and franka-csv"), std::string::npos);
}

}  // namespace
}  // namespace calibrato
