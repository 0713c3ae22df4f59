// calibrato merge as its users run it, and what takes its folder.

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "calibrato/base/value.h"
#include "calibrato/cli/camera_result_for_test.h"
#include "calibrato/cli/program_for_test.h"

namespace calibrato {
namespace {

TEST(MergeCommand, WritesAResultThatDiffAndExportTake) {
  const ScratchFolder scratch;
  const std::string a = WriteCameraResult(scratch, "a", 600.0);
  const std::string b = WriteCameraResult(scratch, "b", 602.0);
  const std::string out = scratch.Path("merged");
  const Ended merged = RunProgram({"merge", a, b, "--out", out});
  EXPECT_EQ(merged.exit_code, 0) << merged.err;
  EXPECT_NE(merged.out.find("merged from 2 results"), std::string::npos) << merged.out;
  EXPECT_NE(merged.out.find("verdict: pass"), std::string::npos) << merged.out;
  for (const char* name : {"result.json", "camchain.yaml", "report.html", "timing.json"}) {
    EXPECT_TRUE(std::filesystem::exists(std::filesystem::path(out) / name)) << name;
  }
  const Value chain = ReadYaml(out + "/camchain.yaml");
  EXPECT_NEAR(chain.At("cam0").At("intrinsics").AsDoubles()[0], 601.0, 1e-9);

  EXPECT_EQ(RunProgram({"diff", out, a}).exit_code, 0);
  const std::string far = WriteCameraResult(scratch, "far", 640.0);
  EXPECT_EQ(RunProgram({"diff", out, far}).exit_code, 1);
  const Ended exported =
      RunProgram({"export", out, "--format", "ros", "--out", scratch.Path("ros")});
  EXPECT_EQ(exported.exit_code, 0) << exported.err;
  const Value info = ReadYaml(scratch.Path("ros/cam0.yaml"));
  EXPECT_NEAR(info.At("camera_matrix").At("data").AsDoubles()[0], 601.0, 1e-9);
}

TEST(MergeCommand, WarnsWhereRecordingsScatter) {
  const ScratchFolder scratch;
  const std::string a = WriteCameraResult(scratch, "a", 600.0);
  const std::string b = WriteCameraResult(scratch, "b", 620.0);
  const Ended merged = RunProgram({"merge", a, b, "--out", scratch.Path("merged"), "--json"});
  EXPECT_EQ(merged.exit_code, 0) << merged.err;
  const Value value = ParseJson(merged.out, "stdout");
  EXPECT_EQ(value.At("verdict").AsString(), "warn");
  EXPECT_GT(value.At("groups").elements()[0].At("sigma_scale").AsDouble(), 5.0);
}

TEST(MergeCommand, WritesNothingOfOneResultAlone) {
  const ScratchFolder scratch;
  const std::string a = WriteCameraResult(scratch, "a", 600.0);
  const std::string out = scratch.Path("merged");
  const Ended ended = RunProgram({"merge", a, "--out", out});
  EXPECT_EQ(ended.exit_code, 2);
  EXPECT_NE(ended.err.find("at least two recordings"), std::string::npos) << ended.err;
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST(MergeCommand, CountsNoFolderTwice) {
  const ScratchFolder scratch;
  const std::string a = WriteCameraResult(scratch, "a", 600.0);
  const std::string b = WriteCameraResult(scratch, "b", 602.0);
  const std::string out = scratch.Path("merged");
  std::filesystem::create_directory_symlink(a, scratch.Path("link"));
  const std::vector<std::vector<std::string>> commands = {
      {"merge", a, a, "--out", out},
      {"merge", a, b, a + "/", "--out", out},
      {"merge", a, scratch.Path("b/../a"), "--out", out},
      {"merge", a, scratch.Path("link"), "--out", out},
      {"merge", a, b, "--out", b + "/"}};
  for (const std::vector<std::string>& command : commands) {
    const Ended ended = RunProgram(command);
    EXPECT_EQ(ended.exit_code, 2);
    EXPECT_NE(ended.err.find("a result would count twice"), std::string::npos) << ended.err;
  }
  EXPECT_FALSE(std::filesystem::exists(out));
  // What stood in the folder that was to be written to still stands there.
  EXPECT_EQ(ReadJson(b + "/result.json").At("kind").AsString(), "camera");
}

TEST(DiffCommand, FindsSmallerChangesAtAHigherLevel) {
  const ScratchFolder scratch;
  const std::string a = WriteCameraResult(scratch, "a", 600.0);
  // fu and fv 2.5 px longer, each to a variance of 1 + 1: 2.5 sigma of their mean.
  const std::string b = WriteCameraResult(scratch, "b", 602.5);
  EXPECT_EQ(RunProgram({"diff", a, b}).exit_code, 0);
  const Ended differ = RunProgram({"diff", a, b, "--level", "0.04"});
  EXPECT_EQ(differ.exit_code, 1) << differ.out;
  EXPECT_NE(differ.out.find("if only the focal length changed"), std::string::npos) << differ.out;
}

}  // namespace
}  // namespace calibrato
