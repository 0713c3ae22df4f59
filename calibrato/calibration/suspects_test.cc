#include "calibrato/calibration/suspects.h"

#include <gtest/gtest.h>

#include <numbers>
#include <set>

#include "calibrato/base/rng.h"
#include "calibrato/calibration/synthetic_camera_imu_for_test.h"

namespace calibrato {
namespace {

// Poses of the board at 20 Hz and rates at 200 Hz, with noise.
class FindSuspectViewsTest : public testing::Test {
 protected:
  FindSuspectViewsTest() {
    Rng rng(1);
    const auto noise = [&](double stddev) -> Eigen::Vector3d {
      const double x = stddev * rng.Normal();
      const double y = stddev * rng.Normal();
      return {x, y, stddev * rng.Normal()};
    };
    for (int k = 0; k < 400; ++k) {
      const double t = 0.01 + 0.05 * k;
      Eigen::Vector<double, 6> error;
      error << noise(2e-4), noise(1e-4);
      T_c_g_.push_back({t, BoardAt(t).Perturbed(error)});
    }
    for (int k = 0; k < 4010; ++k) {
      const double t = 0.005 * k;
      gyro_.push_back({t, truth_.MotionAt(t).omega_i + noise(1e-3)});
    }
  }

  Rigid3 BoardAt(double t) const { return truth_.T_c_i[0] * truth_.PoseAt(t).Inverse(); }
  void MakeLate(size_t v, double by_s) { T_c_g_[v].pose = BoardAt(T_c_g_[v].time_s - by_s); }
  std::set<size_t> Suspects() const {
    const std::vector<bool> suspect =
        FindSuspectViews(T_c_g_, truth_.T_c_i[0].R, GyroTurns(gyro_, Eigen::Vector3d::Zero()));
    std::set<size_t> result;
    for (size_t v = 0; v < suspect.size(); ++v) {
      if (suspect[v]) result.insert(v);
    }
    return result;
  }

  SyntheticCameraImu truth_;
  std::vector<TimedPose> T_c_g_;
  std::vector<RateSample> gyro_;
};

TEST_F(FindSuspectViewsTest, FindsNoneWhereAllIsWell) { EXPECT_TRUE(Suspects().empty()); }

TEST_F(FindSuspectViewsTest, FindsLateViewsAndNotTheirNeighbours) {
  const std::set<size_t> late = {2, 30, 31, 77, 120, 122, 251, 333, 397};
  for (const size_t v : late) MakeLate(v, 0.03);
  EXPECT_EQ(Suspects(), late);
}

TEST_F(FindSuspectViewsTest, FindsABoardThatWasTurnedRound) {
  T_c_g_[200].pose.R = T_c_g_[200].pose.R * ExpSo3({0.0, 0.0, std::numbers::pi});
  EXPECT_EQ(Suspects(), std::set<size_t>({200}));
}

TEST_F(FindSuspectViewsTest, BearsGapsAndTheEnds) {
  MakeLate(50, 0.03);
  T_c_g_.erase(T_c_g_.begin() + 100, T_c_g_.begin() + 130);
  T_c_g_.erase(T_c_g_.begin() + 200, T_c_g_.begin() + 203);
  EXPECT_EQ(Suspects(), std::set<size_t>({50}));
  T_c_g_.resize(2);
  EXPECT_TRUE(Suspects().empty());
  T_c_g_.clear();
  EXPECT_TRUE(Suspects().empty());
}

TEST_F(FindSuspectViewsTest, SuspectsNoneWhereItWouldSuspectMany) {
  for (size_t v = 2; v < T_c_g_.size(); v += 5) MakeLate(v, 0.03);
  EXPECT_TRUE(Suspects().empty());
}

// Rates of a shaken rig at 200 Hz.
std::vector<VectorSample> Rates() {
  const SyntheticCameraImu truth;
  Rng rng(2);
  std::vector<VectorSample> samples;
  for (int k = 0; k < 2000; ++k) {
    const Eigen::Vector3d noise(rng.Normal(), rng.Normal(), rng.Normal());
    samples.push_back({Time::FromNanoseconds(int64_t{5'000'000} * k),
                       truth.MotionAt(0.005 * k).omega_i + 5e-3 * noise});
  }
  return samples;
}

std::set<size_t> SuspectsAmong(const std::vector<VectorSample>& samples) {
  const std::vector<bool> suspect = FindSuspectSamples(samples);
  std::set<size_t> result;
  for (size_t k = 0; k < suspect.size(); ++k) {
    if (suspect[k]) result.insert(k);
  }
  return result;
}

TEST(FindSuspectSamples, FindsSpikesAndNotTheirNeighbours) {
  std::vector<VectorSample> samples = Rates();
  EXPECT_TRUE(SuspectsAmong(samples).empty());
  const std::set<size_t> spikes = {2, 100, 101, 500, 503, 1333, 1997};
  for (const size_t k : spikes) samples[k].value.y() += k == 101 ? -0.3 : 3.0;
  EXPECT_EQ(SuspectsAmong(samples), spikes);
}

// A run of spikes that lasts longer than neighbours reach, at the end of the range of a sensor.
TEST(FindSuspectSamples, BearsALongRunOfSpikes) {
  std::vector<VectorSample> samples = Rates();
  for (size_t k = 800; k < 950; ++k) samples[k].value.y() = k % 2 == 0 ? 30.0 : -30.0;
  const std::set<size_t> suspects = SuspectsAmong(samples);
  // Some of the run predict each other.
  EXPECT_GT(suspects.size(), 100U);
  for (const size_t k : suspects) {
    // Two at its ends are predicted from it.
    EXPECT_GE(k, 798U);
    EXPECT_LT(k, 952U);
  }
}

TEST(FindSuspectSamples, BearsGapsTwinsAndNothing) {
  std::vector<VectorSample> samples = Rates();
  samples.erase(samples.begin() + 300, samples.begin() + 400);
  samples[700].stamp = samples[699].stamp;
  EXPECT_EQ(FindSuspectSamples(samples), std::vector<bool>(samples.size(), false));
  samples.resize(3);
  EXPECT_EQ(FindSuspectSamples(samples), std::vector<bool>(3, false));
  EXPECT_TRUE(FindSuspectSamples({}).empty());
}

TEST(FindSuspectSamples, SuspectsNoneWhereItWouldSuspectMany) {
  std::vector<VectorSample> samples = Rates();
  for (size_t k = 2; k < samples.size(); k += 6) samples[k].value.x() += 2.0;
  EXPECT_EQ(FindSuspectSamples(samples), std::vector<bool>(samples.size(), false));
}

}  // namespace
}  // namespace calibrato
