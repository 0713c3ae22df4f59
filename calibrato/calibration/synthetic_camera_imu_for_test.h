#pragma once

#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calibrato/base/rng.h"
#include "calibrato/calibration/camera_imu_problem.h"
#include "calibrato/geometry/rpy.h"
#include "calibrato/geometry/so3.h"
#include "calibrato/sensors/board.h"
#include "calibrato/sensors/imu.h"

namespace calibrato {

/// A rig that is shaken before a board: sums of sines for each degree of freedom, a closed form
/// that is no spline, with an IMU as imu.h predicts it.
struct SyntheticCameraImu {
  // What there is to find.
  std::vector<Rigid3> T_c_i = {{RotationFromRpy({0.1, -0.05, 1.6}), {0.052, -0.031, 0.024}}};
  std::vector<double> time_offset_s = {0.0073};
  CameraModel model{
      "pinhole-radtan",
      (Eigen::VectorXd(8) << 420.0, 418.5, 322.3, 238.6, -0.25, 0.06, 4e-4, -3e-4).finished()};
  Eigen::Vector3d gravity_g = 9.80665 * Eigen::Vector3d(-1.0, 0.1, 0.2).normalized();
  Eigen::Vector3d gyro_bias{0.01, -0.02, 0.005};
  Eigen::Vector3d accel_bias{0.05, 0.1, -0.08};
  ImuIntrinsics intrinsics;
  double line_delay_s = 0.0;  ///< Of all cameras.

  // How it is measured.
  double duration_s = 10.0;
  double camera_rate_hz = 20.0;
  double corner_noise_px = 0.1;
  ImuNoise imu_noise{200.0, 2.83e-4, 1.41e-4, 2.40e-5, 9.1e-7};
  double noise_scale = 1.0;  ///< 0: measurements are exact.
  double translation = 1.0;  ///< Amplitude of the motion; 0: none.
  double rotation = 1.0;
  double slowest_rad_s = 2.0;  ///< Of three frequencies, each 1.73 times the one before.
  Eigen::Vector3d rotation_of_axis = Eigen::Vector3d::Ones();  ///< Factors of roll, pitch, yaw.

  // The rig at a time of the IMU's clock; T_w_i of ImuMotion is T_g_i.
  ImuMotion MotionAt(double t) const {
    const auto sum = [&](double phase, double scale) {
      // value, first and second derivative
      Eigen::Vector3d result = Eigen::Vector3d::Zero();
      double frequency = slowest_rad_s;
      for (int k = 0; k < 3; ++k) {
        const double a = scale / (1.0 + k);
        const double angle = frequency * t + phase * (1.0 + k);
        result += a * Eigen::Vector3d(std::sin(angle), frequency * std::cos(angle),
                                      -frequency * frequency * std::sin(angle));
        frequency *= 1.73;
      }
      return result;
    };
    Eigen::Matrix3d position;  // columns: value, first, second
    Eigen::Matrix3d angles;
    for (int axis = 0; axis < 3; ++axis) {
      position.row(axis) = sum(0.7 + axis, 0.05 * translation).transpose();
      angles.row(axis) =
          sum(2.1 + 1.3 * axis, 0.15 * rotation * rotation_of_axis(axis)).transpose();
    }
    // The camera looks at the board's middle from 0.7 m; z of g points at it.
    const Eigen::Matrix3d R_g_c = ExpSo3({std::numbers::pi, 0.0, 0.0});
    const Eigen::Matrix3d R_g_0 = R_g_c * T_c_i.front().R;
    const Eigen::Matrix3d R_0_i = RotationFromRpy(angles.col(0));
    const Eigen::Vector3d omega_0 = AngularVelocityFromRpyRates(angles.col(0)) * angles.col(1);
    const Eigen::Vector3d alpha_0 =
        AngularAccelerationFromRpy(angles.col(0), angles.col(1), angles.col(2));
    return {R_g_0 * R_0_i, R_0_i.transpose() * omega_0, R_0_i.transpose() * alpha_0,
            position.col(2)};
  }
  Rigid3 PoseAt(double t) const {
    Eigen::Vector3d p = BoardCentre(board) + Eigen::Vector3d(0.0, 0.0, 0.7);
    for (int axis = 0; axis < 3; ++axis) {
      double frequency = slowest_rad_s;
      for (int k = 0; k < 3; ++k) {
        p(axis) +=
            translation * 0.05 / (1.0 + k) * std::sin(frequency * t + (0.7 + axis) * (1.0 + k));
        frequency *= 1.73;
      }
    }
    return {MotionAt(t).R_w_i, p};
  }

