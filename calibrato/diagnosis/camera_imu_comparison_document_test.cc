#include "calibrato/diagnosis/camera_imu_comparison_document.h"

#include <gtest/gtest.h>

#include <cmath>

#include "calibrato/base/full_sample_for_test.h"
#include "calibrato/base/input_error.h"
#include "calibrato/base/parallel.h"
#include "calibrato/calibration/camera_imu_calibration.h"
#include "calibrato/calibration/synthetic_camera_imu_for_test.h"
#include "calibrato/geometry/so3.h"
#include "calibrato/sensors/camera_chain.h"

namespace calibrato {
namespace {

struct Written {
  Value result;
  Value chain;
};

// What `calibrate camera-imu` writes of a state, as far as it is compared.
Written Write(const std::vector<CameraCalibrationState>& cameras,
              const std::vector<std::string>& names, const Eigen::MatrixXd& covariance) {
  Value in_result = Value::Array();
  std::vector<Camera> chain;
  for (const CameraCalibrationState& camera : cameras) {
    in_result.Append(Value::Object()
                         .Set("T_cam_imu", ToValue(camera.T_c_i))
                         .Set("time_offset_s", camera.time_offset_s));
    chain.push_back({camera.model, {640, 480}, "/cam0/image_raw", {}});
  }
  Value matrix = Value::Array();
  for (Eigen::Index row = 0; row < covariance.rows(); ++row) {
    matrix.Append(Value::Numbers(Eigen::VectorXd(covariance.row(row))));
  }
  Value name_values = Value::Array();
  for (const std::string& name : names) name_values.Append(name);
  Written written;
  written.result.Set("kind", "camera-imu")
      .Set("cameras", in_result)
      .Set("imus", Value::Array())
      .Set("covariance", Value::Object().Set("names", name_values).Set("matrix", matrix));
  written.chain = ToValue(chain);
  return written;
}

CameraImuComparison Compare(const Written& a, const Written& b) {
  return CompareCameraImuResults(a.result, a.chain, b.result, b.chain);
}

const std::vector<std::string> kNames = {"cam0.rot_x",      "cam0.rot_y", "cam0.rot_z",
                                         "cam0.pos_x",      "cam0.pos_y", "cam0.pos_z",
                                         "cam0.time_offset"};

// One camera; every sigma is 1 mrad, 1 mm, 0.1 ms.
Written Simple(const Rigid3& T_c_i, double time_offset_s) {
  const SyntheticCameraImu rig;
  Eigen::VectorXd variances(7);
  variances << 1e-6, 1e-6, 1e-6, 1e-6, 1e-6, 1e-6, 1e-8;
  return Write({{rig.model, T_c_i, time_offset_s, 0.0}}, kNames, variances.asDiagonal());
}

TEST(CompareCameraImuResults, ByHand) {
  const Rigid3 first{ExpSo3({0.3, -0.2, 1.0}), {0.05, 0.0, 0.01}};
  Eigen::Vector<double, 6> delta;
  delta << 0.0, 0.002, 0.0, 0.003, 0.0, 0.0;
  const CameraImuComparison comparison =
      Compare(Simple(first, 0.007), Simple(first.Perturbed(delta), 0.0072));
  ASSERT_EQ(comparison.groups.size(), 2U);
  EXPECT_EQ(comparison.groups[0].name, "cam0 pose");
  EXPECT_LT((comparison.groups[0].difference - delta).norm(), 1e-12);
  // 2 mrad and 3 mm, each with variance 1 + 1: 4 / 2 + 9 / 2.
  EXPECT_NEAR(comparison.groups[0].significance.statistic, 6.5, 1e-9);
  EXPECT_EQ(comparison.groups[0].significance.degrees, 6.0);
  EXPECT_NEAR(comparison.groups[1].significance.statistic, 0.2 * 0.2 / 0.02, 1e-9);
  EXPECT_EQ(AgreementOf(comparison), Agreement::kAgree);
  EXPECT_EQ(AgreementOf(Compare(Simple(first, 0.007), Simple(first, 0.008))), Agreement::kDiffer);
}

// At 1 rad/s a millisecond is a milliradian: f * 0.001 * sqrt(2 / 3) px on the axis, and more away
// from it, since pixels are wider apart there.
TEST(CompareCameraImuResults, CountsPixels) {
  const Rigid3 T = Rigid3{};
  const CameraImuComparison comparison = Compare(Simple(T, 0.007), Simple(T, 0.008));
  ASSERT_EQ(comparison.cameras.size(), 1U);
  EXPECT_GT(comparison.cameras[0].difference_px, 420.0 * 0.001 * std::sqrt(2.0 / 3.0));
  EXPECT_LT(comparison.cameras[0].difference_px, 1.5 * 420.0 * 0.001 * std::sqrt(2.0 / 3.0));
  EXPECT_NEAR(Compare(Simple(T, 0.007), Simple(T, 0.007)).cameras[0].difference_px, 0.0, 1e-6);
  EXPECT_GT(comparison.cameras[0].expected_px, 0.0);
}

TEST(CompareCameraImuResults, IsInconclusiveWithoutACovariance) {
  const SyntheticCameraImu rig;
  const Written none = Write({{rig.model, rig.T_c_i[0], 0.007, 0.0}}, {}, {});
  const CameraImuComparison comparison = Compare(none, Simple(rig.T_c_i[0], 0.007));
  EXPECT_EQ(AgreementOf(comparison), Agreement::kInconclusive);
  const Value value = ParseJson(ToJson(ComparisonResult(comparison)), "diff");
  EXPECT_EQ(value.At("agreement").AsString(), "inconclusive");
  EXPECT_EQ(value.At("groups").elements()[0].Find("probability"), nullptr);
}

TEST(CompareCameraImuResults, CountsNoSigmasOfWhatWasHeld) {
  const SyntheticCameraImu rig;
  Eigen::VectorXd variances = Eigen::VectorXd::Constant(7, 1e-6);
  variances(6) = 0.0;
  const auto held_at = [&](double time_offset_s) {
    return Write({{rig.model, rig.T_c_i[0], time_offset_s, 0.0}}, kNames, variances.asDiagonal());
  };
  for (const double other : {0.007, 0.008}) {
    const std::string text = ComparisonText(Compare(held_at(0.007), held_at(other)));
    EXPECT_NE(text.find("cam0.time_offset"), std::string::npos) << text;
    EXPECT_NE(text.find("(0.0 sigma)"), std::string::npos) << text;
    EXPECT_EQ(text.find("nan sigma"), std::string::npos) << text;
    EXPECT_EQ(text.find("inf sigma"), std::string::npos) << text;
  }
}

TEST(CompareCameraImuResults, RefusesOtherRigs) {
  const SyntheticCameraImu rig;
  const CameraCalibrationState camera{rig.model, rig.T_c_i[0], 0.007, 0.0};
  const Written one = Write({camera}, {}, {});
  const Written two = Write({camera, camera}, {}, {});
  EXPECT_THROW((void)Compare(one, two), InputError);
  Written unsolved = one;
  unsolved.result = Value::Object().Set("kind", "camera-imu");
  EXPECT_THROW((void)Compare(one, unsolved), InputError);
}

Written Calibrated(const SyntheticCameraImu& rig, const Rng& rng, uint64_t index) {
  Rng draws = rng.Stream("recording", index);
  CameraImuProblem problem = rig.Problem(draws);
  problem.corner_noise_px = rig.corner_noise_px;
  const CameraImuCalibration calibration = CalibrateCameraImu(problem);
  return Write(calibration.state->cameras, calibration.information.names,
               calibration.information.covariance);
}

// Of two recordings of one rig at most 5 % may be found to differ; by design it is 0.27 %.
TEST(CompareCameraImuResults, IsSeldomWrongAboutRecordingsOfTheSameRig) {
  const int num_pairs = FullSample() ? 400 : 8;
  const Rng rng(7);
  SyntheticCameraImu rig;
  rig.duration_s = 4.0;
  SyntheticCameraImu moved = rig;
  std::vector<CameraImuComparison> same(static_cast<size_t>(num_pairs));
  std::vector<CameraImuComparison> different(static_cast<size_t>(num_pairs));
  moved.T_c_i[0].t.x() += 0.01;
  ParallelFor(static_cast<size_t>(num_pairs), [&](size_t i) {
    const auto index = static_cast<uint64_t>(3 * i);
    const Written first = Calibrated(rig, rng, index);
    same[i] = Compare(first, Calibrated(rig, rng, index + 1));
    different[i] = Compare(first, Calibrated(moved, rng, index + 2));
  });
  int num_same = 0;
  int num_different = 0;
  double statistic = 0.0;
  double squared_px = 0.0;
  for (int i = 0; i < num_pairs; ++i) {
    const auto& comparison = same[static_cast<size_t>(i)];
    num_same += AgreementOf(comparison) == Agreement::kDiffer;
    num_different += AgreementOf(different[static_cast<size_t>(i)]) == Agreement::kDiffer;
    statistic += comparison.groups[0].significance.statistic;
    squared_px +=
        std::pow(comparison.cameras[0].difference_px / comparison.cameras[0].expected_px, 2);
  }
  std::printf("of %d pairs: %d of one rig differ, %d of a rig whose IMU moved by 10 mm\n",
              num_pairs, num_same, num_different);
  EXPECT_LE(num_same, 0.05 * num_pairs);
  EXPECT_EQ(num_different, num_pairs);
  // Chi-square with 6 degrees of freedom has variance 12; a ratio of squares with few of them less
  // than 3.
  EXPECT_NEAR(statistic / num_pairs, 6.0, 4.0 * std::sqrt(12.0 / num_pairs));
  EXPECT_NEAR(squared_px / num_pairs, 1.0, 4.0 * std::sqrt(3.0 / num_pairs));
}

}  // namespace
}  // namespace calibrato
