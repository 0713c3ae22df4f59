// What is wrong with a recording of a camera and an IMU, as a user learns it from the program: each
// defect is put into a good simulated recording, and the words of its finding are asked for.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "calibrato/base/value.h"
#include "calibrato/cli/program_for_test.h"

namespace calibrato {
namespace {

using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

constexpr double kGravity = 9.80665;
constexpr std::array<double, 6> kStill = {0, 0, 0, 0, 0, 0};
using Loop = std::array<std::array<double, 6>, 6>;  // Rows: x y z roll pitch yaw.

// All six degrees of freedom, two loops.
constexpr std::array<Loop, 2> kGoodLoops = {Loop{{{0, 0.02, 0.04, 0.01, 0, 0.015},
                                                  {0.02, 0, 0, 0.05, 0.01, 0},
                                                  {0, 0.05, 0.02, 0, 0, 0.015},
                                                  {0, -0.08, 0.05, 0.02, 0, 0.04},
                                                  {0.03, 0.05, 0, 0.1, 0.03, 0},
                                                  {0, 0.08, 0.06, 0, 0, 0.05}}},
                                            Loop{{{0.02, 0.01, 0, 0.04, 0.015, 0},
                                                  {0, 0.03, 0.05, 0, 0, 0.012},
                                                  {0.02, 0, 0, 0.03, 0.013, 0},
                                                  {0.05, 0.02, 0, -0.08, 0.04, 0},
                                                  {0, 0.08, 0.08, 0, 0, 0.035},
                                                  {0.02, 0, 0, 0.1, 0.05, 0}}}};

// The good motion with some degrees of freedom alone.
std::string MotionOf(const std::vector<size_t>& moving) {
  std::ostringstream text;
  text << "carrier: free\nbase_pose:\n  xyz_m: [0.4, 0.3, 0.47]\n  rpy_rad: [1.5708, 0.8, "
          "1.5708]\nloops:\n";
  for (const Loop& loop : kGoodLoops) {
    text << "  - duration_s: 5.0\n    coefficients: [";
    int written = 0;
    for (size_t row = 0; row < 6; ++row) {
      const bool moves = std::find(moving.begin(), moving.end(), row) != moving.end();
      for (const double coefficient : moves ? loop[row] : kStill) {
        text << coefficient << (++written == 36 ? "]\n" : ", ");
      }
    }
  }
  return text.str();
}

struct ImuRow {
  int64_t stamp_ns;
  std::array<double, 6> value;  // Rates, then forces.
};

// A recording as a user has it: files. Defects are put into it one at a time.
class DataProblems : public testing::Test {
 protected:
  DataProblems() { Record({0, 1, 2, 3, 4, 5}); }

  void Record(const std::vector<size_t>& moving) {
    const std::string rig = scratch_.Write("rig.yaml", RigYaml());
    (void)scratch_.Write("motion.yaml", MotionOf(moving));
    const Ended made = RunProgram({"simulate", "--rig", rig, "--motion",
                                   scratch_.Path("motion.yaml"), "--out", recording_, "--force"});
    ASSERT_EQ(made.exit_code, 0) << made.err;
    Value chain = Value::Object();
    chain.Set("cam0", ReadYaml(rig).At("cameras").At("cam0"));
    (void)scratch_.Write("camchain.yaml", ToYaml(chain));
    imu_.clear();
    std::istringstream lines(ContentOf(recording_ + "/imu0.csv"));
    std::getline(lines, imu_header_);
    for (std::string line; std::getline(lines, line);) {
      std::replace(line.begin(), line.end(), ',', ' ');
      std::istringstream words(line);
      ImuRow row{};
      words >> row.stamp_ns;
      for (double& x : row.value) words >> x;
      imu_.push_back(row);
    }
    corners_ = ContentOf(recording_ + "/cam0_corners.csv");
  }