  Board board = Checkerboard{6, 7, 0.06, 0.06};
  Resolution resolution{640, 480};
  Time epoch = Time::FromNanoseconds(1'400'000'000'000'000'000);

  // Where a camera sees a point in the image that is stamped t_c; its row is exposed when its row's
  // turn has come.
  [[nodiscard]] std::optional<Eigen::Vector2d> PixelAt(size_t camera, double t_c,
                                                       const Eigen::Vector3d& point_g) const {
    double row = 0.0;
    for (int round = 0;; ++round) {
      const Rigid3 T_c_g =
          T_c_i[camera] * PoseAt(t_c + time_offset_s[camera] + line_delay_s * row).Inverse();
      const auto pixel = model.Project(T_c_g * point_g);
      if (!pixel || line_delay_s == 0.0 || round == 6) return pixel;
      row = pixel->y();
    }
  }

  [[nodiscard]] CameraImuProblem Problem(Rng& rng) const {
    CameraImuProblem problem;
    const Eigen::Matrix3Xd points = BoardPoints(board);
    for (size_t n = 0; n < T_c_i.size(); ++n) {
      CameraImuCamera camera{model, {}, IntrinsicsKnowledge::kExact, {}};
      for (int k = 0; k < duration_s * camera_rate_hz; ++k) {
        const double t_c = 0.0123 + k / camera_rate_hz;
        BoardView view;
        view.stamp = epoch + Duration::FromSeconds(t_c);
        view.name = std::to_string(view.stamp.nanoseconds());
        std::vector<Eigen::Vector2d> pixels;
        for (int c = 0; c < points.cols(); ++c) {
          const auto pixel = PixelAt(n, t_c, points.col(c));
          const Eigen::Vector2d noise(rng.Normal(), rng.Normal());
          if (!pixel || !(pixel->minCoeff() >= 0.0) || pixel->x() > resolution.width - 1 ||
              pixel->y() > resolution.height - 1) {
            continue;
          }
          view.corner_ids.push_back(c);
          pixels.push_back(*pixel + noise_scale * corner_noise_px * noise);
        }
        // Too few corners are found by no detector.
        if (pixels.size() < 12) continue;
        view.pixels.resize(2, static_cast<Eigen::Index>(pixels.size()));
        view.points_g.resize(3, static_cast<Eigen::Index>(pixels.size()));
        for (size_t c = 0; c < pixels.size(); ++c) {
          view.pixels.col(static_cast<Eigen::Index>(c)) = pixels[c];
          view.points_g.col(static_cast<Eigen::Index>(c)) = points.col(view.corner_ids[c]);
        }
        camera.views.push_back(std::move(view));
      }
      problem.cameras.push_back(std::move(camera));
    }

    CameraImuImu imu{{}, imu_noise, ImuModelKind::kCalibrated};
    const double period = 1.0 / imu_noise.rate_hz;
    const auto vector = [&]() -> Eigen::Vector3d {
      const double x = rng.Normal();
      const double y = rng.Normal();
      return noise_scale * Eigen::Vector3d(x, y, rng.Normal());
    };
    Eigen::Vector3d gyro_walk = gyro_bias;
    Eigen::Vector3d accel_walk = accel_bias;
    for (int k = 0; k < duration_s * imu_noise.rate_hz; ++k) {
      const double t = k * period;
      const Time stamp = epoch + Duration::FromSeconds(t);
      const ImuMotion motion = MotionAt(t);
      imu.stream.gyro.push_back(
          {stamp, PredictGyro(motion, gravity_g, intrinsics, gyro_walk) +
                      imu_noise.gyro_noise_density * std::sqrt(imu_noise.rate_hz) * vector()});
      imu.stream.accel.push_back(
          {stamp, PredictAccel(motion, gravity_g, intrinsics, accel_walk) +
                      imu_noise.accel_noise_density * std::sqrt(imu_noise.rate_hz) * vector()});
      gyro_walk += imu_noise.gyro_random_walk * std::sqrt(period) * vector();
      accel_walk += imu_noise.accel_random_walk * std::sqrt(period) * vector();
    }
    problem.imus.push_back(std::move(imu));
    return problem;
  }
};

}  // namespace calibrato
