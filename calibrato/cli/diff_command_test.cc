// calibrato diff as its users run it.

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "calibrato/base/value.h"
#include "calibrato/cli/camera_result_for_test.h"
#include "calibrato/cli/program_for_test.h"

namespace calibrato {
namespace {

TEST(DiffCommand, SaysByItsExitCodeWhetherResultsAgree) {
  const ScratchFolder scratch;
  const std::string a = WriteCameraResult(scratch, "a", 600.0);
  const std::string near = WriteCameraResult(scratch, "near", 601.0);
  const std::string far = WriteCameraResult(scratch, "far", 620.0);
  const Ended agree = RunProgram({"diff", a, near});
  EXPECT_EQ(agree.exit_code, 0) << agree.err;
  EXPECT_NE(agree.out.find("the results agree"), std::string::npos) << agree.out;
  const Ended differ = RunProgram({"diff", a, far});
  EXPECT_EQ(differ.exit_code, 1) << differ.err;
  EXPECT_NE(differ.out.find("differ by more than chance"), std::string::npos) << differ.out;
}

TEST(DiffCommand, WritesItsResultAsJsonAndAsAPage) {
  const ScratchFolder scratch;
  const std::string a = WriteCameraResult(scratch, "a", 600.0);
  const std::string b = WriteCameraResult(scratch, "b", 620.0);
  const std::string out = scratch.Path("out");
  const Ended ended = RunProgram({"diff", a, b, "--json", "--out", out});
  const Value value = ParseJson(ended.out, "stdout");
  EXPECT_EQ(value.At("agreement").AsString(), "differ");
  EXPECT_EQ(ContentOf(std::filesystem::path(out) / "result.json"), ended.out);
  EXPECT_TRUE(std::filesystem::exists(std::filesystem::path(out) / "report.html"));
}

TEST(DiffCommand, NamesTheFolderWithoutAResult) {
  const ScratchFolder scratch;
  const std::string a = WriteCameraResult(scratch, "a", 600.0);
  const std::string empty = scratch.MakeFolder("empty");
  const Ended ended = RunProgram({"diff", a, empty});
  EXPECT_EQ(ended.exit_code, 2);
  EXPECT_NE(ended.err.find(empty), std::string::npos) << ended.err;
}

}  // namespace
}  // namespace calibrato
