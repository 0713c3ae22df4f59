#include "calibrato/diagnosis/stream_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>

#include "calibrato/base/rng.h"
#include "calibrato/base/value.h"
#include "calibrato/geometry/so3.h"
#include "calibrato/recording/recording.h"
#include "calibrato/sensors/board.h"
#include "calibrato/sensors/camera_chain.h"
#include "calibrato/sensors/imu_file.h"

namespace calibrato {
namespace {

using Eigen::Vector3d;
using testing::AllOf;
using testing::HasSubstr;

// A camera that nods and sways before a board for 20 s at 20 Hz, with an IMU of 200 Hz on it: rates
// in closed form, force that of gravity as it turns.
class CheckStreamsTest : public testing::Test {
 protected:
  CheckStreamsTest() {
    Rng rng(1);
    camera_.name = "cam0";
    camera_.model.emplace("pinhole-none", Eigen::Vector4d(500.0, 500.0, 320.0, 240.0));
    const Eigen::Matrix3Xd points_g = BoardPoints(Checkerboard{6, 7, 0.06, 0.06});
    for (int k = 0; k < 400; ++k) {
      const double t_s = 0.05 * k;
      const Rigid3 T_c_g{R_c_g(t_s), {-0.15, -0.15, 1.0}};
      BoardView view;
      view.stamp = kStart + Duration::FromSeconds(t_s);
      view.points_g = points_g;
      view.pixels.resize(2, points_g.cols());
      for (int i = 0; i < points_g.cols(); ++i) {
        view.corner_ids.push_back(i);
        view.pixels.col(i) = *camera_.model->Project(T_c_g * points_g.col(i)) +
                             0.1 * Eigen::Vector2d(rng.Normal(), rng.Normal());
      }
      camera_.views.push_back(std::move(view));
    }
    imu_.recording.name = "imu0";
    imu_.noise = ImuNoise();
    const Eigen::Matrix3d R_i_c = ExpSo3({0.5, 1.2, -0.3});
    for (int k = 0; k < 4000; ++k) {
      const double t_s = 0.005 * k;
      const auto noise = [&] { return Vector3d(rng.Normal(), rng.Normal(), rng.Normal()); };
      const Time stamp = kStart + Duration::FromSeconds(t_s);
      gyro().push_back({stamp, -R_i_c * TurningOfBoard(t_s) + 1e-3 * noise()});
      accel().push_back(
          {stamp, R_i_c * R_c_g(t_s) * Vector3d(0.0, 0.0, kStandardGravity) + 1e-2 * noise()});
    }
  }

  static double Angle(double t_s) { return 0.4 * std::sin(1.3 * t_s) + 0.15 * std::sin(4.1 * t_s); }
  static double Rate(double t_s) {
    return 0.52 * std::cos(1.3 * t_s) + 0.615 * std::cos(4.1 * t_s);
  }
  static double Sway(double t_s) { return 0.2 * std::sin(2.3 * t_s + 0.5); }
  static double SwayRate(double t_s) { return 0.46 * std::cos(2.3 * t_s + 0.5); }
  static Eigen::Matrix3d R_c_g(double t_s) {
    return ExpSo3(kAxis * Angle(t_s)) * ExpSo3(kOther * Sway(t_s)) * ExpSo3({0.3, 0.2, 0.1});
  }
  // Angular velocity of the board in the camera.
  static Vector3d TurningOfBoard(double t_s) {
    return kAxis * Rate(t_s) + ExpSo3(kAxis * Angle(t_s)) * kOther * SwayRate(t_s);
  }

  std::vector<VectorSample>& gyro() { return imu_.recording.stream.gyro; }
  std::vector<VectorSample>& accel() { return imu_.recording.stream.accel; }
  void ShiftImu(double seconds) {
    for (auto* samples : {&gyro(), &accel()}) {
      for (VectorSample& sample : *samples) {
        sample.stamp = sample.stamp + Duration::FromSeconds(seconds);
      }
    }
  }

  std::vector<Finding> Check() const { return CheckStreams({camera_}, {imu_}); }
  // The only finding.
  Finding Only() const {
    const std::vector<Finding> findings = Check();
    EXPECT_EQ(findings.size(), 1U);
    for (size_t i = 1; i < findings.size(); ++i) ADD_FAILURE() << findings[i].what;
    return findings.empty() ? Finding() : findings[0];
  }
  void ExpectOnly(Severity severity, const std::string& what, const std::string& remedy) const {
    const Finding finding = Only();
    EXPECT_EQ(finding.severity, severity) << finding.what;
    EXPECT_THAT(finding.what, HasSubstr(what));
    EXPECT_THAT(finding.remedy, HasSubstr(remedy));
  }