  void WriteImu() const {
    std::ostringstream text;
    text.precision(17);
    text << imu_header_ << "\n";
    for (const ImuRow& row : imu_) {
      text << row.stamp_ns;
      for (const double x : row.value) text << "," << x;
      text << "\n";
    }
    (void)scratch_.Write("recording/imu0.csv", text.str());
  }
  void ForEachSample(const std::function<void(ImuRow*)>& change) {
    for (ImuRow& row : imu_) change(&row);
    WriteImu();
  }
  // Keeps the corners of one image in so many.
  void KeepImages(int one_in) const {
    std::istringstream lines(corners_);
    std::string text;
    std::string line;
    std::getline(lines, line);
    text = line + "\n";
    std::string stamp;
    for (int image = -1; std::getline(lines, line);) {
      const std::string of_line = line.substr(0, line.find(','));
      if (of_line != stamp) ++image;
      stamp = of_line;
      if (one_in > 0 && image % one_in == 0) text += line + "\n";
    }
    (void)scratch_.Write("recording/cam0_corners.csv", text);
  }

  // The result document; it must be one, whatever is wrong with the data.
  Value Calibrate(int expected_exit) const {
    const Ended ended =
        RunProgram({"calibrate", "camera-imu", recording_, "--cameras",
                    scratch_.Path("camchain.yaml"), "--target", recording_ + "/target.yaml",
                    "--imu", recording_ + "/imu.yaml", "--json", "--out", scratch_.Path("out")});
    EXPECT_EQ(ended.signal, 0) << ended.err;
    const Value result = ParseJson(ended.out, "result.json");
    EXPECT_EQ(ended.exit_code, expected_exit) << ended.err << FindingsOf(result);
    return result;
  }

  // "severity: what | remedy" a line.
  static std::string FindingsOf(const Value& result) {
    std::string text;
    for (const Value& finding : result.At("findings").elements()) {
      text += finding.At("severity").AsString() + ": " + finding.At("what").AsString() + " | " +
              finding.At("remedy").AsString() + "\n";
    }
    return text;
  }

  // A result that has been saved from the defect: as far from the truth as a good one.
  static void ExpectRight(const Value& result, double offset_s = 0.0) {
    const Value& camera = result.At("cameras").elements()[0];
    const std::vector<double> T_c_i = camera.At("T_cam_imu").AsDoubles(16);
    EXPECT_NEAR(T_c_i[3], 0.06, 2e-3);
    EXPECT_NEAR(T_c_i[7], 0.0, 2e-3);
    EXPECT_NEAR(T_c_i[11], -0.1, 2e-3);
    // The rotation is a quarter turn about z.
    EXPECT_NEAR(T_c_i[1], -1.0, 1e-3);
    EXPECT_NEAR(T_c_i[2], 0.0, 2e-3);
    EXPECT_NEAR(T_c_i[6], 0.0, 2e-3);
    EXPECT_NEAR(camera.At("time_offset_s").AsDouble(), offset_s, 2e-4);
  }
  // Without cameras there is no result.
  static void ExpectNoResult(const Value& result) {
    EXPECT_EQ(result.Find("cameras"), nullptr);
    EXPECT_EQ(result.At("verdict").AsString(), "fail");
  }

