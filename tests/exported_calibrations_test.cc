// What `calibrato export` writes of a calibration, read back by the parsers that those programs use
// (OpenCV's FileStorage, a JSON library, yaml-cpp), and points projected by their own formulas,
// written down here anew.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <Eigen/Geometry>
#include <cmath>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "calibrato/base/input_error.h"
#include "calibrato/base/rng.h"
#include "calibrato/cli/program_for_test.h"
#include "calibrato/geometry/so3.h"
#include "calibrato/sensors/camera_chain.h"
#include "calibrato/sensors/foreign_calibration.h"
#include "calibrato/sensors/imu_file.h"

namespace calibrato {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix4d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using testing::HasSubstr;

constexpr double kTimeOffset = 0.0073;  // [s]
constexpr double kGravity = 9.8123;     // [m/s^2]
const Vector3d kGyroBias(0.01, -0.02, 0.003);
const Vector3d kAccelBias(0.1, 0.05, -0.2);

Eigen::VectorXd Vector(const std::vector<double>& numbers) {
  return Eigen::Map<const Eigen::VectorXd>(numbers.data(),
                                           static_cast<Eigen::Index>(numbers.size()));
}

const Rigid3& PoseOf(size_t camera) {
  static const std::vector<Rigid3> poses = {{ExpSo3({1.2, -1.1, 1.25}), {0.052, -0.031, 0.024}},
                                            {ExpSo3({1.21, -1.08, 1.24}), {-0.058, -0.03, 0.026}}};
  return poses[camera];
}

Imu PlainImu() {
  Imu imu;
  imu.noise = {200.0, 2.1e-3, 3.2e-4, 1.7e-4, 2e-5};
  return imu;
}

// The folder of a camera-IMU calibration with cameras of this model.
std::string WriteResult(const ScratchFolder& scratch, const std::vector<CameraModel>& models,
                        const Imu& imu, const std::string& verdict = "pass") {
  std::vector<Camera> cameras;
  Value in_result = Value::Array();
  for (size_t n = 0; n < models.size(); ++n) {
    cameras.push_back({models[n], {752, 480}, "/cam" + std::to_string(n) + "/image_raw", {}});
    if (n > 0) cameras[n].T_cn_cnm1 = PoseOf(n) * PoseOf(n - 1).Inverse();
    in_result.Append(Value::Object().Set("T_cam_imu", ToValue(PoseOf(n))));
  }
  Value chain = ToValue(cameras);
  for (size_t n = 0; n < models.size(); ++n) {
    const std::string name = "cam" + std::to_string(n);
    Value camera = chain.At(name);
    camera.Set("T_cam_imu", ToValue(PoseOf(n))).Set("timeshift_cam_imu", kTimeOffset);
    chain.Set(name, camera);
  }
  Value result = Value::Object();
  result.Set("kind", "camera-imu")
      .Set("verdict", verdict)
      .Set("cameras", in_result)
      .Set("imus", Value::Array().Append(Value::Object()
                                             .Set("gyro_bias", Value::Numbers(kGyroBias))
                                             .Set("accel_bias", Value::Numbers(kAccelBias))))
      .Set("gravity_g", Value::Numbers(Vector3d(0.0, kGravity, 0.0)));
  (void)scratch.Write("result/camchain-imucam.yaml", ToYaml(chain));
  (void)scratch.Write("result/imu.yaml", ToYaml(ToValue(std::vector<Imu>{imu})));
  (void)scratch.Write("result/result.json", ToJson(result));
  return scratch.Path("result");
}

ForeignFiles FilesOf(const std::string& folder, const std::string& format) {
  const Value result = ReadJson(folder + "/result.json");
  const Value chain = ReadYaml(folder + "/camchain-imucam.yaml");
  const Value imus = ReadYaml(folder + "/imu.yaml");
  const auto found = FindCalibrationFormat(format);
  if (!found) throw std::invalid_argument(format);
  return FilesFor(*found, RigCalibrationFromValues(result, chain, &imus), 20.0);
}

// The folder that the files were written to.
std::string Export(const ScratchFolder& scratch, const std::vector<CameraModel>& models,
                   const Imu& imu, const std::string& format) {
  for (const auto& [name, content] : FilesOf(WriteResult(scratch, models, imu), format).content) {
    (void)scratch.Write("exported/" + name, content);
  }
  return scratch.Path("exported") + "/";
}

void ExpectRefused(const std::vector<CameraModel>& models, const Imu& imu,
                   const std::string& format, const std::string& why) {
  const ScratchFolder scratch;
  const std::string folder = WriteResult(scratch, models, imu);
  try {
    (void)FilesOf(folder, format);
    ADD_FAILURE() << format << " was written";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr(why));
  }
}

