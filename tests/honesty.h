#pragma once

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <cstdio>
#include <string>

#include "calibrato/base/full_sample_for_test.h"
#include "calibrato/calibration/camera_imu_calibration.h"

namespace calibrato {

/// Whether calibrations are as good as they say: sums over rigs of how far estimates of camera 0's
/// T_c_i and time offset lie from the truth, by their covariance.
class Honesty {
 public:
  void Add(const CameraImuCalibration& result, const Rigid3& T_c_i, double time_offset_s) {
    const CameraCalibrationState& camera = result.state->cameras.front();
    Eigen::Vector<double, 7> error;
    error << camera.T_c_i.DifferenceTo(T_c_i), camera.time_offset_s - time_offset_s;
    const Eigen::Matrix<double, 7, 7> covariance =
        result.information.covariance.topLeftCorner<7, 7>();
    const double squared = error.dot(covariance.ldlt().solve(error));
    squares_ += squared;
    num_covered_ += squared < 14.067 ? 1 : 0;  // 95 % of chi-square with 7 degrees.
    ++num_rigs_;
  }

  /// The mean square is that of chi-square within 3.5 standard deviations; of a full sample, 95 %
  /// ellipsoids cover in 93 to 97 %, of a small one in 90 to 99 %. Of fewer than fifty rigs
  /// coverage and the bound of the error say nothing: one rig more or less is too much of them.
  void Expect() const {
    const double coverage = static_cast<double>(num_covered_) / num_rigs_;
    const double degrees = 7.0 * num_rigs_;
    const double error_over_bound = std::sqrt(squares_ / degrees);
    testing::Test::RecordProperty("coverage", std::to_string(coverage));
    testing::Test::RecordProperty("error_over_bound", std::to_string(error_over_bound));
    std::printf("%d rigs: coverage %.4f, error over bound %.4f\n", num_rigs_, coverage,
                error_over_bound);
    EXPECT_NEAR(squares_ / degrees, 1.0, 3.5 * std::sqrt(2.0 / degrees));
    if (num_rigs_ < 50) return;
    EXPECT_GE(coverage, FullSample() ? 0.93 : 0.90);
    EXPECT_LE(coverage, FullSample() ? 0.97 : 0.99);
    EXPECT_LE(error_over_bound, 1.1);
  }

 private:
  int num_rigs_ = 0;
  int num_covered_ = 0;
  double squares_ = 0.0;
};

}  // namespace calibrato
