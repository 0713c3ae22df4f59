// calibrato merge as its users run it, and what takes its folder.

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "calibrato/base/value.h"
#include "calibrato/cli/program_for_test.h"

namespace calibrato {
namespace {

// A folder with the result of one pinhole camera; every sigma is 1 px.
std::string WriteResult(const ScratchFolder& scratch, const std::string& folder, double f) {
  const std::vector<double> intrinsics = {f, f, 320.0, 240.0};
  const Value camera = Value::Object()
                           .Set("model", "pinhole-none")
                           .Set("resolution", Value::Numbers(std::vector<double>{640, 480}))
                           .Set("intrinsics", Value::Numbers(intrinsics))
                           .Set("distortion", Value::Array())
                           .Set("T_cn_cnm1", Value());
  Value names = Value::Array();
  Value matrix = Value::Array();
  for (size_t i = 0; i < 4; ++i) {
    names.Append(std::string("cam0.") + std::string("fufvpupv").substr(2 * i, 2));
    std::vector<double> row(4, 0.0);
    row[i] = 1.0;
    matrix.Append(Value::Numbers(row));
  }
  Value result = Value::Object();
  result.Set("kind", "camera")
      .Set("verdict", "pass")
      .Set("cameras", Value::Array().Append(camera))
      .Set("covariance", Value::Object().Set("names", names).Set("matrix", matrix));
  const Value chain =
      Value::Object().Set("cam0", Value::Object()
                                      .Set("camera_model", "pinhole")
                                      .Set("intrinsics", Value::Numbers(intrinsics))
                                      .Set("distortion_model", "none")
                                      .Set("distortion_coeffs", Value::Array())
                                      .Set("resolution", Value::Array().Append(640).Append(480))
                                      .Set("rostopic", "/cam0/image_raw"));
  (void)scratch.Write(folder + "/camchain.yaml", ToYaml(chain));
  const std::string path = scratch.Write(folder + "/result.json", ToJson(result));
  return std::filesystem::path(path).parent_path().string();
}

TEST(MergeCommand, WritesAResultThatDiffAndExportTake) {
  const ScratchFolder scratch;
  const std::string a = WriteResult(scratch, "a", 600.0);
  const std::string b = WriteResult(scratch, "b", 602.0);
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
  const std::string far = WriteResult(scratch, "far", 640.0);
  EXPECT_EQ(RunProgram({"diff", out, far}).exit_code, 1);
  const Ended exported =
      RunProgram({"export", out, "--format", "ros", "--out", scratch.Path("ros")});
  EXPECT_EQ(exported.exit_code, 0) << exported.err;
  const Value info = ReadYaml(scratch.Path("ros/cam0.yaml"));
  EXPECT_NEAR(info.At("camera_matrix").At("data").AsDoubles()[0], 601.0, 1e-9);
}

TEST(MergeCommand, WarnsWhereRecordingsScatter) {
  const ScratchFolder scratch;
  const std::string a = WriteResult(scratch, "a", 600.0);
  const std::string b = WriteResult(scratch, "b", 620.0);
  const Ended merged = RunProgram({"merge", a, b, "--out", scratch.Path("merged"), "--json"});
  EXPECT_EQ(merged.exit_code, 0) << merged.err;
  const Value value = ParseJson(merged.out, "stdout");
  EXPECT_EQ(value.At("verdict").AsString(), "warn");
  EXPECT_GT(value.At("groups").elements()[0].At("sigma_scale").AsDouble(), 5.0);
}

TEST(MergeCommand, WritesNothingOfOneResultAlone) {
  const ScratchFolder scratch;
  const std::string a = WriteResult(scratch, "a", 600.0);
  const std::string out = scratch.Path("merged");
  const Ended ended = RunProgram({"merge", a, "--out", out});
  EXPECT_EQ(ended.exit_code, 2);
  EXPECT_NE(ended.err.find("at least two recordings"), std::string::npos) << ended.err;
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST(MergeCommand, CountsNoFolderTwice) {
  const ScratchFolder scratch;
  const std::string a = WriteResult(scratch, "a", 600.0);
  const std::string b = WriteResult(scratch, "b", 602.0);
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
  const std::string a = WriteResult(scratch, "a", 600.0);
  // fu and fv 2.5 px longer, each to a variance of 1 + 1: 2.5 sigma of their mean.
  const std::string b = WriteResult(scratch, "b", 602.5);
  EXPECT_EQ(RunProgram({"diff", a, b}).exit_code, 0);
  const Ended differ = RunProgram({"diff", a, b, "--level", "0.04"});
  EXPECT_EQ(differ.exit_code, 1) << differ.out;
  EXPECT_NE(differ.out.find("if only the focal length changed"), std::string::npos) << differ.out;
}

}  // namespace
}  // namespace calibrato