  ScratchFolder scratch_;
  std::string recording_ = scratch_.Path("recording");
  std::string imu_header_;
  std::vector<ImuRow> imu_;
  std::string corners_;
};

TEST_F(DataProblems, NoneInAGoodRecording) {
  const Value result = Calibrate(0);
  EXPECT_EQ(result.At("verdict").AsString(), "pass");
  EXPECT_EQ(FindingsOf(result), "");
  ExpectRight(result);
}

TEST_F(DataProblems, NoMotion) {
  Record({});
  const Value result = Calibrate(1);
  ExpectNoResult(result);
  EXPECT_THAT(FindingsOf(result), AllOf(HasSubstr("fail: imu0 did not move: its rates vary by "),
                                        HasSubstr("about all three axes")));
}

TEST_F(DataProblems, PureTranslation) {
  Record({0, 1, 2});
  const Value result = Calibrate(1);
  ExpectNoResult(result);
  EXPECT_THAT(FindingsOf(result), AllOf(HasSubstr("fail: imu0 moved but did not turn"),
                                        HasSubstr("turn the rig to and fro")));
}

// Rotation alone tells all: the board is seen to move, and gravity turns in the accelerometer.
TEST_F(DataProblems, PureRotationIsEnough) {
  Record({3, 4, 5});
  const Value result = Calibrate(0);
  EXPECT_EQ(result.At("verdict").AsString(), "pass");
  ExpectRight(result);
}

TEST_F(DataProblems, RotationAboutOneAxis) {
  Record({4});
  const Value result = Calibrate(1);
  EXPECT_EQ(result.At("verdict").AsString(), "inconclusive");
  EXPECT_THAT(FindingsOf(result),
              AllOf(HasSubstr("inconclusive: imu0 turned about one axis only, ["),
                    HasSubstr("inconclusive: cam0: the rotation about z"), Not(HasSubstr("fail"))));
  // What the motion does tell is told.
  const Value& verdicts = result.At("cameras").elements()[0].At("verdicts");
  EXPECT_EQ(verdicts.At("rotation").elements()[2].AsString(), "inconclusive");
  EXPECT_EQ(verdicts.At("translation").elements()[2].AsString(), "inconclusive");
  EXPECT_EQ(verdicts.At("time_offset").AsString(), "pass");
}

TEST_F(DataProblems, GapsOfTheImu) {
  imu_.erase(imu_.begin() + 1400, imu_.begin() + 1430);
  imu_.erase(imu_.begin() + 600, imu_.begin() + 700);
  WriteImu();
  const Value result = Calibrate(0);
  for (const char* sensor : {"gyroscope", "accelerometer"}) {
    EXPECT_THAT(FindingsOf(result), HasSubstr("warn: imu0 " + std::string(sensor) +
                                              ": 2 gaps, the longest 0.505 s after the stamp " +
                                              std::to_string(imu_[599].stamp_ns)));
  }
  ExpectRight(result);
}

TEST_F(DataProblems, DuplicatedStamps) {
  for (const int k : {501, 500, 100}) imu_.insert(imu_.begin() + k, imu_[static_cast<size_t>(k)]);
  WriteImu();
  const Value result = Calibrate(0);
  EXPECT_THAT(FindingsOf(result),
              HasSubstr("warn: imu0 gyroscope: 3 of 2003 samples repeat the stamp of another"));
  ExpectRight(result);
}

TEST_F(DataProblems, UnsortedStamps) {
  std::swap(imu_[300], imu_[302]);
  std::reverse(imu_.begin() + 900, imu_.begin() + 905);
  WriteImu();
  const Value result = Calibrate(0);
  EXPECT_THAT(FindingsOf(result), HasSubstr("warn: imu0 accelerometer: 6 of 2000 samples have a "
                                            "stamp earlier than the one before | they are sorted"));
  ExpectRight(result);
}

TEST_F(DataProblems, SamplesThatAreNotNumbers) {
  imu_[777].value[1] = std::nan("");
  imu_[1200].value.fill(std::nan(""));
  imu_[1500].value[4] = HUGE_VAL;
  WriteImu();
  const Value result = Calibrate(0);
  EXPECT_THAT(FindingsOf(result),
              AllOf(HasSubstr("warn: imu0 gyroscope: 2 of 2000 samples are not finite numbers"),
                    HasSubstr("warn: imu0 accelerometer: 2 of 2000 samples are not finite")));
  ExpectRight(result);
}

TEST_F(DataProblems, SaturatedGyroscope) {
  ForEachSample([](ImuRow* row) {
    for (size_t k = 0; k < 3; ++k) row->value[k] = std::clamp(row->value[k], -0.6, 0.6);
  });
  const Value result = Calibrate(0);
  EXPECT_THAT(FindingsOf(result),
              AllOf(HasSubstr("warn: imu0 gyroscope x: "),
                    HasSubstr("stand at the end of its range, 0.6 rad/s | they are left out; move "
                              "more gently")));
  ExpectRight(result);
}

TEST_F(DataProblems, ARateThatIsNotTheYamls) {
  std::vector<ImuRow> half;
  for (size_t k = 0; k < imu_.size(); k += 2) half.push_back(imu_[k]);
  imu_ = half;
  WriteImu();
  const Value result = Calibrate(0);
  EXPECT_THAT(FindingsOf(result),
              HasSubstr("warn: imu0 gyroscope: samples come at 100 Hz, the YAML says 200 Hz | set "
                        "update_rate: 100.0"));
  ExpectRight(result);
}

TEST_F(DataProblems, DegreesAndG) {
  ForEachSample([](ImuRow* row) {
    for (size_t k = 0; k < 3; ++k) row->value[k] *= 180.0 / std::numbers::pi;
    for (size_t k = 3; k < 6; ++k) row->value[k] /= kGravity;
  });
  const Value result = Calibrate(1);
  ExpectNoResult(result);
  EXPECT_THAT(FindingsOf(result), AllOf(HasSubstr("it is in g | multiply the accelerometer's "
                                                  "columns by 9.80665"),
                                        HasSubstr("it is in deg/s | multiply the gyroscope's "
                                                  "columns by 0.0174532925")));
}

TEST_F(DataProblems, SwappedColumns) {
  ForEachSample([](ImuRow* row) {
    for (size_t k = 0; k < 3; ++k) std::swap(row->value[k], row->value[k + 3]);
  });
  const Value result = Calibrate(1);
  ExpectNoResult(result);
  EXPECT_THAT(FindingsOf(result), AllOf(HasSubstr("the gyroscope's columns read 9."),
                                        HasSubstr("swap the columns of gyroscope and")));
}

TEST_F(DataProblems, ClocksASecondApart) {
  ForEachSample([](ImuRow* row) { row->stamp_ns += 1'000'000'000; });
  const Value result = Calibrate(0);
  EXPECT_THAT(FindingsOf(result),
              HasSubstr("warn: the clock of imu0 is 1.00 s ahead of that of cam0"));
  ExpectRight(result, 1.0);
}

TEST_F(DataProblems, ClocksAThousandSecondsApart) {
  ForEachSample([](ImuRow* row) { row->stamp_ns += 1'000'000'000'000; });
  const Value result = Calibrate(1);
  ExpectNoResult(result);
  EXPECT_THAT(FindingsOf(result),
              AllOf(HasSubstr("fail: imu0 gyroscope and cam0 have no time in common: imu0 "
                              "gyroscope begins 1000.000 s after cam0"),
                    HasSubstr("the clock of imu0 is 1000.00 s ahead of that of cam0")));
}

TEST_F(DataProblems, FewerThanTenImages) {
  KeepImages(12);
  const Value result = Calibrate(1);
  ExpectNoResult(result);
  EXPECT_THAT(FindingsOf(result),
              HasSubstr("fail: cam0 saw the board in 9 images only, 10 are needed"));
}

TEST_F(DataProblems, ABoardThatWasNeverSeen) {
  KeepImages(0);
  const Ended ended =
      RunProgram({"calibrate", "camera-imu", recording_, "--cameras",
                  scratch_.Path("camchain.yaml"), "--target", recording_ + "/target.yaml", "--imu",
                  recording_ + "/imu.yaml", "--out", scratch_.Path("out")});
  EXPECT_EQ(ended.exit_code, 2);
  EXPECT_THAT(ended.err, AllOf(HasSubstr("no corners"), HasSubstr("cam0_corners.csv")));
}

// Of a recording that is refused nothing is left that an earlier one wrote.
TEST_F(DataProblems, LeaveNoEarlierResultBesideThem) {
  (void)Calibrate(0);
  EXPECT_NE(ContentOf(scratch_.Path("out/camchain-imucam.yaml")), "");
  (void)scratch_.Write("out/notes.txt", "mine");
  ForEachSample([](ImuRow* row) { row->stamp_ns += 1'000'000'000'000; });
  const Value result = Calibrate(1);
  ExpectNoResult(result);
  EXPECT_EQ(result.At("termination").AsString(), "not tried");
  const std::map<std::string, std::string> files = FilesBelow(scratch_.Path("out"));
  std::vector<std::string> names;
  for (const auto& [name, content] : files) names.push_back(name);
  EXPECT_THAT(names, testing::ElementsAre("notes.txt", "plots.json", "report.html", "result.json",
                                          "timing.json"));
}

// What is not to be trusted says so in the files that others read.
TEST_F(DataProblems, ShowInTheHeadsOfFiles) {
  (void)Calibrate(0);
  EXPECT_THAT(ContentOf(scratch_.Path("out/camchain-imucam.yaml")), Not(HasSubstr("#")));
  Record({4});
  (void)Calibrate(1);
  for (const char* name : {"out/camchain-imucam.yaml", "out/imu.yaml"}) {
    EXPECT_THAT(ContentOf(scratch_.Path(name)),
                testing::StartsWith("# verdict: inconclusive; not to be trusted"));
    EXPECT_GT(ReadYaml(scratch_.Path(name)).size(), 0U);
  }
}

TEST_F(DataProblems, ImagesMoreThanHalfASecondApart) {
  KeepImages(7);
  const Value result = Calibrate(1);
  ExpectNoResult(result);
  EXPECT_THAT(FindingsOf(result),
              AllOf(HasSubstr("fail: cam0: its views are 0.7 s apart (median)"),
                    HasSubstr("record 10 images a second or more"), Not(HasSubstr("no motion"))));
}

// A second camera that is as the first, but for its clock.
TEST_F(DataProblems, ASecondCameraOnAnotherClock) {
  Value chain = ReadYaml(scratch_.Path("camchain.yaml"));
  chain.Set("cam1", chain.At("cam0"));
  (void)scratch_.Write("camchain.yaml", ToYaml(chain));
  for (const int64_t late_ns : {int64_t{2'000'000'000}, int64_t{1'000'000'000'000}}) {
    std::istringstream lines(corners_);
    std::string line;
    std::getline(lines, line);
    std::string text = line + "\n";
    while (std::getline(lines, line)) {
      const size_t comma = line.find(',');
      text +=
          std::to_string(std::stoll(line.substr(0, comma)) + late_ns) + line.substr(comma) + "\n";
    }
    (void)scratch_.Write("recording/cam1_corners.csv", text);
    const Value result = Calibrate(1);
    ExpectNoResult(result);
    const std::string seconds = std::to_string(late_ns / 1'000'000'000);
    EXPECT_THAT(FindingsOf(result), AllOf(HasSubstr("fail: the clock of imu0 is " + seconds +
                                                    ".00 s behind that of cam1 | add -" + seconds),
                                          Not(HasSubstr("that of cam0")), Not(HasSubstr("deg/s"))));
  }
}

// An IMU that is mounted on its side, so that gravity lies along another of its axes.
TEST_F(DataProblems, NoneInAnImuOnItsSide) {
  ForEachSample([](ImuRow* row) {
    for (const size_t k : {0U, 3U}) {
      const double y = row->value[k + 1];
      row->value[k + 1] = -row->value[k + 2];
      row->value[k + 2] = y;
    }
  });
  const Value result = Calibrate(0);
  EXPECT_EQ(FindingsOf(result), "");
  // A quarter turn about the IMU's x stands to the right of that about the camera's z.
  const std::vector<double> T_c_i =
      result.At("cameras").elements()[0].At("T_cam_imu").AsDoubles(16);
  EXPECT_NEAR(T_c_i[2], -1.0, 1e-3);
  EXPECT_NEAR(T_c_i[4], 1.0, 1e-3);
  EXPECT_NEAR(T_c_i[9], -1.0, 1e-3);
  EXPECT_NEAR(result.At("gravity_g").AsDoubles(3)[1], -kGravity, 0.02);
}

// Squares of 60 mm that are taken for 61.5.
TEST_F(DataProblems, ABoardOfAnotherSize) {
  std::istringstream lines(corners_);
  std::string line;
  std::getline(lines, line);
  std::string text = line.substr(0, line.find(",x [m]")) + "\n";
  while (std::getline(lines, line)) {
    for (int column = 0; column < 3; ++column) line.erase(line.rfind(','));
    text += line + "\n";
  }
  (void)scratch_.Write("recording/cam0_corners.csv", text);
  std::string target = ContentOf(recording_ + "/target.yaml");
  for (size_t at = target.find("0.06"); at != std::string::npos; at = target.find("0.06", at + 6)) {
    target.replace(at, 4, "0.0615");
  }
  (void)scratch_.Write("recording/target.yaml", target);
  const Value result = Calibrate(1);
  EXPECT_THAT(FindingsOf(result),
              AllOf(  // 2.44, estimated to +- 0.05.
                  ContainsRegex("fail: the board is 2\\.[345]"),
                  HasSubstr("% smaller than its target says"), HasSubstr("multiplied by 0.97")));
}

}  // namespace
}  // namespace calibrato