const CameraModel kRadtan("pinhole-radtan",
                          Vector({458.65, 457.3, 367.2, 248.4, -0.283, 0.074, 1.9e-4, 1.8e-5}));
const CameraModel kOtherRadtan("pinhole-radtan",
                               Vector({457.6, 456.1, 379.9, 255.2, -0.284, 0.07, -1e-4, -3e-5}));
const CameraModel kEqui("pinhole-equi",
                        Vector({190.97, 190.9, 254.9, 256.8, 3.4e-3, 7e-4, -2e-3, 2e-4}));
const CameraModel kOmni("omni-radtan",
                        Vector({1.2, 780.0, 781.0, 370.0, 245.0, -0.1, 0.02, 1e-4, -2e-4}));

// Formulas --------------------------------------------------------------------------------------

Vector2d Brown(const Vector2d& x, double k1, double k2, double p1, double p2, double k3 = 0.0) {
  const double r2 = x.squaredNorm();
  const double radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
  return {x.x() * radial + 2.0 * p1 * x.x() * x.y() + p2 * (r2 + 2.0 * x.x() * x.x()),
          x.y() * radial + p1 * (r2 + 2.0 * x.y() * x.y()) + 2.0 * p2 * x.x() * x.y()};
}

Vector2d Fisheye(const Vector3d& p, double k1, double k2, double k3, double k4) {
  const double r = p.head<2>().norm();
  const double a = std::atan2(r, p.z());
  const double a2 = a * a;
  const double d = a * (1.0 + a2 * (k1 + a2 * (k2 + a2 * (k3 + a2 * k4))));
  return p.head<2>() * (d / r);
}

using Projection = std::function<Vector2d(const Vector3d& p_c)>;

// Points of the IMU's frame land on the same pixels as ours by T_imu_cam and formula of the other
// program, and pixels' rays point the same way in the IMU's frame.
void ExpectSameCamera(const CameraModel& ours, const Rigid3& T_c_i, const Matrix4d& T_imu_cam,
                      const Projection& project, double tolerance_px) {
  Rng rng(1);
  const Matrix3d R_i_c = T_imu_cam.topLeftCorner<3, 3>();
  const Vector3d t_i_c = T_imu_cam.topRightCorner<3, 1>();
  int num_seen = 0;
  for (int i = 0; i < 200; ++i) {
    const Vector2d pixel(rng.Uniform(50.0, 700.0), rng.Uniform(50.0, 430.0));
    const auto ray = ours.Unproject(pixel);
    if (!ray) continue;
    ++num_seen;
    const Vector3d p_i = T_c_i.Inverse() * (rng.Uniform(0.3, 5.0) * ray->normalized());
    const Vector3d p_c = R_i_c.transpose() * (p_i - t_i_c);
    EXPECT_LT((project(p_c) - pixel).norm(), tolerance_px);
    EXPECT_LT((R_i_c * *ray - T_c_i.R.transpose() * *ray).norm(), 1e-6 * ray->norm());
  }
  EXPECT_GT(num_seen, 100);
}

Matrix4d FromOpenCv(const cv::FileNode& node) {
  cv::Mat matrix;
  node >> matrix;
  matrix.convertTo(matrix, CV_64F);
  return Eigen::Map<Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(matrix.ptr<double>());
}

// Rows of rows, as Kalibr and OpenVINS write matrices.
Eigen::MatrixXd FromRows(const cv::FileNode& node) {
  Eigen::MatrixXd matrix(static_cast<Eigen::Index>(node.size()),
                         static_cast<Eigen::Index>(node[0].size()));
  for (int row = 0; row < matrix.rows(); ++row) {
    for (int column = 0; column < matrix.cols(); ++column) {
      matrix(row, column) = node[row][column].real();
    }
  }
  return matrix;
}

