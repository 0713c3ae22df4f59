// calibrato diff as its users run it.

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
  Value camera = Value::Object();
  camera.Set("model", "pinhole-none")
      .Set("resolution", Value::Numbers(std::vector<double>{640, 480}))
      .Set("intrinsics", Value::Numbers(std::vector<double>{f, f, 320.0, 240.0}))
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
      .Set("cameras", Value::Array().Append(camera))
      .Set("covariance", Value::Object().Set("names", names).Set("matrix", matrix));
  const std::string path = scratch.Write(folder + "/result.json", ToJson(result));
  return std::filesystem::path(path).parent_path().string();
}

TEST(DiffCommand, SaysByItsExitCodeWhetherResultsAgree) {
  const ScratchFolder scratch;
  const std::string a = WriteResult(scratch, "a", 600.0);
  const std::string near = WriteResult(scratch, "near", 601.0);
  const std::string far = WriteResult(scratch, "far", 620.0);
  const Ended agree = RunProgram({"diff", a, near});
  EXPECT_EQ(agree.exit_code, 0) << agree.err;
  EXPECT_NE(agree.out.find("the results agree"), std::string::npos) << agree.out;
  const Ended differ = RunProgram({"diff", a, far});
  EXPECT_EQ(differ.exit_code, 1) << differ.err;
  EXPECT_NE(differ.out.find("differ by more than chance"), std::string::npos) << differ.out;
}

TEST(DiffCommand, WritesItsResultAsJsonAndAsAPage) {
  const ScratchFolder scratch;
  const std::string a = WriteResult(scratch, "a", 600.0);
  const std::string b = WriteResult(scratch, "b", 620.0);
  const std::string out = scratch.Path("out");
  const Ended ended = RunProgram({"diff", a, b, "--json", "--out", out});
  const Value value = ParseJson(ended.out, "stdout");
  EXPECT_EQ(value.At("agreement").AsString(), "differ");
  EXPECT_EQ(ContentOf(std::filesystem::path(out) / "result.json"), ended.out);
  EXPECT_TRUE(std::filesystem::exists(std::filesystem::path(out) / "report.html"));
}

TEST(DiffCommand, NamesTheFolderWithoutAResult) {
  const ScratchFolder scratch;
  const std::string a = WriteResult(scratch, "a", 600.0);
  const std::string empty = scratch.MakeFolder("empty");
  const Ended ended = RunProgram({"diff", a, empty});
  EXPECT_EQ(ended.exit_code, 2);
  EXPECT_NE(ended.err.find(empty), std::string::npos) << ended.err;
}

}  // namespace
}  // namespace calibrato
