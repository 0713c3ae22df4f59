// The camera-IMU estimator on recordings like the one that Kalibr was measured with: 40 s, images
// of a checkerboard at 20 Hz, an IMU at 200 Hz, intrinsics given. Errors are set beside Kalibr's
// there.

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <set>
#include <string>

#include "calibrato/base/full_sample_for_test.h"
#include "calibrato/calibration/camera_imu_calibration.h"
#include "calibrato/calibration/synthetic_camera_imu_for_test.h"
#include "calibrato/diagnosis/camera_imu_diagnosis.h"

namespace calibrato {
namespace {

// Kalibr's mean errors over six seeds.
constexpr double kKalibrDegrees = 0.0114;
constexpr double kKalibrMm = 0.275;
constexpr double kKalibrMs = 0.03;

// What Kalibr was given: rates, noise, lens, board and truth; and its motion, as far as it is
// known: the root mean square of the gyroscope was 0.63, 0.60 and 0.95 rad/s. Swings here last 0.8
// to 2.3 s, as a hand's do.
SyntheticCameraImu KalibrsRecording() {
  SyntheticCameraImu truth;
  truth.duration_s = 40.0;
  truth.camera_rate_hz = 20.0;
  truth.corner_noise_px = 0.025;
  truth.imu_noise = {200.0, 4e-3, 3e-3, 3.4e-4, 2e-5};
  truth.slowest_rad_s = 2.7;
  truth.rotation_of_axis = {1.30, 1.25, 2.05};
  return truth;
}

CameraImuOptions FixedKnots() {
  CameraImuOptions options;
  options.knot_spacing_s = 0.05;
  return options;
}

// Mean errors of T_c_i and time offset, and how they compare with the stated covariance.
class Errors {
 public:
  void Add(const CameraImuCalibration& result, const SyntheticCameraImu& truth) {
    const CameraCalibrationState& camera = result.state->cameras.front();
    Eigen::Vector<double, 7> error;
    error << camera.T_c_i.DifferenceTo(truth.T_c_i[0]),
        camera.time_offset_s - truth.time_offset_s[0];
    const Eigen::Matrix<double, 7, 7> covariance =
        result.information.covariance.topLeftCorner<7, 7>();
    degrees_ += error.head<3>().norm() * 180.0 / std::numbers::pi;
    mm_ += 1e3 * error.segment<3>(3).norm();
    ms_ += 1e3 * std::abs(error(6));
    nees_ += error.dot(covariance.ldlt().solve(error));
    ++num_;
  }
  double degrees() const { return degrees_ / num_; }
  double mm() const { return mm_ / num_; }
  double ms() const { return ms_ / num_; }
  double error_over_bound() const { return std::sqrt(nees_ / (7.0 * num_)); }
  void Print(const char* what) const {
    std::printf("%s, %d seeds: %.4f degrees, %.3f mm, %.4f ms, error over bound %.3f\n", what, num_,
                degrees(), mm(), ms(), error_over_bound());
    testing::Test::RecordProperty(std::string(what) + "_mm", std::to_string(mm()));
  }

