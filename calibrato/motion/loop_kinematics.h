#pragma once

#include <Eigen/Core>

#include "calibrato/motion/looped_trajectory.h"

// How the controlled frame moves at one instant, with derivatives by what an action chooses: for
// those who improve motions by their gradients. (Who only needs the state: loop_state.h.)

namespace calibrato {

/// The pose vector of an instant and how it changes.
struct PoseVectorJet {
  PoseVector value;   ///< Absolute: base pose plus offset.
  PoseVector first;   ///< [1/s]
  PoseVector second;  ///< [1/s^2]
};

/// Of a loop at s in [0, 1] of its duration, under the quintic time law.
[[nodiscard]] PoseVectorJet LoopJetAt(const BasePose& base, const LoopCoefficients& coefficients,
                                      double s, double duration_s);

/// Derivatives of a number by the loop's coefficients and duration, from those by the jet.
struct LoopGradient {
  LoopCoefficients coefficients = LoopCoefficients::Zero();
  double duration_s = 0.0;
};
/// Adds those of one instant. @param by_jet  Derivatives of the number by the jet's three vectors.
void AddToLoopGradient(const PoseVectorJet& jet, const PoseVectorJet& by_jet, double s,
                       double duration_s, LoopGradient* gradient);

/// Adds a number's derivatives by the offset at a phase to those by the coefficients.
void AddOffsetGradient(const PoseVector& by_offset, double theta, LoopCoefficients* gradient);

/// The controlled frame e in the arm's base frame b; angular quantities in its own axes.
struct FrameKinematics {
  Eigen::Matrix3d R_b_e;
  Eigen::Vector3d position_b;      ///< [m]
  Eigen::Vector3d velocity_b;      ///< [m/s]
  Eigen::Vector3d acceleration_b;  ///< [m/s^2]
  Eigen::Vector3d omega_e;         ///< [rad/s]
  Eigen::Vector3d alpha_e;         ///< [rad/s^2]
};
[[nodiscard]] FrameKinematics KinematicsOf(const PoseVectorJet& jet);

/// Derivatives of a number by the kinematics; of the rotation by eps in R_b_e Exp(eps).
struct FrameKinematicsGradient {
  Eigen::Vector3d rotation = Eigen::Vector3d::Zero();
  Eigen::Vector3d position_b = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_b = Eigen::Vector3d::Zero();
  Eigen::Vector3d acceleration_b = Eigen::Vector3d::Zero();
  Eigen::Vector3d omega_e = Eigen::Vector3d::Zero();
  Eigen::Vector3d alpha_e = Eigen::Vector3d::Zero();
};
/// The number's derivatives by the jet.
[[nodiscard]] PoseVectorJet GradientByJet(const PoseVectorJet& jet,
                                          const FrameKinematicsGradient& gradient);

}  // namespace calibrato
