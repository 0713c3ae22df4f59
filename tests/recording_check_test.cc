// `calibrato check` on recordings with one thing wrong with them each, and on good ones: every
// finding is named, and none is invented.

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>
#include <vector>

#include "broken_recordings.h"
#include "calibrato/base/files.h"
#include "calibrato/base/value.h"
#include "calibrato/cli/program_for_test.h"

namespace calibrato {

static void PrintTo(const BrokenRecording& broken, std::ostream* stream) { *stream << broken.name; }

namespace {

struct Checked {
  int exit_code = -1;
  std::string verdict;
  std::vector<std::string> problems;  ///< What of the findings that are a warning or worse.
};

Checked Check(const std::string& folder) {
  const Ended ended =
      RunProgram({"check", folder, "--target", folder + "/target.yaml", "--cameras",
                  folder + "/camchain.yaml", "--imu", folder + "/imu.yaml", "--json"});
  EXPECT_EQ(ended.signal, 0) << ended.err;
  const Value result = ParseJson(ended.out, "result.json");
  Checked checked{ended.exit_code, result.At("verdict").AsString(), {}};
  for (const Value& finding : result.At("findings").elements()) {
    if (finding.At("severity").AsString() == "info") continue;
    checked.problems.push_back(finding.At("what").AsString());
  }
  return checked;
}

Checked Check(const PlainRecording& recording) {
  const ScratchFolder scratch;
  OutputFolder out(scratch.Path("recording"));
  for (auto& [name, content] : FilesOf(recording)) out.Add(name, content);
  out.Commit();
  return Check(out.path());
}

void ExpectNothing(const Checked& checked) {
  EXPECT_EQ(checked.exit_code, 0);
  EXPECT_EQ(checked.verdict, "pass");
  for (const std::string& problem : checked.problems) ADD_FAILURE() << "invented: " << problem;
}

TEST(RecordingCheck, FindsNothingInCleanRecordings) {
  ExpectNothing(Check(CleanCorners()));
  ExpectNothing(Check(CleanImages()));
}

// Forty seconds of EuRoC's rig, two cameras.
TEST(RecordingCheck, FindsNothingInEuroc) {
  const char* data = std::getenv("CALIBRATO_DATA");
  if (data == nullptr) GTEST_SKIP() << "needs CALIBRATO_DATA";
  const std::string folder = std::string(data) + "/euroc_imu_april";
  const Ended ended =
      RunProgram({"check", folder, "--target", folder + "/target.yaml", "--cameras",
                  folder + "/camchain.yaml", "--imu", folder + "/imu0.yaml", "--json"});
  const Value result = ParseJson(ended.out, "result.json");
  EXPECT_EQ(ended.exit_code, 0);
  EXPECT_EQ(result.At("findings").size(), 0U) << ToJson(result.At("findings"));
}

// A recording that can't be calibrated right is not calibrated: the same findings, without a
// camera.
TEST(RecordingCheck, SharesItsFindingsWithTheCalibration) {
  int num_tried = 0;
  for (const BrokenRecording& broken : BrokenRecordings()) {
    if (broken.name != "clock-set-forward" && broken.name != "clock-set-back") continue;
    ++num_tried;
    const ScratchFolder scratch;
    OutputFolder out(scratch.Path("recording"));
    for (auto& [name, content] : FilesOf(broken.make())) out.Add(name, content);
    out.Commit();
    const std::string& folder = out.path();
    const Ended ended =
        RunProgram({"calibrate", "camera-imu", folder, "--cameras", folder + "/camchain.yaml",
                    "--imu", folder + "/imu.yaml", "--json", "--out", scratch.Path("out")});
    EXPECT_EQ(ended.exit_code, 1) << ended.err;
    const Value result = ParseJson(ended.out, "stdout");
    EXPECT_EQ(result.Find("cameras"), nullptr);
    EXPECT_NE(ended.out.find("moved against each other"), std::string::npos) << broken.name;
  }
  EXPECT_EQ(num_tried, 2);
}

class BrokenRecordingCheck : public testing::TestWithParam<BrokenRecording> {};

TEST_P(BrokenRecordingCheck, NamesWhatIsWrongAndNothingElse) {
  const BrokenRecording& broken = GetParam();
  const Checked checked = Check(broken.make());
  EXPECT_NE(checked.verdict, "pass");
  const auto has = [](const std::string& problem, const std::string& words) {
    return problem.find(words) != std::string::npos;
  };
  for (const std::string& words : broken.findings) {
    bool is_named = false;
    for (const std::string& problem : checked.problems) is_named |= has(problem, words);
    EXPECT_TRUE(is_named) << "missed: " << words;
  }
  for (const std::string& problem : checked.problems) {
    bool is_expected = false;
    for (const std::string& words : broken.findings) is_expected |= has(problem, words);
    EXPECT_TRUE(is_expected) << "invented: " << problem;
  }
}

INSTANTIATE_TEST_SUITE_P(All, BrokenRecordingCheck, testing::ValuesIn(BrokenRecordings()),
                         [](const auto& info) {
                           std::string name;
                           for (const char c : info.param.name) {
                             name += c == '-' ? '_' : c;
                           }
                           return name;
                         });

}  // namespace
}  // namespace calibrato
