#include "calibrato/diagnosis/merge_document.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "calibrato/base/full_sample_for_test.h"
#include "calibrato/base/input_error.h"
#include "calibrato/base/rng.h"
#include "calibrato/calibration/camera_imu_layout.h"
#include "calibrato/geometry/rigid3.h"
#include "calibrato/geometry/so3.h"
#include "calibrato/sensors/camera_chain.h"
#include "calibrato/sensors/imu_file.h"

namespace calibrato {
namespace {

Value CovarianceValue(const std::vector<std::string>& names, const Eigen::MatrixXd& covariance) {
  Value matrix = Value::Array();
  for (Eigen::Index row = 0; row < covariance.rows(); ++row) {
    matrix.Append(Value::Numbers(Eigen::VectorXd(covariance.row(row))));
  }
  Value name_values = Value::Array();
  for (const std::string& name : names) name_values.Append(name);
  return Value::Object().Set("names", name_values).Set("matrix", matrix);
}

// What `calibrate camera` writes of one pinhole.
ResultFolder Pinhole(const Eigen::Vector4d& fu_fv_pu_pv, const Eigen::Matrix4d& covariance) {
  const CameraModel model("pinhole-none", fu_fv_pu_pv);
  ResultFolder folder;
  folder.name = "recording";
  folder.result.Set("kind", "camera")
      .Set("verdict", "pass")
      .Set("cameras", Value::Array().Append(Value::Object()
                                                .Set("model", "pinhole-none")
                                                .Set("intrinsics", Value::Numbers(fu_fv_pu_pv))
                                                .Set("distortion", Value::Array())
                                                .Set("T_cn_cnm1", Value())))
      .Set("covariance", CovarianceValue({"cam0.fu", "cam0.fv", "cam0.pu", "cam0.pv"}, covariance));
  folder.chain = ToValue(std::vector<Camera>{{model, {640, 480}, "/cam0/image_raw", {}}});
  return folder;
}

// What `calibrate camera-imu` writes of one camera; sigmas of 1 mrad, 1 mm, 0.1 ms.
ResultFolder OnImu(const Rigid3& T_c_i, double time_offset_s, double fu = 600.0) {
  ResultFolder folder;
  folder.name = "recording";
  Eigen::VectorXd variances(7);
  variances << 1e-6, 1e-6, 1e-6, 1e-6, 1e-6, 1e-6, 1e-8;
  const Imu imu;
  folder.result.Set("kind", "camera-imu")
      .Set("verdict", "pass")
      .Set(
          "cameras",
          Value::Array().Append(
              Value::Object().Set("T_cam_imu", ToValue(T_c_i)).Set("time_offset_s", time_offset_s)))
      .Set("imus",
           Value::Array().Append(
               Value::Object()
                   .Set("gyro_bias", Value::Numbers(Eigen::Vector3d(0.01, 0.0, time_offset_s)))
                   .Set("accel_bias", Value::Numbers(Eigen::Vector3d(0.1, 0.0, 0.0)))))
      .Set("gravity_g", Value::Numbers(Eigen::Vector3d(0.0, 0.0, -9.8)))
      .Set("covariance", CovarianceValue({"cam0.rot_x", "cam0.rot_y", "cam0.rot_z", "cam0.pos_x",
                                          "cam0.pos_y", "cam0.pos_z", "cam0.time_offset"},
                                         variances.asDiagonal()));
  folder.chain = ToValue(
      std::vector<Camera>{{CameraModel("pinhole-none", Eigen::Vector4d(fu, 600.0, 320.0, 240.0)),
                           {640, 480},
                           "/cam0/image_raw",
                           {}}});
  folder.imus = ToValue(std::vector<Imu>{imu});
  return folder;
}

TEST(MergeResults, WeighsByHand) {
  // fu 600 and 603 px with sigmas of 1 and 2 px: weights 1 and 1/4.
  Eigen::Matrix4d wide = Eigen::Matrix4d::Identity();
  wide(0, 0) = 4.0;
  const MergedDocuments merged =
      MergeResults({Pinhole({600.0, 600.0, 320.0, 240.0}, Eigen::Matrix4d::Identity()),
                    Pinhole({603.0, 600.0, 320.0, 240.0}, wide)});
  const Value& camera = merged.result.At("cameras").elements()[0];
  EXPECT_NEAR(camera.At("intrinsics").AsDoubles()[0], 600.0 + 3.0 * 0.25 / 1.25, 1e-9);
  EXPECT_NEAR(camera.At("intrinsics_sigma").AsDoubles()[0], std::sqrt(1.0 / 1.25), 1e-9);
  EXPECT_NEAR(camera.At("intrinsics_sigma").AsDoubles()[1], std::sqrt(0.5), 1e-9);
  const Value& group = merged.result.At("groups").elements()[0];
  EXPECT_NEAR(group.At("statistic").AsDouble(), 9.0 / 5.0, 1e-9);
  EXPECT_EQ(group.At("degrees_of_freedom").AsDouble(), 4.0);
  EXPECT_EQ(group.At("sigma_scale").AsDouble(), 1.0);
  const Value& fu = group.At("parameters").elements()[0];
  EXPECT_NEAR(fu.At("repeatability").AsDouble(), 3.0 / std::sqrt(2.0), 1e-9);
  EXPECT_NEAR(fu.At("stated_sigma").AsDouble(), std::sqrt(2.5), 1e-9);
  EXPECT_EQ(merged.result.At("verdict").AsString(), "pass");
  // The chain says the same.
  const std::vector<Camera> chain = CameraChainFromValue(merged.chain, nullptr);
  EXPECT_NEAR(chain[0].model.focal_and_centre()(0), 600.6, 1e-9);
}

TEST(MergeResults, MakesSigmasWiderWhereResultsScatterAndSaysSo) {
  const Eigen::Matrix4d covariance = Eigen::Matrix4d::Identity();
  const MergedDocuments merged = MergeResults({Pinhole({600.0, 600.0, 320.0, 240.0}, covariance),
                                               Pinhole({620.0, 600.0, 320.0, 240.0}, covariance)});
  const Value& group = merged.result.At("groups").elements()[0];
  // Squared distances of 10 px each on 4 degrees of freedom.
  EXPECT_NEAR(group.At("sigma_scale").AsDouble(), std::sqrt(200.0 / 4.0), 1e-9);
  EXPECT_NEAR(merged.result.At("cameras").elements()[0].At("intrinsics_sigma").AsDoubles()[1],
              std::sqrt(0.5 * 50.0), 1e-9);
  EXPECT_EQ(merged.result.At("verdict").AsString(), "warn");
  EXPECT_NE(MergeText(merged.result).find("7.1 times as far"), std::string::npos);
}

TEST(MergeResults, OfPosesTurnsHalfWay) {
  const Rigid3 first{ExpSo3({0.3, -0.2, 1.0}), {0.05, 0.0, 0.01}};
  Eigen::Vector<double, 6> delta;
  delta << 0.0, 0.001, 0.0, 0.002, 0.0, 0.0;
  const MergedDocuments merged =
      MergeResults({OnImu(first, 0.007), OnImu(first.Perturbed(delta), 0.0072)});
  const Value& camera = merged.result.At("cameras").elements()[0];
  const Rigid3 T = Rigid3FromValue(camera.At("T_cam_imu"));
  EXPECT_LT((T.DifferenceTo(first) - 0.5 * delta).norm(), 1e-12);
  EXPECT_NEAR(camera.At("time_offset_s").AsDouble(), 0.0071, 1e-12);
  EXPECT_NEAR(merged.chain.At("cam0").At("timeshift_cam_imu").AsDouble(), 0.0071, 1e-12);
  EXPECT_LT(Rigid3FromValue(merged.chain.At("cam0").At("T_cam_imu")).DifferenceTo(T).norm(), 1e-12);
  EXPECT_NEAR(merged.result.At("imus").elements()[0].At("gyro_bias").AsDoubles()[2], 0.0071, 1e-12);
  EXPECT_EQ(merged.result.At("groups").elements()[0].At("name").AsString(), "cam0 pose");
  // Merged results merge and compare again.
  ResultFolder again{"merged", merged.result, merged.chain, merged.imus};
  EXPECT_EQ(CalibrationKind(again.result), "camera-imu");
  EXPECT_EQ(ParametersOf(again.result, &again.chain).groups.size(), 2U);
}

// The names are the estimator's own: all that it estimates of two cameras with line delays and two
// IMUs with every fault comes back half-way between two results.
TEST(MergeResults, OfImusWithFaultsTakesEachParameterByItsName) {
  CameraImuProblem problem;
  const CameraModel lens("pinhole-none", Eigen::Vector4d(600.0, 600.0, 320.0, 240.0));
  problem.cameras = {{lens, {}, IntrinsicsKnowledge::kExact, {}},
                     {lens, {}, IntrinsicsKnowledge::kExact, {}}};
  problem.imus = {{{}, {}, ImuModelKind::kScaleMisalignmentSizeEffect},
                  {{}, {}, ImuModelKind::kScaleMisalignment}};
  problem.estimate_line_delays = true;
  const std::vector<std::string> names = CameraImuLayout(problem, 6).names;
  const Eigen::MatrixXd covariance =
      1e-4 * Eigen::MatrixXd::Identity(static_cast<Eigen::Index>(names.size()),
                                       static_cast<Eigen::Index>(names.size()));
  Rng rng(9);
  const auto folder = [&] {
    const auto small = [&] {
      Eigen::Vector3d x;
      for (int k = 0; k < 3; ++k) x(k) = 0.01 * rng.Normal();
      return x;
    };
    ResultFolder made;
    made.name = "recording";
    Value cameras = Value::Array();
    Value imus = Value::Array();
    std::vector<Camera> chain;
    for (int n = 0; n < 2; ++n) {
      cameras.Append(Value::Object()
                         .Set("T_cam_imu", ToValue(Rigid3{ExpSo3(small()), small()}))
                         .Set("time_offset_s", small().x())
                         .Set("line_delay_s", 1e-3 * small().x()));
      chain.push_back({lens, {640, 480}, "/cam" + std::to_string(n), {}});
    }
    std::vector<Imu> in_yaml;
    for (const CameraImuImu& imu : problem.imus) {
      ImuIntrinsics faults;
      faults.M_accel += Eigen::Matrix3d(small().asDiagonal());
      faults.M_accel(2, 0) = small().x();
      faults.M_gyro += Eigen::Matrix3d(small().asDiagonal());
      faults.M_gyro(1, 0) = small().x();
      faults.R_gyro_i = ExpSo3(small());
      faults.g_sensitivity.row(1) = 0.01 * small().transpose();
      if (imu.model == ImuModelKind::kScaleMisalignmentSizeEffect) {
        faults.lever_arms_i.col(1) = small();
        faults.lever_arms_i.col(2) = small();
      }
      Value value = Value::Object();
      value.Set("model", ImuModelName(imu.model))
          .Set("gyro_bias", Value::Numbers(small()))
          .Set("accel_bias", Value::Numbers(small()))
          .Set("T_i_imu", ToValue(in_yaml.empty() ? Rigid3{} : Rigid3{ExpSo3(small()), small()}))
          .Set("time_offset_s", in_yaml.empty() ? 0.0 : small().x());
      SetImuIntrinsics(faults, imu.model, &value);
      imus.Append(value);
      Imu entry;
      entry.model = imu.model;
      in_yaml.push_back(entry);
    }
    made.result.Set("kind", "camera-imu")
        .Set("cameras", cameras)
        .Set("imus", imus)
        .Set("gravity_g", Value::Numbers(Eigen::Vector3d(0.0, 0.0, -9.8)))
        .Set("covariance", CovarianceValue(names, covariance));
    made.chain = ToValue(chain);
    made.imus = ToValue(in_yaml);
    return made;
  };
  const ResultFolder first = folder();
  const ResultFolder second = folder();
  const MergedDocuments merged = MergeResults({first, second});
  const ResultParameters a = ParametersOf(first.result, &first.chain);
  const ResultParameters b = ParametersOf(second.result, &second.chain);
  const ResultParameters middle = ParametersOf(merged.result, &merged.chain);
  // Two poses, offsets and delays, the other IMU's pose and offset, both IMUs' axes.
  ASSERT_EQ(middle.groups.size(), 10U);
  Eigen::Index num_parameters = 0;
  for (size_t g = 0; g < middle.groups.size(); ++g) {
    SCOPED_TRACE(middle.groups[g].name);
    num_parameters += middle.groups[g].size();
    const Eigen::VectorXd whole = b.groups[g].DifferenceTo(a.groups[g]);
    const Eigen::VectorXd half = middle.groups[g].DifferenceTo(a.groups[g]);
    EXPECT_GT(whole.cwiseAbs().maxCoeff(), 0.0);
    EXPECT_LT((half - 0.5 * whole).cwiseAbs().maxCoeff(), 1e-12);
  }
  // All that the estimator has, but gravity's two.
  EXPECT_EQ(num_parameters, static_cast<Eigen::Index>(names.size()) - 2);
  // imu.yaml has the same faults as result.json.
  const std::vector<Imu> imus = ImusFromValue(merged.imus, nullptr);
  const ImuIntrinsics in_result =
      ImuIntrinsicsFromValue(merged.result.At("imus").elements()[0], nullptr);
  EXPECT_EQ(imus[0].intrinsics.M_accel, in_result.M_accel);
  EXPECT_EQ(imus[0].intrinsics.lever_arms_i, in_result.lever_arms_i);
  const Rigid3 T_i_imu = Rigid3FromValue(merged.result.At("imus").elements()[1].At("T_i_imu"));
  EXPECT_LT(imus[1].T_i_b.Inverse().DifferenceTo(T_i_imu).norm(), 1e-12);
}

TEST(MergeResults, RefusesWhatIsNotOfOneRig) {
  const Eigen::Matrix4d covariance = Eigen::Matrix4d::Identity();
  const ResultFolder camera = Pinhole({600.0, 600.0, 320.0, 240.0}, covariance);
  const ResultFolder on_imu = OnImu(Rigid3{}, 0.0);
  EXPECT_THROW((void)MergeResults({camera}), InputError);
  EXPECT_THROW((void)MergeResults({camera, on_imu}), InputError);
  EXPECT_THROW((void)MergeResults({on_imu, OnImu(Rigid3{}, 0.0, 601.0)}), InputError);
  ResultFolder without = camera;
  without.result.Set("covariance", CovarianceValue({}, {}));
  EXPECT_THROW((void)MergeResults({camera, without}), InputError);
  // Held at different values.
  Eigen::Matrix4d held = covariance;
  held(2, 2) = 0.0;
  EXPECT_THROW((void)MergeResults({Pinhole({600.0, 600.0, 320.0, 240.0}, held),
                                   Pinhole({600.0, 600.0, 321.0, 240.0}, held)}),
               InputError);
  EXPECT_NO_THROW((void)MergeResults(
      {Pinhole({600.0, 600.0, 320.0, 240.0}, held), Pinhole({601.0, 600.0, 320.0, 240.0}, held)}));
}

std::string ErrorOf(const std::vector<ResultFolder>& folders) {
  try {
    (void)MergeResults(folders);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(MergeResults, RefusesFilesThatAreNotOfOneCalibration) {
  const ResultFolder good = OnImu(Rigid3{}, 0.0);
  ASSERT_EQ(ErrorOf({good, good}), "");
  std::vector<Camera> cameras = CameraChainFromValue(good.chain, nullptr);
  cameras.push_back(cameras.front());
  ResultFolder more_cameras = good;
  more_cameras.chain = ToValue(cameras);
  ResultFolder more_imus = good;
  more_imus.imus = ToValue(std::vector<Imu>(2));
  ResultFolder alone = Pinhole({600.0, 600.0, 320.0, 240.0}, Eigen::Matrix4d::Identity());
  alone.chain = ToValue(cameras);
  for (const auto& [folder, file] :
       {std::pair(more_cameras, "camchain-imucam.yaml"), std::pair(more_imus, "imu.yaml"),
        std::pair(alone, "camchain.yaml")}) {
    const std::string said =
        std::string("result.json and ") + file + " are not of one calibration, recording: 1 and 2";
    // Both alike, so that nothing but the folder itself tells.
    EXPECT_NE(ErrorOf({folder, folder}).find(said), std::string::npos)
        << file << ": " << ErrorOf({folder, folder});
  }
}

TEST(MergeResults, RefusesDifferentCameras) {
  const CameraModel lens("pinhole-none", Eigen::Vector4d(600.0, 600.0, 320.0, 240.0));
  const CameraModel omni("omni-none", Eigen::Vector<double, 5>(1.0, 600.0, 600.0, 320.0, 240.0));
  const ResultFolder first = Pinhole({600.0, 600.0, 320.0, 240.0}, Eigen::Matrix4d::Identity());
  const auto with = [](ResultFolder folder, const CameraModel& model,
                       const Resolution& resolution) {
    folder.chain = ToValue(std::vector<Camera>{{model, resolution, "/cam0/image_raw", {}}});
    return folder;
  };
  // A lens that was estimated along may differ, its model and its images may not.
  ResultFolder along = OnImu(Rigid3{}, 0.0);
  const std::vector<std::string> names = {
      "cam0.rot_x", "cam0.rot_y", "cam0.rot_z", "cam0.pos_x", "cam0.pos_y",      "cam0.pos_z",
      "cam0.fu",    "cam0.fv",    "cam0.pu",    "cam0.pv",    "cam0.time_offset"};
  along.result.Set("covariance", CovarianceValue(names, 1e-6 * Eigen::MatrixXd::Identity(11, 11)));
  const std::string what = "the results are of different cameras";
  for (const ResultFolder& folder : {first, along}) {
    EXPECT_EQ(ErrorOf({folder, with(folder, lens, {640, 480})}), "");
    EXPECT_NE(ErrorOf({folder, with(folder, lens, {1280, 960})}).find(what), std::string::npos);
  }
  EXPECT_NE(ErrorOf({first, with(first, omni, {640, 480})}).find(what), std::string::npos);
  ResultFolder two = first;
  const Value camera = first.result.At("cameras").elements()[0];
  two.result.Set("cameras", Value::Array().Append(camera).Append(camera));
  two.chain = ToValue(std::vector<Camera>(2, {lens, {640, 480}, "/cam0/image_raw", {}}));
  EXPECT_NE(ErrorOf({first, two}).find(what), std::string::npos);
}

TEST(MergeResults, SaysOfWhatWasHeldNothingAboutItsScatter) {
  // Rotation and time offset held: a rotation less itself is zero but for rounding.
  const std::vector<std::string> names = {"cam0.rot_x",      "cam0.rot_y", "cam0.rot_z",
                                          "cam0.pos_x",      "cam0.pos_y", "cam0.pos_z",
                                          "cam0.time_offset"};
  Eigen::VectorXd variances = Eigen::VectorXd::Zero(7);
  variances.segment<3>(3).setConstant(1e-6);
  const auto held = [&](const Rigid3& T_c_i) {
    ResultFolder folder = OnImu(T_c_i, 0.007);
    folder.result.Set("covariance", CovarianceValue(names, variances.asDiagonal()));
    return folder;
  };
  const Eigen::Matrix3d R = ExpSo3({0.3, -0.2, 1.0});
  const Eigen::Matrix3d rounded = ExpSo3({1e-15, 0.0, 0.0}) * R;
  const MergedDocuments merged =
      MergeResults({held({R, {0.05, 0.0, 0.01}}), held({rounded, {0.052, 0.0, 0.01}})});
  const Value& offset = merged.result.At("groups").elements()[1];
  EXPECT_EQ(offset.At("name").AsString(), "cam0 time offset");
  for (const char* key : {"probability", "statistic", "degrees_of_freedom"}) {
    EXPECT_EQ(offset.Find(key), nullptr) << key;
  }
  EXPECT_NE(MergeText(merged.result).find("cam0 time offset\n"), std::string::npos);
  // A microradian is more than rounding.
  EXPECT_NE(ErrorOf({held({R, {0.05, 0.0, 0.01}}),
                     held({ExpSo3({1e-6, 0.0, 0.0}) * R, {0.05, 0.0, 0.01}})})
                .find("rot_x was held at"),
            std::string::npos);
}

TEST(MergeResults, KeepsTheVerdictOfAResultThatIsNotToBeTrusted) {
  const Eigen::Matrix4d covariance = Eigen::Matrix4d::Identity();
  ResultFolder failed = Pinhole({600.0, 600.0, 320.0, 240.0}, covariance);
  failed.result.Set("verdict", "fail");
  failed.name = "bad-one";
  const MergedDocuments merged =
      MergeResults({Pinhole({600.0, 600.0, 320.0, 240.0}, covariance), failed});
  EXPECT_EQ(merged.result.At("verdict").AsString(), "fail");
  EXPECT_NE(MergeText(merged.result).find("bad-one"), std::string::npos);
}

// Results that scatter as they state, and three times as far: the merged covariance is true to the
// first, and in the second not much too small, which it is ninefold where nobody looks.
TEST(MergeResults, CoversTheTruthWhetherResultsScatterAsStatedOrMore) {
  const int n = FullSample() ? 2000 : 200;
  constexpr int kNumResults = 6;
  const Rng rng(3);
  const Eigen::Vector4d truth(600.0, 601.0, 320.0, 240.0);
  for (const double scatter : {1.0, 3.0}) {
    double sum = 0.0;
    int num_scaled = 0;
    for (int trial = 0; trial < n; ++trial) {
      Rng draws = rng.Stream("trial", static_cast<uint64_t>(trial));
      std::vector<ResultFolder> folders;
      for (int i = 0; i < kNumResults; ++i) {
        // Focal lengths go together, as they do in calibrations.
        Eigen::Matrix4d root = Eigen::Vector4d(1.0, 1.0, 0.5, 0.5).asDiagonal();
        root(1, 0) = 0.8 + 0.1 * i;
        const Eigen::Vector4d noise(draws.Normal(), draws.Normal(), draws.Normal(), draws.Normal());
        folders.push_back(
            Pinhole(truth + scatter * root * noise, Eigen::Matrix4d(root * root.transpose())));
      }
      const MergedDocuments merged = MergeResults(folders);
      const ResultParameters parameters = ParametersOf(merged.result, nullptr);
      const Eigen::Vector4d error = parameters.groups[0].values - truth;
      sum += error.dot(parameters.covariance.ldlt().solve(error));
      num_scaled += merged.result.At("groups").elements()[0].At("sigma_scale").AsDouble() > 1.0;
    }
    const double nees = sum / n / 4.0;
    std::printf("scatter %.0f: mean NEES over its expectation %.3f, %d of %d scaled\n", scatter,
                nees, num_scaled, n);
    // Chi-square with 4 degrees of freedom over 4 has variance 1/2. Scaled by an estimate from 20
    // degrees of freedom, it is 4 F(4, 20): mean 20 / 18.
    const double expected = scatter == 1.0 ? 1.0 : 20.0 / 18.0;
    EXPECT_NEAR(nees, expected, 4.0 * std::sqrt(0.8 / n));
    if (scatter == 1.0) {
      EXPECT_LE(num_scaled, 0.0027 * n + 4.0 * std::sqrt(0.0027 * n) + 1.0);
    } else {
      EXPECT_GE(num_scaled, 0.99 * n);
    }
  }
}

}  // namespace
}  // namespace calibrato