  static inline const Time kStart = Time::FromNanoseconds(1'600'000'000'000'000'000);
  static inline const Vector3d kAxis = Vector3d(0.6, 0.0, 0.8);
  static inline const Vector3d kOther = Vector3d(0.0, 1.0, 0.0);
  CheckedCamera camera_;
  CheckedImu imu_;
};

TEST_F(CheckStreamsTest, FindsNothingWhereNothingIsWrong) {
  for (const Finding& finding : Check()) ADD_FAILURE() << finding.what;
  ShiftImu(0.05);
  for (const Finding& finding : Check()) ADD_FAILURE() << finding.what;
  camera_.model.reset();
  imu_.noise.reset();
  EXPECT_TRUE(Check().empty());
}

TEST_F(CheckStreamsTest, NamesWhatIsWrongWithTheSamples) {
  gyro()[77].value.x() = std::numeric_limits<double>::quiet_NaN();
  ExpectOnly(Severity::kWarn, "imu0 gyroscope: 1 of 4000 samples are not finite", "left out");
  gyro()[77].value.x() = 0.0;
  std::swap(accel()[100].stamp, accel()[102].stamp);
  ExpectOnly(Severity::kWarn, "imu0 accelerometer: 2 of 4000 samples have a stamp earlier",
             "sorted");
}

TEST_F(CheckStreamsTest, NamesTwins) {
  accel()[100].stamp = accel()[99].stamp;
  ExpectOnly(Severity::kWarn, "1 of 4000 samples repeat the stamp", "first of each is kept");
}

TEST_F(CheckStreamsTest, NamesGaps) {
  gyro().erase(gyro().begin() + 1000, gyro().begin() + 1100);
  ExpectOnly(Severity::kWarn,
             "imu0 gyroscope: 1 gap, the longest 0.505 s after the stamp 1600000004995000000",
             "faster disk");
}

TEST_F(CheckStreamsTest, RefusesALongPauseOfTheWholeImu) {
  for (auto* samples : {&gyro(), &accel()}) {
    for (VectorSample& sample : *samples) {
      if (sample.stamp - kStart > Duration::FromSeconds(10.0)) {
        sample.stamp = sample.stamp + Duration::FromSeconds(11.0);
      }
    }
  }
  const std::vector<Finding> findings = Check();
  ASSERT_EQ(findings.size(), 3U);  // A gap of each sensor, too.
  EXPECT_EQ(findings[2].severity, Severity::kFail);
  EXPECT_THAT(findings[2].what, HasSubstr("imu0 recorded nothing for 11.0 s, from 10.000 s on"));
}

TEST_F(CheckStreamsTest, KnowsGravityElsewhere) {
  for (VectorSample& sample : accel()) sample.value *= 3.71 / kStandardGravity;
  EXPECT_FALSE(Check().empty());
  EXPECT_TRUE(CheckStreams({camera_}, {imu_}, 3.71).empty());
}

TEST_F(CheckStreamsTest, KnowsDegreesOfAClippedGyroscope) {
  for (VectorSample& sample : gyro()) {
    sample.value *= 180.0 / std::numbers::pi;
    sample.value.z() = std::min(sample.value.z(), 20.0);
  }
  const std::vector<Finding> findings = Check();
  EXPECT_TRUE(std::any_of(findings.begin(), findings.end(), [](const Finding& finding) {
    return finding.severity == Severity::kFail &&
           finding.what.find("it is in deg/s") != std::string::npos;
  }));
}

TEST_F(CheckStreamsTest, NamesSaturation) {
  for (VectorSample& sample : gyro()) sample.value.z() = std::min(sample.value.z(), 0.3);
  ExpectOnly(Severity::kWarn, "imu0 gyroscope z: ", "move more gently");
  EXPECT_THAT(Only().what, HasSubstr("end of its range, 0.3 rad/s"));
}

TEST_F(CheckStreamsTest, NamesAnAxisThatIsStuck) {
  for (VectorSample& sample : accel()) sample.value.y() = 1.0;
  const std::vector<Finding> findings = Check();
  ASSERT_FALSE(findings.empty());
  EXPECT_THAT(findings[0].what, HasSubstr("imu0 accelerometer y never changes"));
}

TEST_F(CheckStreamsTest, ComparesRatesWithTheYaml) {
  imu_.noise->rate_hz = 100.0;
  const std::vector<Finding> findings = Check();
  ASSERT_EQ(findings.size(), 2U);
  EXPECT_THAT(findings[0].what, HasSubstr("samples come at 200 Hz, the YAML says 100 Hz"));
  EXPECT_THAT(findings[1].what, HasSubstr("imu0 accelerometer"));
  EXPECT_THAT(findings[1].remedy, HasSubstr("update_rate: 200.0"));
  imu_.noise->rate_hz = 195.0;
  EXPECT_TRUE(Check().empty());
}

TEST_F(CheckStreamsTest, KnowsUnitsByTheirSize) {
  for (VectorSample& sample : accel()) sample.value /= kStandardGravity;
  ExpectOnly(Severity::kFail, "it is in g", "by 9.80665");
  for (VectorSample& sample : accel()) sample.value *= 1000.0;
  ExpectOnly(Severity::kFail, "thousandths of g", "0.00980665");
}

TEST_F(CheckStreamsTest, KnowsDegreesByTheBoardsMotion) {
  for (VectorSample& sample : gyro()) sample.value *= 180.0 / std::numbers::pi;
  ExpectOnly(Severity::kFail, "it is in deg/s", "0.0174532925");
  camera_.model.reset();
  ExpectOnly(Severity::kFail, "it may be in deg/s", "0.0174532925");
}

TEST_F(CheckStreamsTest, KnowsAnotherScale) {
  for (VectorSample& sample : gyro()) sample.value *= 2.0;
  ExpectOnly(Severity::kWarn, "times as fast as the board in cam0", "unit");
}

TEST_F(CheckStreamsTest, KnowsSwappedColumnsAndMissingGravity) {
  std::swap(gyro(), accel());
  ExpectOnly(Severity::kFail, "the gyroscope's columns read 9.81, as gravity does", "swap");
  std::swap(gyro(), accel());
  Rng rng(3);
  for (VectorSample& sample : accel()) {
    sample.value = Vector3d(rng.Normal(), rng.Normal(), rng.Normal());
  }
  ExpectOnly(Severity::kFail, "gravity was taken out", "raw accelerometer");
}

TEST_F(CheckStreamsTest, KnowsClocksThatAreASecondApart) {
  ShiftImu(1.0);
  ExpectOnly(Severity::kWarn, "the clock of imu0 is 1.00 s ahead of that of cam0",
             "add 1.00 s to the stamps of cam0");
  ShiftImu(-2.0);
  ExpectOnly(Severity::kWarn, "the clock of imu0 is 1.00 s behind that of cam0",
             "add -1.00 s to the stamps of cam0");
}

// Beyond what the solve looks for.
TEST_F(CheckStreamsTest, RefusesClocksThatAreTwoSecondsApart) {
  ShiftImu(2.0);
  const std::vector<Finding> findings = Check();
  ASSERT_EQ(findings.size(), 3U);
  EXPECT_EQ(findings[2].severity, Severity::kFail);
  EXPECT_THAT(findings[2].what, HasSubstr("is 2.00 s ahead of that of cam0"));
}

TEST_F(CheckStreamsTest, LooksAtEveryCamera) {
  CheckedCamera other = camera_;
  other.name = "cam1";
  for (const Finding& finding : CheckStreams({camera_, other}, {imu_})) {
    ADD_FAILURE() << finding.what;
  }
  for (BoardView& view : other.views) view.stamp = view.stamp + Duration::FromSeconds(0.5);
  std::vector<Finding> findings = CheckStreams({camera_, other}, {imu_});
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_THAT(findings[0].what, HasSubstr("is 0.50 s behind that of cam1"));
  EXPECT_THAT(findings[0].remedy, HasSubstr("add -0.50 s to the stamps of cam1"));
  // The unit is the gyroscope's, and said once.
  for (VectorSample& sample : gyro()) sample.value *= 180.0 / std::numbers::pi;
  findings = CheckStreams({camera_, other}, {imu_});
  ASSERT_EQ(findings.size(), 2U);
  EXPECT_THAT(findings[0].what, HasSubstr("as fast as the board in cam0: it is in deg/s"));
  EXPECT_THAT(findings[1].what, HasSubstr("that of cam1"));
}

TEST_F(CheckStreamsTest, WantsImagesThatFollowEachOther) {
  std::vector<BoardView> some;
  for (size_t v = 0; v < camera_.views.size(); v += 14) some.push_back(camera_.views[v]);
  camera_.views = some;
  ExpectOnly(Severity::kFail, "cam0: its views are 0.7 s apart (median)",
             "record 10 images a second or more");
}

// Photos that are named img00.png, img01.png, ..
TEST_F(CheckStreamsTest, WantsImagesWithStamps) {
  for (BoardView& view : camera_.views) view.stamp = Time();
  ExpectOnly(Severity::kFail, "cam0: its images have no stamps", "data.csv");
}

TEST_F(CheckStreamsTest, KnowsClocksThatHaveNothingInCommon) {
  ShiftImu(1000.0);
  const std::vector<Finding> findings = Check();
  ASSERT_EQ(findings.size(), 3U);
  EXPECT_EQ(findings[0].severity, Severity::kFail);
  EXPECT_THAT(findings[0].what,
              AllOf(HasSubstr("no time in common"), HasSubstr("begins 1000.000 s after cam0")));
  EXPECT_THAT(findings[0].remedy, HasSubstr("add 1000.000 s to the stamps of cam0"));
  EXPECT_THAT(findings[2].what, HasSubstr("is 1000.00 s ahead"));
}

TEST_F(CheckStreamsTest, KnowsWhenTheImuStoppedEarly) {
  gyro().resize(3000);
  ExpectOnly(Severity::kWarn, "imu0 gyroscope and cam0 share 15.0 s, of the 20.0 s",
             "stop it last");
}

TEST_F(CheckStreamsTest, KnowsWhatDoesNotMoveTogether) {
  Rng rng(2);
  for (VectorSample& sample : gyro()) {
    const double t_s = (sample.stamp - kStart).seconds();
    sample.value = Vector3d(1.0 + std::sin(7.3 * t_s + std::sin(0.7 * t_s)),
                            0.1 + 0.1 * std::sin(8.1 * t_s), 0.2) +
                   1e-3 * Vector3d(rng.Normal(), rng.Normal(), rng.Normal());
  }
  ExpectOnly(Severity::kWarn, "do not turn at the same times", "one rigid body");
}

TEST_F(CheckStreamsTest, KnowsARigThatDidNotMove) {
  camera_.model.reset();
  Rng rng(4);
  const auto noise = [&] { return Vector3d(rng.Normal(), rng.Normal(), rng.Normal()); };
  for (VectorSample& sample : gyro()) sample.value = Vector3d(0.1, 0.0, 0.2) + 5e-3 * noise();
  std::vector<VectorSample> swinging = accel();
  for (VectorSample& sample : accel()) sample.value = Vector3d(0.0, 9.8, 0.0) + 0.1 * noise();
  ExpectOnly(Severity::kFail, "imu0 did not move: its rates vary by ", "about all three axes");
  accel() = swinging;
  ExpectOnly(Severity::kFail, "imu0 moved but did not turn: its rates vary by ", "turn the rig");
}

TEST_F(CheckStreamsTest, KnowsARigThatTurnedAboutOneAxis) {
  camera_.model.reset();
  Rng rng(5);
  for (VectorSample& sample : gyro()) {
    sample.value = Vector3d(0.05, 0.02 - Rate((sample.stamp - kStart).seconds()), 0.0) +
                   5e-3 * Vector3d(rng.Normal(), rng.Normal(), rng.Normal());
  }
  ExpectOnly(Severity::kInconclusive, "imu0 turned about one axis only, [0 1 0] in its frame",
             "about all three axes");
}

TEST_F(CheckStreamsTest, WantsTenViewsAndSomeSamples) {
  camera_.views.resize(9);
  ExpectOnly(Severity::kFail, "cam0 saw the board in 9 images only, 10 are needed", "30 s");
  camera_.views.clear();
  ExpectOnly(Severity::kFail, "cam0 never saw the board", "--target");
}

TEST_F(CheckStreamsTest, WithoutSamplesFails) {
  gyro().clear();
  ExpectOnly(Severity::kFail, "imu0 has no samples", "again");
}

TEST(CheckStreamsOnEuroc, FindsNothingToFail) {
  const char* data = std::getenv("CALIBRATO_DATA");
  if (data == nullptr) GTEST_SKIP() << "CALIBRATO_DATA is not set";
  const std::string folder = std::string(data) + "/euroc_imu_april";
  const Recording recording = OpenRecording(folder, {});
  const std::vector<Camera> chain =
      CameraChainFromValue(ReadYaml(folder + "/camchain.yaml"), nullptr);
  std::vector<CheckedCamera> cameras;
  for (size_t i = 0; i < chain.size(); ++i) {
    cameras.push_back({recording.cameras[i].name,
                       std::get<std::vector<BoardView>>(recording.cameras[i].data),
                       chain[i].model});
  }
  const std::vector<Imu> imus = ImusFromValue(ReadYaml(folder + "/imu0.yaml"), nullptr);
  const std::vector<Finding> findings =
      CheckStreams(cameras, {{recording.imus.at(0), imus.at(0).noise}});
  for (const Finding& finding : findings) ADD_FAILURE() << finding.what << "; " << finding.remedy;
}

}  // namespace
}  // namespace calibrato