std::vector<double> Numbers(const cv::FileNode& node) {
  std::vector<double> numbers;
  for (const cv::FileNode& number : node) numbers.push_back(number.real());
  return numbers;
}

// OpenVINS --------------------------------------------------------------------------------------

TEST(ExportedCalibration, IsReadByOpenVins) {
  const ScratchFolder scratch;
  const std::string out = Export(scratch, {kRadtan, kEqui}, PlainImu(), "openvins");
  const cv::FileStorage chain(out + "kalibr_imucam_chain.yaml", cv::FileStorage::READ);
  const std::vector<CameraModel> models = {kRadtan, kEqui};
  for (size_t n = 0; n < 2; ++n) {
    const cv::FileNode camera = chain["cam" + std::to_string(n)];
    const std::vector<double> f = Numbers(camera["intrinsics"]);
    const std::vector<double> d = Numbers(camera["distortion_coeffs"]);
    ASSERT_EQ(f.size(), 4U);
    ASSERT_EQ(d.size(), 4U);
    const bool is_fisheye = std::string(camera["distortion_model"]) == "equidistant";
    EXPECT_EQ(is_fisheye, n == 1);
    ExpectSameCamera(
        models[n], PoseOf(n), FromRows(camera["T_imu_cam"]),
        [&](const Vector3d& p) -> Vector2d {
          const Vector2d x = is_fisheye ? Fisheye(p, d[0], d[1], d[2], d[3])
                                        : Brown(p.head<2>() / p.z(), d[0], d[1], d[2], d[3]);
          return {f[0] * x.x() + f[2], f[1] * x.y() + f[3]};
        },
        1e-6);
    EXPECT_EQ(static_cast<double>(camera["timeshift_cam_imu"]), kTimeOffset);
    EXPECT_EQ(Numbers(camera["resolution"]), (std::vector<double>{752.0, 480.0}));
  }
  const cv::FileStorage imus(out + "kalibr_imu_chain.yaml", cv::FileStorage::READ);
  const cv::FileNode imu = imus["imu0"];
  EXPECT_EQ(imu["accelerometer_noise_density"].real(), 2.1e-3);
  EXPECT_EQ(imu["accelerometer_random_walk"].real(), 3.2e-4);
  EXPECT_EQ(imu["gyroscope_noise_density"].real(), 1.7e-4);
  EXPECT_EQ(imu["gyroscope_random_walk"].real(), 2e-5);
  EXPECT_EQ(FromRows(imu["Tw"]), Eigen::MatrixXd::Identity(3, 3));
  EXPECT_EQ(FromRows(imu["Tg"]), Eigen::MatrixXd::Zero(3, 3));
  const cv::FileStorage estimator(out + "estimator_config.yaml", cv::FileStorage::READ);
  EXPECT_EQ(static_cast<int>(estimator["max_cameras"]), 2);
  EXPECT_NEAR(static_cast<double>(estimator["gravity_mag"]), kGravity, 1e-12);
  for (const char* key : {"relative_config_imu", "relative_config_imucam"}) {
    EXPECT_TRUE(std::filesystem::exists(out + std::string(estimator[key]))) << key;
  }
  EXPECT_EQ(static_cast<int>(estimator["max_clones"]), 11);
  // It ends where one of its keys is missing; one of each of its parts.
  for (const char* key : {"use_fej", "integration", "calib_imu_intrinsics", "init_dyn_min_deg",
                          "num_opencv_threads", "track_frequency"}) {
    EXPECT_FALSE(estimator[key].empty()) << key;
  }
  EXPECT_EQ(std::string(estimator["integration"]), "rk4");
}

