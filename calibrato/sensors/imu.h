#pragma once

#include <Eigen/Core>
#include <vector>

#include "calibrato/base/time.h"
#include "calibrato/geometry/rigid3.h"

namespace calibrato {

/// Standard gravity [m/s^2]. A level IMU at rest reads f = (0, 0, +9.80665).
inline constexpr double kStandardGravity = 9.80665;

/// One reading of a gyroscope [rad/s] or of an accelerometer [m/s^2], in frame i.
struct VectorSample {
  Time stamp;  ///< On the IMU's clock.
  Eigen::Vector3d value;
};

/// What an IMU recorded. Its two sensors may have stamps and rates of their own.
///
/// Estimators want ascending stamps and finite values; a stream that was read from a file is as the
/// file has it (diagnosis/stream_check.h counts what is wrong and mends what can be mended).
struct ImuStream {
  std::vector<VectorSample> gyro;   ///< Angular rate omega_i [rad/s].
  std::vector<VectorSample> accel;  ///< Specific force f_i [m/s^2].
};

/// Noise of an IMU as continuous-time densities, with Kalibr's meaning and names. The standard
/// deviation of one sample is density * sqrt(rate).
///
/// The defaults are the paper's IMU (Table 2), whose figures are per sample at 200 Hz: 0.004 m/s^2
/// and 3.394e-4 rad/s; its drifts (0.006 m/s^2 and 3.8785e-5 rad/s, Gauss-Markov with 3600 s) as
/// random walks are drift * sqrt(2 / 3600 s).
struct ImuNoise {
  double rate_hz = 200.0;
  double accel_noise_density = 2.83e-4;  ///< [m/s^2/sqrt(Hz)]
  double accel_random_walk = 1.41e-4;    ///< [m/s^3/sqrt(Hz)]
  double gyro_noise_density = 2.40e-5;   ///< [rad/s/sqrt(Hz)]
  double gyro_random_walk = 9.1e-7;      ///< [rad/s^2/sqrt(Hz)]
};

/// Which of an IMU's intrinsics are unknown. Each kind has the unknowns of the one before it.
enum class ImuModelKind {
  kCalibrated,                   ///< None: `ImuIntrinsics{}`, biases only.
  kScaleMisalignment,            ///< M_accel, M_gyro, R_gyro_i, g_sensitivity.
  kScaleMisalignmentSizeEffect,  ///< ... and the lever arms of the accelerometer's y and z axes.
};

/// Constant faults of an IMU. A perfect one has none: the defaults.
///
/// Frame i has the axes of the accelerometer as far as M_accel leaves them free: x of frame i is
/// its x axis, y lies in the plane of its x and y axes, hence the lower triangle. The origin of
/// frame i is where its x axis is sensed.
struct ImuIntrinsics {
  Eigen::Matrix3d M_accel = Eigen::Matrix3d::Identity();  ///< Scale and skew, lower triangular [-].
  Eigen::Matrix3d M_gyro = Eigen::Matrix3d::Identity();   ///< The same of the gyroscope [-].
  Eigen::Matrix3d R_gyro_i = Eigen::Matrix3d::Identity();  ///< Frame i to the gyroscope's axes.
  /// What specific force adds to the rates [rad/s per m/s^2].
  Eigen::Matrix3d g_sensitivity = Eigen::Matrix3d::Zero();
  /// Column k: where the accelerometer's axis k is sensed, in frame i [m]. Column 0 is zero by the
  /// choice of the origin.
  Eigen::Matrix3d lever_arms_i = Eigen::Matrix3d::Zero();
};

/// How frame i moves at one instant.
struct ImuMotion {
  Eigen::Matrix3d R_w_i;
  Eigen::Vector3d omega_i;  ///< Angular velocity of i in w [rad/s].
  Eigen::Vector3d alpha_i;  ///< d omega_i / dt: angular acceleration of i in w [rad/s^2].
  Eigen::Vector3d accel_w;  ///< Second derivative of the origin's position [m/s^2].
};

/// How another frame j of the same rigid body moves.
[[nodiscard]] ImuMotion MotionOfFrame(const ImuMotion& motion_i, const Rigid3& T_i_j);

/// Specific force at the origin of i: f_i = R_i_w (a_w - g_w) [m/s^2].
/// @param gravity_w  (0, 0, -9.80665) where z of w points up.
[[nodiscard]] Eigen::Vector3d SpecificForce(const ImuMotion& motion,
                                            const Eigen::Vector3d& gravity_w);

/// What the gyroscope reads [rad/s]:
///
///     M_gyro R_gyro_i omega_i + g_sensitivity R_gyro_i f_i + bias
///
/// Source: Rehder, Nikolic, Schneider, Hinzmann, Siegwart, "Extending kalibr: Calibrating the
/// extrinsics of multiple IMUs and of individual axes", ICRA 2016, as Kalibr computes it.
[[nodiscard]] Eigen::Vector3d PredictGyro(const ImuMotion& motion, const Eigen::Vector3d& gravity_w,
                                          const ImuIntrinsics& intrinsics,
                                          const Eigen::Vector3d& bias);

/// What the accelerometer reads [m/s^2]:
///
///     M_accel (f_i + sum over k of I_k (alpha_i x r_k + omega_i x (omega_i x r_k))) + bias
///
/// r_k is column k of the lever arms, I_k picks component k. Source: as above.
[[nodiscard]] Eigen::Vector3d PredictAccel(const ImuMotion& motion,
                                           const Eigen::Vector3d& gravity_w,
                                           const ImuIntrinsics& intrinsics,
                                           const Eigen::Vector3d& bias);

}  // namespace calibrato
