// `calibrato check` and `calibrato noise`, as their users run them. What they find in broken
// recordings is tested in tests/recording_check_test.cc.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <random>
#include <sstream>
#include <string>

#include "calibrato/base/value.h"
#include "calibrato/cli/program_for_test.h"

namespace calibrato {
namespace {

namespace fs = std::filesystem;

using testing::AllOf;
using testing::HasSubstr;

// A simulated recording of corners and an IMU, with the camera chain beside it.
class CheckCommand : public testing::Test {
 protected:
  CheckCommand() {
    const std::string rig = scratch_.Write("rig.yaml", RigYaml());
    const Ended made =
        RunProgram({"simulate", "--rig", rig, "--motion",
                    scratch_.Write("motion.yaml", MotionYaml(0.05)), "--out", recording_});
    EXPECT_EQ(made.exit_code, 0) << made.err;
    Value chain = Value::Object();
    chain.Set("cam0", ReadYaml(rig).At("cameras").At("cam0"));
    (void)scratch_.Write("camchain.yaml", ToYaml(chain));
  }

  Ended Check(const Arguments& more = {}) const {
    Arguments arguments = {"check", recording_};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunProgram(arguments);
  }

  ScratchFolder scratch_;
  std::string recording_ = scratch_.Path("recording");
};

TEST_F(CheckCommand, WritesAResultAPageAndTimes) {
  const Ended ended = Check({"--cameras", scratch_.Path("camchain.yaml"), "--imu",
                             recording_ + "/imu.yaml", "--out", scratch_.Path("out")});
  EXPECT_EQ(ended.signal, 0);
  EXPECT_THAT(ended.out, AllOf(HasSubstr("imu0 gyroscope"), HasSubstr("expected sigma"),
                               HasSubstr("verdict: ")));
  const Value result = ReadJson(scratch_.Path("out/result.json"));
  EXPECT_EQ(result.At("kind").AsString(), "check");
  const std::string verdict = result.At("verdict").AsString();
  EXPECT_EQ(ended.exit_code, verdict == "pass" || verdict == "warn" ? 0 : 1);
  EXPECT_EQ(result.At("streams").size(), 3U);
  EXPECT_EQ(result.At("expected").size(), 7U);
  EXPECT_TRUE(fs::exists(scratch_.Path("out/report.html")));
  EXPECT_NE(ReadJson(scratch_.Path("out/timing.json")).Find("check_s"), nullptr);
}

TEST_F(CheckCommand, WithoutOutItPrintsAndWritesNothing) {
  const auto before = FilesBelow(scratch_.Path("."));
  const Ended ended = Check({"--json"});
  EXPECT_EQ(ParseJson(ended.out, "stdout").At("kind").AsString(), "check");
  EXPECT_EQ(FilesBelow(scratch_.Path(".")), before);
}

TEST_F(CheckCommand, TakesCamerasAlone) {
  fs::remove(recording_ + "/imu0.csv");
  const Value result = ParseJson(Check({"--json"}).out, "stdout");
  EXPECT_EQ(result.At("streams").size(), 1U);
  EXPECT_EQ(result.At("boards").size(), 1U);
}

TEST_F(CheckCommand, TakesAnImuAlone) {
  fs::remove(recording_ + "/cam0_corners.csv");
  const Ended ended = Check({"--json"});
  const Value result = ParseJson(ended.out, "stdout");
  EXPECT_EQ(result.At("streams").size(), 2U);
  EXPECT_EQ(result.At("boards").size(), 0U);
  EXPECT_THAT(ended.out, HasSubstr("the IMU alone is checked, since there are no cameras"));
  // Where cameras were asked for, their absence is an error.
  const Ended asked = Check({"--cameras", scratch_.Path("camchain.yaml")});
  EXPECT_EQ(asked.exit_code, 2);
}

TEST_F(CheckCommand, LooksAtAPartOfARecording) {
  const Value whole = ParseJson(Check({"--json"}).out, "stdout");
  const Value part = ParseJson(Check({"--json", "--from", "1", "--to", "2.95"}).out, "stdout");
  EXPECT_EQ(part.At("streams").elements()[0].At("num").AsInt(), 20);
  EXPECT_LT(part.At("streams").elements()[1].At("num").AsInt(),
            whole.At("streams").elements()[1].At("num").AsInt());
}

TEST_F(CheckCommand, RefusesInOneLine) {
  const auto refused = [&](const Arguments& more, const std::string& what) {
    const Ended ended = Check(more);
    EXPECT_EQ(ended.exit_code, 2);
    EXPECT_THAT(ended.err, HasSubstr(what));
    EXPECT_EQ(std::count(ended.err.begin(), ended.err.end(), '\n'), 1) << ended.err;
  };
  const std::string imu = recording_ + "/imu.yaml";
  refused({"--imu", imu, "--imu", imu}, "wrong number of --imu");
  refused({"--images", "*.png"}, "no image matches '*.png'");
  refused({"--target", scratch_.Path("absent.yaml")}, "absent.yaml");
  const Ended absent = RunProgram({"check", scratch_.Path("absent")});
  EXPECT_EQ(absent.exit_code, 2);
}

// 40 s at 100 Hz of white noise about a mean.
std::string LogAtRest(double gyro_stddev, double accel_stddev) {
  std::mt19937_64 generator(7);
  // Sums of twelve are normal enough, and the same with every standard library.
  const auto normal = [&] {
    double sum = -6.0;
    for (int k = 0; k < 12; ++k) sum += static_cast<double>(generator() >> 11) * 0x1p-53;
    return sum;
  };
  std::ostringstream text;
  text.precision(12);
  text << "timestamp,w_x,w_y,w_z,a_x,a_y,a_z\n";
  for (int64_t k = 0; k < 4000; ++k) {
    text << 1'600'000'000'000'000'000 + k * 10'000'000;
    for (int axis = 0; axis < 3; ++axis) text << ',' << 0.01 + gyro_stddev * normal();
    for (int axis = 0; axis < 3; ++axis) text << ',' << 5.6 + accel_stddev * normal();
    text << '\n';
  }
  return text.str();
}

TEST(NoiseCommand, WritesKalibrsYamlAndAPageBesideIt) {
  const ScratchFolder scratch;
  (void)scratch.Write("log/imu0.csv", LogAtRest(1e-3, 2e-2));
  const std::string out = scratch.Path("my.yaml");
  const Ended ended = RunProgram({"noise", scratch.Path("log"), "--out", out});
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  const Value yaml = ReadYaml(out);
  EXPECT_EQ(yaml.At("rostopic").AsString(), "/imu0");
  EXPECT_NEAR(yaml.At("update_rate").AsDouble(), 100.0, 0.01);
  // A standard deviation over the root of the rate.
  EXPECT_NEAR(yaml.At("gyroscope_noise_density").AsDouble(), 1e-4, 1e-5);
  EXPECT_NEAR(yaml.At("accelerometer_noise_density").AsDouble(), 2e-3, 2e-4);
  EXPECT_GT(yaml.At("gyroscope_random_walk").AsDouble(), 0.0);
  EXPECT_TRUE(fs::exists(scratch.Path("my.html")));
  EXPECT_THAT(ended.err, HasSubstr("warning: imu0 gyroscope: the log of 40 s is too short to show "
                                   "its random walk of the bias"));
  EXPECT_THAT(ended.out, AllOf(HasSubstr("noise density"), HasSubstr("my.html")));
}

TEST(NoiseCommand, RefusesInOneLineAndWritesNothing) {
  const ScratchFolder scratch;
  (void)scratch.Write("log/imu0.csv", "timestamp,w_x,w_y,w_z,a_x,a_y,a_z\n1,0,0,0,0,0,9\n");
  const Ended ended = RunProgram({"noise", scratch.Path("log"), "--out", scratch.Path("a.yaml")});
  EXPECT_EQ(ended.exit_code, 2);
  EXPECT_THAT(ended.err, HasSubstr("error: too short a log, imu0 gyroscope"));
  EXPECT_FALSE(fs::exists(scratch.Path("a.yaml")));
  EXPECT_FALSE(fs::exists(scratch.Path("a.html")));
  const Ended nowhere =
      RunProgram({"noise", scratch.Path("log"), "--out", scratch.Path("absent/a.yaml")});
  EXPECT_EQ(nowhere.exit_code, 2);
  EXPECT_THAT(nowhere.err, HasSubstr("error: no such folder"));
  const Ended page = RunProgram({"noise", scratch.Path("log"), "--out", scratch.Path("a.html")});
  EXPECT_EQ(page.exit_code, 2);
  EXPECT_THAT(page.err, HasSubstr("give a file that ends in .yaml"));
}

}  // namespace
}  // namespace calibrato