// w_m = Tw R_IMUtoGYRO w + Tg f + b and a_m = Ta R_IMUtoACC f + b give what our IMU reads.
TEST(ExportedCalibration, OfAFaultyImuReadsTheSameInOpenVins) {
  Imu imu = PlainImu();
  imu.model = ImuModelKind::kScaleMisalignment;
  imu.intrinsics.M_accel << 1.01, 0.0, 0.0, 0.004, 0.99, 0.0, -0.003, 0.002, 1.005;
  imu.intrinsics.M_gyro << 0.98, 0.0, 0.0, 0.001, 1.02, 0.0, 0.002, -0.006, 1.01;
  imu.intrinsics.R_gyro_i = ExpSo3({0.02, -0.01, 0.03});
  imu.intrinsics.g_sensitivity << 1e-3, 2e-4, 0.0, -1e-4, 5e-4, 3e-4, 2e-4, 0.0, 7e-4;
  const ScratchFolder scratch;
  const std::string out = Export(scratch, {kRadtan}, imu, "openvins");
  const cv::FileStorage file(out + "kalibr_imu_chain.yaml", cv::FileStorage::READ);
  const cv::FileNode entry = file["imu0"];
  ImuMotion motion{ExpSo3({0.3, -0.4, 0.2}), {0.5, -0.7, 1.1}, {1.0, 2.0, -1.5}, {0.4, 1.2, -0.6}};
  const Vector3d gravity_w(0.0, 0.0, -kGravity);
  const Vector3d f = SpecificForce(motion, gravity_w);
  const Vector3d rates = FromRows(entry["Tw"]) * FromRows(entry["R_IMUtoGYRO"]) * motion.omega_i +
                         FromRows(entry["Tg"]) * f + kGyroBias;
  const Vector3d forces = FromRows(entry["Ta"]) * FromRows(entry["R_IMUtoACC"]) * f + kAccelBias;
  EXPECT_LT((rates - PredictGyro(motion, gravity_w, imu.intrinsics, kGyroBias)).norm(), 1e-12);
  EXPECT_LT((forces - PredictAccel(motion, gravity_w, imu.intrinsics, kAccelBias)).norm(), 1e-12);
  for (const char* format : {"vins-fusion", "basalt", "orb-slam3"}) {
    ExpectRefused({kEqui}, imu, format, "scale-misalignment");
  }
  imu.model = ImuModelKind::kScaleMisalignmentSizeEffect;
  ExpectRefused({kRadtan}, imu, "openvins", "scale-misalignment-size-effect");
}

// VINS-Fusion -----------------------------------------------------------------------------------

TEST(ExportedCalibration, IsReadByVinsFusion) {
  const std::vector<CameraModel> lenses = {kRadtan, kEqui, kOmni};
  for (const CameraModel& lens : lenses) {
    SCOPED_TRACE(lens.name());
    const ScratchFolder scratch;
    const std::string out = Export(scratch, {lens, lens}, PlainImu(), "vins-fusion");
    const cv::FileStorage rig(out + "vins_fusion.yaml", cv::FileStorage::READ);
    EXPECT_EQ(static_cast<int>(rig["imu"]), 1);
    EXPECT_EQ(static_cast<int>(rig["num_of_cam"]), 2);
    EXPECT_EQ(static_cast<double>(rig["td"]), kTimeOffset);
    EXPECT_NEAR(static_cast<double>(rig["g_norm"]), kGravity, 1e-12);
    // A step of 1/200 s weighs two samples by half of it each, their noise independent: over a
    // second the variances add up to the squared density.
    const double half_step = 0.5 / 200.0;
    const auto gained_in_a_second = [&](const char* key) {
      return 200.0 * 2.0 * std::pow(half_step * static_cast<double>(rig[key]), 2);
    };
    EXPECT_NEAR(std::sqrt(gained_in_a_second("acc_n")), 2.1e-3, 1e-15);
    EXPECT_NEAR(std::sqrt(gained_in_a_second("gyr_n")), 1.7e-4, 1e-15);
    // A bias that steps by acc_w * dt spreads like one with random walk acc_w / sqrt(200 Hz).
    EXPECT_NEAR(static_cast<double>(rig["acc_w"]) / 200.0 * std::sqrt(200.0), 3.2e-4, 1e-15);
    EXPECT_NEAR(static_cast<double>(rig["gyr_w"]) / 200.0 * std::sqrt(200.0), 2e-5, 1e-15);
    for (size_t n = 0; n < 2; ++n) {
      const std::string name = "cam" + std::to_string(n);
      const cv::FileStorage file(out + std::string(rig[name + "_calib"]), cv::FileStorage::READ);
      EXPECT_EQ(static_cast<int>(file["image_width"]), 752);
      EXPECT_EQ(static_cast<int>(file["image_height"]), 480);
      const std::string type(file["model_type"]);
      const cv::FileNode f = file["projection_parameters"];
      const cv::FileNode d = file["distortion_parameters"];
      const auto of = [](const cv::FileNode& node, const char* key) {
        EXPECT_FALSE(node[key].empty()) << key;
        return node[key].real();
      };
      const auto project = [&](const Vector3d& p) -> Vector2d {
        if (type == "KANNALA_BRANDT") {
          const Vector2d x = Fisheye(p, of(f, "k2"), of(f, "k3"), of(f, "k4"), of(f, "k5"));
          return {of(f, "mu") * x.x() + of(f, "u0"), of(f, "mv") * x.y() + of(f, "v0")};
        }
        const bool is_mirror = type == "MEI";
        const double xi = is_mirror ? of(file["mirror_parameters"], "xi") : 0.0;
        const Vector2d x = Brown(p.head<2>() / (p.z() + xi * p.norm()), of(d, "k1"), of(d, "k2"),
                                 of(d, "p1"), of(d, "p2"));
        return is_mirror
                   ? Vector2d(of(f, "gamma1") * x.x() + of(f, "u0"),
                              of(f, "gamma2") * x.y() + of(f, "v0"))
                   : Vector2d(of(f, "fx") * x.x() + of(f, "cx"), of(f, "fy") * x.y() + of(f, "cy"));
      };
      ExpectSameCamera(lens, PoseOf(n), FromOpenCv(rig["body_T_" + name]), project, 1e-6);
    }
  }
}

