// `calibrato board`, as its users run it.

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <utility>

#include "calibrato/cli/program_for_test.h"

namespace calibrato {
namespace {

const char* const kTarget =
    "target_type: 'aprilgrid'\ntagCols: 3\ntagRows: 2\ntagSize: 0.03\ntagSpacing: 0.3\n";

TEST(BoardCommand, WritesWhatTheNameSays) {
  const ScratchFolder scratch;
  const std::string target = scratch.Write("board.yaml", kTarget);
  for (const auto& [name, begin] : {std::pair<std::string, std::string>{"board.pdf", "%PDF"},
                                    {"board.svg", "<?xml"},
                                    {"board.png", "\x89PNG"}}) {
    const Ended ended =
        RunProgram({"board", "--target", target, "--out", scratch.Path(name), "--dpi", "72"});
    EXPECT_EQ(ended.exit_code, 0) << ended.err;
    EXPECT_NE(ended.out.find("AprilGrid of 2 rows x 3 columns"), std::string::npos) << ended.out;
    EXPECT_TRUE(ContentOf(scratch.Path(name)).starts_with(begin)) << name;
  }
}

TEST(BoardCommand, RefusesOtherNamesAndBadTargetsAndWritesNothing) {
  const ScratchFolder scratch;
  const auto refused = [&](const std::string& content, const std::string& name) {
    const std::string target = scratch.Write("board.yaml", content);
    const Ended ended = RunProgram({"board", "--target", target, "--out", scratch.Path(name)});
    EXPECT_EQ(ended.exit_code, 2);
    EXPECT_FALSE(std::filesystem::exists(scratch.Path(name)));
    return ended.err;
  };
  EXPECT_NE(refused(kTarget, "board.eps").find(".pdf, .svg or .png"), std::string::npos);
  EXPECT_NE(refused(std::string(kTarget) + "tagRows: 3\n", "board.pdf").find("tagRows"),
            std::string::npos);
  EXPECT_NE(
      refused("target_type: 'aprilgrid'\ntagCols: 3\ntagRows: 2\ntagSize: 30\ntagSpacing: 0.3\n",
              "board.pdf")
          .find("in metres"),
      std::string::npos);
}

}  // namespace
}  // namespace calibrato