 private:
  double degrees_ = 0.0;
  double mm_ = 0.0;
  double ms_ = 0.0;
  double nees_ = 0.0;
  int num_ = 0;
};

int NumSeeds() { return FullSample() ? 100 : 4; }

// 1.1 is promised; a small sample can only tell what lies 3.5 standard deviations of the mean of
// 7 n squared normal errors above 1.
double MaxErrorOverBound() {
  return FullSample() ? 1.1 : std::sqrt(1.0 + 3.5 * std::sqrt(2.0 / (7.0 * NumSeeds())));
}

Errors FindCleanErrors() {
  const SyntheticCameraImu truth = KalibrsRecording();
  Errors errors;
  for (int seed = 0; seed < NumSeeds(); ++seed) {
    Rng rng(static_cast<uint64_t>(seed));
    const CameraImuCalibration result = CalibrateCameraImu(truth.Problem(rng), FixedKnots());
    EXPECT_EQ(result.termination, Termination::kConverged) << seed;
    errors.Add(result, truth);
  }
  return errors;
}

// Found once.
const Errors& CleanErrors() {
  static const Errors errors = FindCleanErrors();
  return errors;
}

// A mean of n norms of three errors has a standard deviation of 0.42 / sqrt(n) of itself, one of n
// sizes of one error 0.76 / sqrt(n); of a small sample 3.5 of them are allowed for.
double SmallSample(double relative_deviation) {
  return FullSample() ? 1.0 : 1.0 + 3.5 * relative_deviation / std::sqrt(NumSeeds());
}

void ExpectWithinTwice(const Errors& errors, const Errors& clean) {
  EXPECT_LE(errors.degrees(), 2.0 * clean.degrees());
  EXPECT_LE(errors.mm(), 2.0 * clean.mm());
  EXPECT_LE(errors.ms(), 2.0 * clean.ms());
  EXPECT_LE(errors.error_over_bound(), MaxErrorOverBound());
}

TEST(CameraImuAccuracy, HasTheMotionThatKalibrHad) {
  const SyntheticCameraImu truth = KalibrsRecording();
  Eigen::Vector3d squares = Eigen::Vector3d::Zero();
  for (int k = 0; k < 4000; ++k) squares += truth.MotionAt(0.01 * k).omega_i.cwiseAbs2() / 4000.0;
  EXPECT_NEAR(std::sqrt(squares.x()), 0.63, 0.05);
  EXPECT_NEAR(std::sqrt(squares.y()), 0.60, 0.05);
  EXPECT_NEAR(std::sqrt(squares.z()), 0.95, 0.05);
}

TEST(CameraImuAccuracy, IsNoWorseThanKalibrs) {
  const Errors& errors = CleanErrors();
  errors.Print("clean");
  EXPECT_LE(errors.degrees(), SmallSample(0.42) * kKalibrDegrees);
  EXPECT_LE(errors.mm(), SmallSample(0.42) * kKalibrMm);
  EXPECT_LE(errors.ms(), SmallSample(0.76) * kKalibrMs);
  EXPECT_LE(errors.error_over_bound(), MaxErrorOverBound());
}

// 0.4 % of the IMU's samples: 3 rad/s and 20 m/s^2 off.
TEST(CameraImuAccuracy, BearsSpikesOfTheImu) {
  const SyntheticCameraImu truth = KalibrsRecording();
  Errors errors;
  for (int seed = 0; seed < NumSeeds(); ++seed) {
    Rng rng(static_cast<uint64_t>(seed));
    CameraImuProblem problem = truth.Problem(rng);
    ImuStream& stream = problem.imus[0].stream;
    std::set<size_t> spikes;
    while (spikes.size() < stream.gyro.size() / 250) {
      spikes.insert(rng.UniformIndex(stream.gyro.size()));
    }
    for (const size_t k : spikes) {
      stream.gyro[k].value(static_cast<Eigen::Index>(k % 3)) += k % 2 == 0 ? 3.0 : -3.0;
      stream.accel[k].value(static_cast<Eigen::Index>(k / 3 % 3)) += k % 2 == 0 ? -20.0 : 20.0;
    }
    const CameraImuCalibration result = CalibrateCameraImu(problem, FixedKnots());
    ASSERT_EQ(result.termination, Termination::kConverged) << seed;
    errors.Add(result, truth);
    for (const size_t k : spikes) {
      EXPECT_FALSE(result.inliers.gyro[0][k]) << seed << " " << k;
      EXPECT_FALSE(result.inliers.accel[0][k]) << seed << " " << k;
    }
    // Besides, only what lies beyond the trajectory's ends, and neighbours of spikes there.
    const auto num_left_out = static_cast<size_t>(
        std::count(result.inliers.gyro[0].begin(), result.inliers.gyro[0].end(), false));
    EXPECT_LE(num_left_out, spikes.size() + 8 + static_cast<size_t>(result.num_outside)) << seed;
  }
  errors.Print("spikes");
  ExpectWithinTwice(errors, CleanErrors());
}

std::set<size_t> MakeLate(CameraImuProblem* problem, Rng& rng) {
  std::vector<BoardView>& views = problem->cameras[0].views;
  std::set<size_t> late;
  while (late.size() < views.size() / 100) late.insert(rng.UniformIndex(views.size()));
  for (const size_t v : late) views[v].stamp = views[v].stamp + Duration::FromSeconds(0.03);
  return late;
}

// 1 % of the images are stamped 30 ms late.
TEST(CameraImuAccuracy, BearsLateImages) {
  const SyntheticCameraImu truth = KalibrsRecording();
  Errors errors;
  int num_wrong = 0;
  for (int seed = 0; seed < NumSeeds(); ++seed) {
    Rng rng(static_cast<uint64_t>(seed));
    CameraImuProblem problem = truth.Problem(rng);
    const std::set<size_t> late = MakeLate(&problem, rng);
    const CameraImuCalibration result = CalibrateCameraImu(problem, FixedKnots());
    ASSERT_EQ(result.termination, Termination::kConverged) << seed;
    errors.Add(result, truth);
    for (size_t v = 0; v < problem.cameras[0].views.size(); ++v) {
      const std::vector<bool>& inliers = result.inliers.corners[0][v];
      const bool is_left_out = std::find(inliers.begin(), inliers.end(), true) == inliers.end();
      EXPECT_TRUE(is_left_out || !late.contains(v)) << seed << " " << v;
      if (is_left_out && !late.contains(v)) ++num_wrong;
    }
  }
  // At the very ends a late view may take its neighbour along.
  EXPECT_LE(num_wrong, NumSeeds() / 20);
  errors.Print("late");
  ExpectWithinTwice(errors, CleanErrors());
}

// What the report says of both.
TEST(CameraImuAccuracy, NamesWhatWasLeftOut) {
  SyntheticCameraImu truth = KalibrsRecording();
  truth.duration_s = 15.0;
  Rng rng(7);
  CameraImuProblem problem = truth.Problem(rng);
  for (const size_t k : {1003U, 2000U, 2511U}) {
    problem.imus[0].stream.gyro[k].value.x() += 3.0;
    problem.imus[0].stream.accel[k].value.z() -= 20.0;
  }
  std::vector<std::string> late;
  for (const size_t v : MakeLate(&problem, rng)) late.push_back(problem.cameras[0].views[v].name);
  const CameraImuCalibration result = CalibrateCameraImu(problem, FixedKnots());
  const CameraImuDiagnosis diagnosis = DiagnoseCameraImu(problem, result);
  std::string findings;
  for (const Finding& finding : diagnosis.findings) findings += finding.what + "\n";
  EXPECT_NE(findings.find("samples of the gyroscope do not fit and were left out"),
            std::string::npos)
      << findings;
  EXPECT_NE(findings.find("samples of the accelerometer do not fit"), std::string::npos);
  EXPECT_EQ(diagnosis.residuals->cameras[0].rejected_views, late);
  for (const std::string& name : late) EXPECT_NE(findings.find(name), std::string::npos) << name;
}

}  // namespace
}  // namespace calibrato
