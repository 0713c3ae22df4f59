// The page as a browser draws it: what its scripts make of the documents.

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "calibrato/base/files.h"
#include "calibrato/report/documents_for_test.h"
#include "calibrato/report/report.h"

namespace calibrato {
namespace {

class DrawnPage : public ::testing::Test {
 protected:
  void SetUp() override {
    if (std::system("command -v chromium > /dev/null") != 0) {
      GTEST_SKIP() << "chromium is not installed: what the page draws goes unchecked";
    }
    folder_ = std::filesystem::temp_directory_path() /
              ("calibrato_browser_test_" + std::to_string(getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  // The page's markup after its scripts have run, with what they wrote to the console in front.
  std::string Draw(const std::vector<Value>& documents) const {
    const std::string page = folder_ / "page.html";
    WriteFileAtomically(page, ReportHtml("A report", documents));
    const std::string command =
        "chromium --headless --no-sandbox --disable-gpu --disable-quic --no-first-run "
        "--disable-background-networking --disable-component-update --disable-sync "
        "--user-data-dir='" +
        std::string(folder_ / "profile") +
        "' --window-size=1280,1000 --virtual-time-budget=60000 --enable-unsafe-swiftshader "
        "--enable-logging=stderr --v=0 --dump-dom 'file://" +
        page + "' 2> '" + std::string(folder_ / "console.txt") + "'";
    std::string drawn;
    FILE* pipe = popen(command.c_str(), "r");
    if (pipe == nullptr) return drawn;
    char buffer[65536];
    while (const size_t size = fread(buffer, 1, sizeof buffer, pipe)) drawn.append(buffer, size);
    pclose(pipe);
    // The parts that were handed to the browser are no news.
    for (size_t open = drawn.find("<script"); open != std::string::npos;
         open = drawn.find("<script")) {
      drawn.erase(open, drawn.find("</script>", open) + 9 - open);
    }
    return drawn;
  }
  std::string Console() const { return ReadFile(folder_ / "console.txt"); }

 private:
  std::filesystem::path folder_;
};

testing::AssertionResult Says(const std::string& drawn, const std::string& words) {
  if (drawn.find(words) != std::string::npos) return testing::AssertionSuccess();
  return testing::AssertionFailure() << "the page does not say: " << words;
}

TEST_F(DrawnPage, DrawsEveryPartOfEveryKind) {
  const std::string drawn =
      Draw({CameraDocumentForTest(), CameraImuDocumentForTest(), CheckDocumentForTest(),
            NoiseDocumentForTest(), LearnDocumentForTest(), Table1DocumentForTest(),
            ParetoDocumentForTest(), CameraImuDiffDocumentForTest(), MergeDocumentForTest()});
  EXPECT_TRUE(Says(drawn, "data-state=\"drawn\""));
  EXPECT_FALSE(Says(drawn, "plot-failed"));
  EXPECT_FALSE(Says(drawn, "class=\"empty\""));
  EXPECT_TRUE(Says(drawn, "Usable, with the reservations below."));
  EXPECT_TRUE(Says(drawn, "the board's size varies little"));
  // Of two cameras, each with its own pictures; the second is drawn by angles.
  EXPECT_TRUE(Says(drawn, "Baseline 83.03"));
  EXPECT_TRUE(Says(drawn, "How far the lens moves a point"));
  EXPECT_TRUE(Says(drawn, "What the lens does to angles"));
  EXPECT_TRUE(Says(drawn, "At 1.2 m: median 0.075 px, worst 0.3 px."));
  EXPECT_TRUE(Says(drawn, "left26.jpg (7.1 px)"));
  EXPECT_TRUE(Says(drawn, "The recording does not determine the result."));
  EXPECT_TRUE(Says(drawn, "translation along y is not observable"));
  EXPECT_TRUE(Says(drawn, "gyroscope residuals 1.1 times the stated noise"));
  EXPECT_TRUE(Says(drawn, "This recording can be calibrated with; it could be better."));
  EXPECT_TRUE(Says(drawn, "record 15 s more, rotate about x"));
  EXPECT_TRUE(Says(drawn, "1, longest 0.43 s"));
  EXPECT_TRUE(Says(drawn, "Where cam0 saw corners"));
  EXPECT_TRUE(Says(drawn, "below 0.00003 (95 %)"));
  EXPECT_TRUE(Says(drawn, "Best return 2.318 over 300 episodes."));
  EXPECT_TRUE(Says(drawn, "Errors of both networks"));
  EXPECT_TRUE(Says(drawn, "Convergence of the search"));
  EXPECT_TRUE(Says(drawn, "reward loss not finite: back to episode 150"));
  EXPECT_TRUE(Says(drawn,
                   "learned has 0.55 times the error of handcrafted (95 % interval 0.495 to "
                   "0.605), over 40 rigs: better, and more than chance."));
  EXPECT_TRUE(Says(drawn,
                   "learned at random's path has 0.31 times the error of random (95 % interval "
                   "0.26 to 0.358), over 40 rigs: better, and more than chance."));
  EXPECT_TRUE(Says(drawn, "3 rows of 60 trials, of which 3 failed."));
  EXPECT_TRUE(Says(drawn, "Extrinsic error against path"));
  EXPECT_TRUE(Says(drawn, "The motions, played"));
  EXPECT_TRUE(Says(drawn, "The learned motion, played"));
  EXPECT_TRUE(Says(drawn, "0.0 of 20 s"));
  EXPECT_TRUE(Says(drawn, "The two results differ, and by more than chance."));
  EXPECT_TRUE(Says(drawn, "Cam0: 0.163 px at 1 rad/s."));
  EXPECT_TRUE(Says(drawn, "3 recordings lie further apart than their covariances say."));
  EXPECT_TRUE(Says(drawn, "Cam0 lens: sigmas times 2.12."));
  // Every plot can be taken along.
  EXPECT_TRUE(Says(drawn, "<div class=\"save\"><button type=\"button\">CSV</button>"));
  const std::string console = Console();
  EXPECT_FALSE(Says(console, "Uncaught")) << console;
  EXPECT_FALSE(Says(console, "Content Security Policy")) << console;
}

// One page with everything that can be wrong, since a browser takes its time to start.
TEST_F(DrawnPage, SaysInWordsWhatItCannotDraw) {
  Value finding = Value::Object();
  finding.Set("severity", "warn").Set("what", "</script><b id=\"evil\">bold</b>");
  Value camera = Value::Object();
  camera.Set("kind", "camera")
      .Set("verdict", "fail")
      .Set("findings", Value::Array().Append(finding));
  Value broken = Value::Object();
  broken.Set("kind", "camera").Set("cameras", Value::Array().Append(Value()));
  const std::string drawn =
      Draw({Value::Object().Set("kind", "horoscope").Set("luck", 7), camera,
            Value::Object().Set("kind", "learn"), broken, Value::Object().Set("kind", "table1"),
            Value::Object().Set("kind", "camera-imu"), Value::Object().Set("kind", "diff"),
            Value::Object().Set("kind", "check"), Value::Object().Set("kind", "noise"),
            Value::Object().Set("kind", "rivals"), Value::Object().Set("kind", "evaluation"),
            Value::Object().Set("kind", "merge")});
  EXPECT_TRUE(Says(drawn, "data-state=\"drawn\""));
  EXPECT_FALSE(Says(drawn, "undefined"));
  EXPECT_TRUE(Says(drawn, "This page cannot draw results of kind “horoscope”."));
  EXPECT_TRUE(Says(drawn, "\"luck\": 7"));
  EXPECT_TRUE(Says(drawn, "Do not use this calibration."));
  EXPECT_TRUE(Says(drawn, "No camera was calibrated."));
  EXPECT_TRUE(Says(drawn, "No episode of the training was handed over."));
  EXPECT_TRUE(Says(drawn, "This part could not be drawn"));
  EXPECT_TRUE(Says(drawn, "Nothing was compared."));
  EXPECT_TRUE(Says(drawn, "There is no estimate."));
  EXPECT_TRUE(Says(drawn, "No camera was compared."));
  EXPECT_TRUE(Says(drawn, "Nothing was merged."));
  EXPECT_FALSE(Says(drawn, "<b id="));
  EXPECT_TRUE(Says(drawn, "&lt;b id="));
}

}  // namespace
}  // namespace calibrato
