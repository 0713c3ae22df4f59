#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calibrato/calibration/design_criterion.h"
#include "calibrato/geometry/rigid3.h"
#include "calibrato/sensors/camera_model.h"
#include "calibrato/sensors/imu.h"
#include "calibrato/sensors/measurements.h"

// How well a camera-IMU calibration of a motion that was not executed would determine the
// extrinsics, without measurements and without a solve.

namespace calibrato {

/// How the IMU moves at one instant, seen from the board.
struct PlannedImuInstant {
  double t_s = 0.0;         ///< On the IMU's clock, from the motion's beginning.
  double duration_s = 0.0;  ///< The time that this instant stands for: a 200 Hz IMU gives it
                            ///< 200 * duration_s samples' worth of information.
  Eigen::Matrix3d R_g_i;
  Eigen::Vector3d omega_i;  ///< [rad/s]
  Eigen::Vector3d force_i;  ///< Specific force [m/s^2].
};

/// A frame of camera 0, and how the IMU moves while it is taken.
struct PlannedFrame {
  double t_s = 0.0;     ///< On the IMU's clock.
  double weight = 1.0;  ///< How many such frames there are, or how likely it is to be used: >= 0.
  Rigid3 T_c_g;
  Eigen::Vector3d omega_i;     ///< [rad/s]
  Eigen::Vector3d velocity_g;  ///< Of the IMU [m/s].
};

/// What is known beforehand.
struct PlannedRig {
  CameraModel camera;
  BoardView points;              ///< As from PlannedView.
  double corner_noise_px = 0.1;  ///< > 0
  Rigid3 T_c_i;
  ImuNoise noise;
  Eigen::Vector3d gravity_g{0.0, 0.0, -kStandardGravity};
};

/// Both lists in order of time, within [0, duration_s].
struct PlannedMotion {
  double duration_s = 0.0;
  std::vector<PlannedImuInstant> imu;
  std::vector<PlannedFrame> frames;
};

/// Derivatives of a number by what PlannedMotion holds.
struct PlannedMotionGradient {
  struct Imu {
    Eigen::Vector3d R_g_i;  ///< By eps in R_g_i Exp(eps).
    Eigen::Vector3d omega_i;
    Eigen::Vector3d force_i;
    double duration_s = 0.0;
    double t_s = 0.0;
  };
  struct Frame {
    double weight = 0.0;
    double t_s = 0.0;
    Eigen::Matrix<double, 6, 1> T_c_g;  ///< By its perturbation [dtheta, dt] (rigid3.h).
    Eigen::Vector3d omega_i;
    Eigen::Vector3d velocity_g;
  };
  std::vector<Imu> imu;
  std::vector<Frame> frames;
};

/// What is expected of T_c_i and the time offset.
struct ExpectedExtrinsics {
  /// Marginal covariance of [T_c_i 6, time offset], [rad, m, s].
  Eigen::Matrix<double, 7, 7> covariance;
  /// The criterion of T_c_i in units of 1e-3 rad and 1e-3 m (information.h).
  double criterion = 0.0;
  PlannedMotionGradient gradient;  ///< Of the criterion; empty unless asked for.
};

/// The continuous-time estimator of camera_imu_calibration.h, linearised about the motion: unknown
/// are the trajectory, T_c_i, the time offset, the direction of gravity, and biases that walk.
///
/// Perturbing the trajectory, R_g_i Exp(phi(t)) and p_g_i + d(t), what is measured changes by
///
///     rates    phi' + omega x phi + b_g                    (body frame, so nothing but omega
///     forces   force x phi + R' (d'' - dg) + b_a            and the force enter)
///     frames   [psi; psi x (t_c_g - t_c_i) + dt - R_c_g d],  psi = dtheta - R_c_i phi,
///
/// in a frame's pose T_c_g, of whose information PoseInformationOfFrame tells, with phi and d at
/// the frame's instant plus omega and velocity times the time offset's change. phi and d are
/// splines of order 6 with a knot every 0.1 s, so H is an arrowhead (arrowhead.h), and the
/// covariance of its border costs time linear in the motion's length. Biases are constant over
/// pieces of 5 s with a random walk between them.
///
/// The gradient: with X = (H^-1)_{:,e} root (design_criterion.h), d criterion = -tr(X' dH X), and
/// every measurement's share of dH depends on its own instant only: one more pass over the
/// measurements, no further solve (docs/expected-information.md).
///
/// @return nothing where the motion does not determine the extrinsics.
[[nodiscard]] std::optional<ExpectedExtrinsics> ExpectExtrinsics(const PlannedRig& rig,
                                                                 const PlannedMotion& motion,
                                                                 DesignCriterion criterion,
                                                                 bool want_gradient);

/// Two unit vectors at right angles to gravity: gravity is believed to be off by
/// |gravity_g| * directions * (two small angles).
[[nodiscard]] Eigen::Matrix<double, 3, 2> GravityDirections(const Eigen::Vector3d& gravity_g);

/// What the motion alone says of [T_c_i 6, time offset, gravity's two angles], and then of the
/// camera's parameters unless they are known; trajectory and biases being unknown (the latter but
/// for 0.1 rad/s and 1 m/s^2). It is the inverse of their marginal covariance, singular where the
/// motion leaves a direction open, zero where nothing is learned. Adds up over motions of one rig
/// before one board, a little pessimistically: each has biases of its own.
[[nodiscard]] Eigen::MatrixXd ExtrinsicInformationOf(const PlannedRig& rig,
                                                     const PlannedMotion& motion,
                                                     bool camera_is_known);

}  // namespace calibrato