// Basalt ----------------------------------------------------------------------------------------

TEST(ExportedCalibration, IsReadByBasalt) {
  const std::vector<CameraModel> lenses = {
      {"pinhole-none", Vector({458.0, 457.0, 370.0, 245.0})},
      kEqui,
      {"ds-none", Vector({-0.27, 0.57, 350.0, 349.0, 370.0, 245.0})},
      {"eucm-none", Vector({0.6, 1.05, 460.0, 459.0, 370.0, 245.0})},
      {"omni-none", Vector({1.2, 780.0, 781.0, 370.0, 245.0})}};
  for (const CameraModel& lens : lenses) {
    SCOPED_TRACE(lens.name());
    const ScratchFolder scratch;
    const std::string out = Export(scratch, {lens, lens}, PlainImu(), "basalt");
    std::ifstream file(out + "calibration.json");
    const nlohmann::json calibration = nlohmann::json::parse(file).at("value0");
    for (size_t n = 0; n < 2; ++n) {
      const nlohmann::json& pose = calibration.at("T_imu_cam").at(n);
      Matrix4d T = Matrix4d::Identity();
      T.topLeftCorner<3, 3>() =
          Eigen::Quaterniond(pose.at("qw"), pose.at("qx"), pose.at("qy"), pose.at("qz"))
              .toRotationMatrix();
      T.topRightCorner<3, 1>() = Vector3d(pose.at("px"), pose.at("py"), pose.at("pz"));
      const nlohmann::json& entry = calibration.at("intrinsics").at(n);
      const std::string type = entry.at("camera_type");
      const auto of = [&](const char* key) -> double { return entry.at("intrinsics").at(key); };
      const auto project = [&](const Vector3d& p) -> Vector2d {
        Vector2d x = p.head<2>() / p.z();
        if (type == "kb4") x = Fisheye(p, of("k1"), of("k2"), of("k3"), of("k4"));
        if (type == "ds") {
          const double d1 = p.norm();
          const double z1 = of("xi") * d1 + p.z();
          const double d2 = std::hypot(p.head<2>().norm(), z1);
          x = p.head<2>() / (of("alpha") * d2 + (1.0 - of("alpha")) * z1);
        }
        if (type == "eucm" || type == "ucm") {
          const double beta = type == "eucm" ? of("beta") : 1.0;
          const double d = std::sqrt(beta * p.head<2>().squaredNorm() + p.z() * p.z());
          x = p.head<2>() / (of("alpha") * d + (1.0 - of("alpha")) * p.z());
        }
        return {of("fx") * x.x() + of("cx"), of("fy") * x.y() + of("cy")};
      };
      ExpectSameCamera(lens, PoseOf(n), T, project, 1e-6);
      EXPECT_EQ(calibration.at("resolution").at(n), (nlohmann::json{752, 480}));
    }
    EXPECT_EQ(calibration.at("cam_time_offset_ns"), 7300000);
    // Densities, as they are.
    EXPECT_EQ(calibration.at("accel_noise_std"), (nlohmann::json{2.1e-3, 2.1e-3, 2.1e-3}));
    EXPECT_EQ(calibration.at("gyro_noise_std"), (nlohmann::json{1.7e-4, 1.7e-4, 1.7e-4}));
    EXPECT_EQ(calibration.at("accel_bias_std"), (nlohmann::json{3.2e-4, 3.2e-4, 3.2e-4}));
    EXPECT_EQ(calibration.at("gyro_bias_std"), (nlohmann::json{2e-5, 2e-5, 2e-5}));
    EXPECT_EQ(calibration.at("imu_update_rate"), 200.0);
    ASSERT_EQ(calibration.at("calib_accel_bias").size(), 9U);
    ASSERT_EQ(calibration.at("calib_gyro_bias").size(), 12U);
    for (int k = 0; k < 3; ++k) {
      EXPECT_EQ(calibration.at("calib_accel_bias").at(k), kAccelBias(k));
      EXPECT_EQ(calibration.at("calib_gyro_bias").at(k), kGyroBias(k));
    }
    EXPECT_EQ(calibration.at("calib_gyro_bias").at(7), 0.0);
  }
}

