// The page as a browser draws it, on a desk and on a phone.

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "calibrato/base/value.h"
#include "calibrato/guide/guide_document.h"
#include "calibrato/guide/guide_page.h"
#include "calibrato/report/report.h"

namespace calibrato {
namespace {

GuideSnapshot Snapshot() {
  GuideSnapshot snapshot;
  snapshot.elapsed_s = 12.3;
  snapshot.num_frames = 246;
  snapshot.num_views = 240;
  snapshot.num_imu_samples = 2460;
  Gesture gesture;
  gesture.name = "turn about y";
  gesture.words = "Turn the camera left and right";
  gesture.turn = {0.0, 0.2, 0.0};
  gesture.duration_s = 8.0;
  snapshot.gesture = gesture;
  snapshot.gesture_left_s = 5.2;
  snapshot.next_words = "Push it towards the board and back";
  snapshot.ghost = {{100, 100}, {300, 110}, {290, 260}, {110, 250}};
  snapshot.arrow = {{200, 180}, {260, 200}};
  snapshot.progress = {{"fu", "px", 0.8, 1.2}, {"rot_x", "rad", 1.745e-3, 8.7e-4}};
  snapshot.is_measured = true;
  snapshot.coverage = {0.5, 0.25, 1.0, 0.8};
  snapshot.warnings = {"blurred: move slower, or shorten the exposure"};
  snapshot.time_left_s = 17.2;
  return snapshot;
}

class DrawnGuide : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    if (std::system("command -v chromium > /dev/null") != 0) {
      GTEST_SKIP() << "chromium is not installed: what the page draws goes unchecked";
    }
  }
  // The page's markup once its script has shown the state.
  std::string Draw(const Value& state, const std::string& report = "<p>") const {
    const GuidePage page("127.0.0.1", 0,
                         {[&] { return ToJsonLine(state); }, [] { return std::string(); },
                          [&] { return report; }, [] {}},
                         [](const std::string&) {});
    const std::filesystem::path profile =
        std::filesystem::temp_directory_path() / ("calibrato_guide_" + std::to_string(getpid()));
    const std::string command =
        "chromium --headless --no-sandbox --disable-gpu --disable-quic --no-first-run "
        "--disable-background-networking --disable-component-update --disable-sync "
        "--user-data-dir='" +
        profile.string() + "' --window-size=" + GetParam() +
        " --virtual-time-budget=1500 --dump-dom http://127.0.0.1:" + std::to_string(page.port()) +
        "/ 2> /dev/null";
    std::string drawn;
    FILE* pipe = popen(command.c_str(), "r");
    if (pipe == nullptr) return drawn;
    char buffer[65536];
    while (const size_t size = fread(buffer, 1, sizeof buffer, pipe)) drawn.append(buffer, size);
    pclose(pipe);
    std::filesystem::remove_all(profile);
    return drawn.substr(0, drawn.find("<script"));
  }
};

testing::AssertionResult Says(const std::string& drawn, const std::string& words) {
  if (drawn.find(words) != std::string::npos) return testing::AssertionSuccess();
  return testing::AssertionFailure() << "the page does not say: " << words << "\n" << drawn;
}

TEST_P(DrawnGuide, SaysWhatToDoAndHowFarItIs) {
  const std::string drawn = Draw(GuideDocument(Snapshot(), {}, {640, 480}));
  EXPECT_TRUE(Says(drawn, "data-state=\"capturing\""));
  EXPECT_TRUE(Says(drawn, "Turn the camera left and right"));
  EXPECT_TRUE(Says(drawn, "turn about y, 11 degrees to either side"));
  EXPECT_TRUE(Says(drawn, "5 s to go"));
  EXPECT_TRUE(Says(drawn, "Then: Push it towards the board and back"));
  EXPECT_TRUE(Says(drawn, "blurred: move slower"));
  EXPECT_TRUE(Says(drawn, "\u00b10.80 of 1.20 px"));
  EXPECT_TRUE(Says(drawn, "class=\"bar good\""));
  EXPECT_TRUE(Says(drawn, "\u00b10.100 of 0.050 \u00b0"));
  EXPECT_TRUE(Says(drawn, "about 18 s left"));
  EXPECT_TRUE(Says(drawn, "240 of 246 frames with the board"));
}

TEST_P(DrawnGuide, LeadsToTheReportInTheEnd) {
  GuideSnapshot snapshot = Snapshot();
  snapshot.ended = "all that is wanted is reached";
  const std::string drawn =
      Draw(GuideDocument(snapshot, {"done", "calibrated", true, 12.0}, {640, 480}));
  EXPECT_TRUE(Says(drawn, "data-state=\"done\""));
  EXPECT_TRUE(Says(drawn, "all that is wanted is reached: calibrated"));
  EXPECT_TRUE(Says(drawn, "<a class=\"report\" id=\"report\" href=\"/report\">"));
  EXPECT_TRUE(Says(drawn, "<button id=\"end\" type=\"button\" hidden"));
}

// Whatever the live solves said, or where none of them succeeded.
TEST_P(DrawnGuide, ShowsTheSigmasOfTheCalibrationInTheEnd) {
  GuideSnapshot snapshot = Snapshot();
  snapshot.ended = "ended on the page";
  snapshot.is_measured = false;
  snapshot.progress.push_back({"pos_x", "m", 0.2, 0.002});
  const Value document = GuideDocument(snapshot, {"done", "calibrated", true, 12.0}, {640, 480});
  Value covariance = Value::Object();
  covariance.Set("names", Value::Array().Append("cam0.rot_x").Append("cam0.fu"))
      .Set("matrix", Value::Array()
                         .Append(Value::Array().Append(1.21e-6).Append(1e-9))
                         .Append(Value::Array().Append(1e-9).Append(0.09)));
  Value result = Value::Object();
  result.Set("kind", "camera-imu").Set("covariance", std::move(covariance));
  const std::string drawn = Draw(document, ReportHtml("Camera-IMU calibration", {result}));
  EXPECT_TRUE(Says(drawn, "How well it is known, as calibrated"));
  EXPECT_TRUE(Says(drawn, "\u00b10.30 of 1.20 px"));
  EXPECT_TRUE(Says(drawn, "\u00b10.063 of 0.050 \u00b0"));
  // Of what the result has no sigma.
  EXPECT_TRUE(Says(drawn, "\u00b1? of 2.00 mm"));
}

INSTANTIATE_TEST_SUITE_P(OnADeskAndOnAPhone, DrawnGuide, testing::Values("1280,900", "390,844"));

}  // namespace
}  // namespace calibrato