// ORB-SLAM3 -------------------------------------------------------------------------------------

TEST(ExportedCalibration, IsReadByOrbSlam3) {
  const std::vector<std::vector<CameraModel>> rigs = {{kRadtan, kOtherRadtan}, {kEqui, kEqui}};
  for (const std::vector<CameraModel>& lenses : rigs) {
    SCOPED_TRACE(lenses[0].name());
    const ScratchFolder scratch;
    const std::string out = Export(scratch, lenses, PlainImu(), "orb-slam3");
    const cv::FileStorage file(out + "orb_slam3.yaml", cv::FileStorage::READ);
    EXPECT_EQ(std::string(file["File.version"]), "1.0");
    const bool is_fisheye = std::string(file["Camera.type"]) == "KannalaBrandt8";
    const Matrix4d T_b_c1 = FromOpenCv(file["IMU.T_b_c1"]);
    const Matrix4d T_c1_c2 = FromOpenCv(file["Stereo.T_c1_c2"]);
    for (size_t n = 0; n < 2; ++n) {
      const std::string name = n == 0 ? "Camera1." : "Camera2.";
      const auto of = [&](const char* key) {
        EXPECT_FALSE(file[name + key].empty()) << name << key;
        return file[name + key].real();
      };
      const auto project = [&](const Vector3d& p) -> Vector2d {
        const Vector2d x = is_fisheye
                               ? Fisheye(p, of("k1"), of("k2"), of("k3"), of("k4"))
                               : Brown(p.head<2>() / p.z(), of("k1"), of("k2"), of("p1"), of("p2"));
        return {of("fx") * x.x() + of("cx"), of("fy") * x.y() + of("cy")};
      };
      // It keeps poses as floats.
      ExpectSameCamera(lenses[n], PoseOf(n), n == 0 ? T_b_c1 : Matrix4d(T_b_c1 * T_c1_c2), project,
                       2e-3);
    }
    EXPECT_EQ(static_cast<int>(file["Camera.width"]), 752);
    EXPECT_EQ(static_cast<int>(file["Camera.height"]), 480);
    EXPECT_TRUE(file["Camera.fps"].isInt());
    EXPECT_EQ(static_cast<int>(file["Camera.fps"]), 20);
    EXPECT_EQ(file["IMU.NoiseGyro"].real(), 1.7e-4);
    EXPECT_EQ(file["IMU.NoiseAcc"].real(), 2.1e-3);
    EXPECT_EQ(file["IMU.GyroWalk"].real(), 2e-5);
    EXPECT_EQ(file["IMU.AccWalk"].real(), 3.2e-4);
    EXPECT_EQ(file["IMU.Frequency"].real(), 200.0);
  }
}

TEST(ExportedCalibration, ForOrbSlam3SaysHowToShiftTheStampsAndAsksForTheRate) {
  const ScratchFolder scratch;
  const std::string result = WriteResult(scratch, {kRadtan}, PlainImu());
  const std::string out = scratch.Path("exported");
  const std::vector<std::string> command = {"export",    result,  "--format",
                                            "orb-slam3", "--out", out};
  const Ended refused = RunProgram(command);
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, HasSubstr("--camera-rate"));
  std::vector<std::string> with_rate = command;
  with_rate.insert(with_rate.end(), {"--camera-rate", "20"});
  const Ended ended = RunProgram(with_rate);
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.err, HasSubstr("add 0.0073 s to the stamps of cam0"));
}

TEST(ExportedCalibration, ForOrbSlam3ShiftsEachCamerasStampsByItsOwnOffset) {
  const ScratchFolder scratch;
  const std::string folder = WriteResult(scratch, {kRadtan, kOtherRadtan}, PlainImu());
  Value chain = ReadYaml(folder + "/camchain-imucam.yaml");
  Value camera = chain.At("cam1");
  camera.Set("timeshift_cam_imu", -0.002);
  chain.Set("cam1", camera);
  (void)scratch.Write("result/camchain-imucam.yaml", ToYaml(chain));
  const std::vector<std::string> warnings = FilesOf(folder, "orb-slam3").warnings;
  ASSERT_EQ(warnings.size(), 2U);
  EXPECT_THAT(warnings[0], HasSubstr("add 0.0073 s to the stamps of cam0"));
  EXPECT_THAT(warnings[1], HasSubstr("add -0.002 s to the stamps of cam1"));
}

// ROS -------------------------------------------------------------------------------------------

TEST(ExportedCalibration, IsReadByRos) {
  const CameraModel radtan5("pinhole-radtan5", Vector({458.65, 457.3, 367.2, 248.4, -0.283, 0.074,
                                                       1.9e-4, 1.8e-5, 0.01}));
  const std::vector<CameraModel> lenses = {kRadtan, kEqui, radtan5};
  for (const CameraModel& lens : lenses) {
    SCOPED_TRACE(lens.name());
    const ScratchFolder scratch;
    const std::string out = Export(scratch, {kOtherRadtan, lens}, PlainImu(), "ros");
    const YAML::Node info = YAML::LoadFile(out + "cam1.yaml");
    EXPECT_EQ(info["image_width"].as<int>(), 752);
    EXPECT_EQ(info["image_height"].as<int>(), 480);
    EXPECT_EQ(info["camera_name"].as<std::string>(), "cam1");
    const auto matrix = [&](const char* key) {
      const auto data = info[key]["data"].as<std::vector<double>>();
      EXPECT_EQ(data.size(), info[key]["rows"].as<size_t>() * info[key]["cols"].as<size_t>());
      return data;
    };
    const std::vector<double> K = matrix("camera_matrix");
    const std::vector<double> d = matrix("distortion_coefficients");
    const std::vector<double> P = matrix("projection_matrix");
    EXPECT_EQ(matrix("rectification_matrix"), (std::vector<double>{1, 0, 0, 0, 1, 0, 0, 0, 1}));
    EXPECT_EQ(P, (std::vector<double>{K[0], 0, K[2], 0, 0, K[4], K[5], 0, 0, 0, 1, 0}));
    const bool is_fisheye = info["distortion_model"].as<std::string>() == "equidistant";
    EXPECT_EQ(info["distortion_model"].as<std::string>(), is_fisheye ? "equidistant" : "plumb_bob");
    ASSERT_EQ(d.size(), is_fisheye ? 4U : 5U);
    const auto project = [&](const Vector3d& p) -> Vector2d {
      const Vector2d x = is_fisheye ? Fisheye(p, d[0], d[1], d[2], d[3])
                                    : Brown(p.head<2>() / p.z(), d[0], d[1], d[2], d[3], d[4]);
      return {K[0] * x.x() + K[2], K[4] * x.y() + K[5]};
    };
    ExpectSameCamera(lens, Rigid3{}, Matrix4d::Identity(), project, 1e-6);
  }
}

// What they do not know --------------------------------------------------------------------------

TEST(ExportedCalibration, RefusesLensesThatAProgramDoesNotKnow) {
  const CameraModel fov("pinhole-fov", Vector({458.0, 457.0, 370.0, 245.0, 0.9}));
  for (const char* format : {"openvins", "vins-fusion", "basalt", "orb-slam3", "ros"}) {
    SCOPED_TRACE(format);
    ExpectRefused({fov}, PlainImu(), format, "the camera is pinhole-fov, it knows pinhole-");
  }
  ExpectRefused({kRadtan}, PlainImu(), "basalt", "pinhole-radtan");
  ExpectRefused({kOmni}, PlainImu(), "openvins", "omni-radtan");
  ExpectRefused({kRadtan, kEqui}, PlainImu(), "orb-slam3", "both lenses of one type");
}

TEST(ExportedCalibration, IsWrittenByTheProgramOrRefusedInOneLine) {
  const ScratchFolder scratch;
  const std::string result = WriteResult(scratch, {kRadtan}, PlainImu());
  const std::string out = scratch.Path("exported");
  for (const auto& [format, why] : {std::pair("moveit", "openvins, vins-fusion, basalt"),
                                    std::pair("basalt", "pinhole-radtan")}) {
    const Ended ended = RunProgram({"export", result, "--format", format, "--out", out});
    EXPECT_EQ(ended.exit_code, 2);
    EXPECT_THAT(ended.err, HasSubstr(why));
    EXPECT_EQ(std::count(ended.err.begin(), ended.err.end(), '\n'), 1);
    EXPECT_FALSE(std::filesystem::exists(out));
  }
  const Ended ended = RunProgram({"export", result, "--format", "openvins", "--out", out});
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  for (const auto& [name, content] : FilesOf(result, "openvins").content) {
    EXPECT_EQ(ContentOf(out + "/" + name), content) << name;
  }
}

TEST(ExportedCalibration, OfCamerasAloneGoesWhereNoImuIsNeeded) {
  const ScratchFolder scratch;
  std::vector<Camera> cameras = {{kRadtan, {752, 480}, "/cam0/image_raw", {}},
                                 {kOtherRadtan, {752, 480}, "/cam1/image_raw", {}}};
  cameras[1].T_cn_cnm1 = PoseOf(1) * PoseOf(0).Inverse();
  (void)scratch.Write("result/camchain.yaml", ToYaml(ToValue(cameras)));
  (void)scratch.Write("result/result.json", R"({"kind": "camera", "verdict": "pass"})");
  const auto run = [&](const std::string& format) {
    return RunProgram({"export", scratch.Path("result"), "--format", format, "--camera-rate", "20",
                       "--out", scratch.Path(format)});
  };
  for (const char* format : {"openvins", "basalt"}) {
    const Ended ended = run(format);
    EXPECT_EQ(ended.exit_code, 2);
    EXPECT_THAT(ended.err, HasSubstr("needs an IMU"));
  }
  for (const char* format : {"vins-fusion", "orb-slam3", "ros"}) {
    EXPECT_EQ(run(format).exit_code, 0) << format;
  }
  // The body of VINS-Fusion without an IMU is the first camera.
  const cv::FileStorage rig(scratch.Path("vins-fusion/vins_fusion.yaml"), cv::FileStorage::READ);
  EXPECT_EQ(static_cast<int>(rig["imu"]), 0);
  EXPECT_EQ(FromOpenCv(rig["body_T_cam0"]), Matrix4d::Identity());
  const Matrix4d T_c0_c1 = FromOpenCv(rig["body_T_cam1"]);
  EXPECT_LT((T_c0_c1 - (PoseOf(0) * PoseOf(1).Inverse()).Matrix()).norm(), 1e-12);
}

TEST(ExportedCalibration, OfAFailedVerdictIsWrittenWithAWarning) {
  const ScratchFolder scratch;
  const std::string result = WriteResult(scratch, {kRadtan}, PlainImu(), "inconclusive");
  const Ended ended =
      RunProgram({"export", result, "--format", "openvins", "--out", scratch.Path("exported")});
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.err, HasSubstr("verdict is inconclusive"));
}

}  // namespace
}  // namespace calibrato
