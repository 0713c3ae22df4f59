#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibrato/motion/arm_clearance.h"
#include "calibrato/motion/panda.h"

namespace calibrato {

/// An arm of six or seven revolute joints, as its owner describes it (arm_file.h). Its joint angles
/// are the first entries of a JointVector; a seventh that the arm lacks stays 0.
///
/// The Panda has functions of its own (panda.h): its inverse is in closed form, and its dynamics
/// are known.
struct Arm {
  struct Joint {
    std::string name;
    Rigid3 T_before_joint;  ///< From the frame of the joint before it (the base, for the first).
    Eigen::Vector3d axis;   ///< Of unit length, in its own frame.
  };
  std::string name;
  std::string base_frame;
  std::vector<Joint> joints;  ///< Six or seven.
  Rigid3 T_last_e;            ///< From the last joint's frame to the controlled frame.
  /// Torques are infinite: without inertias, whether motors are strong enough is not known.
  PandaLimits limits;
  JointVector start;           ///< Where motions begin, or near it [rad].
  std::vector<ArmPart> parts;  ///< What could collide: links of the base (0) and of the joints.

  [[nodiscard]] int num_joints() const { return static_cast<int>(joints.size()); }
};

/// T_b_link of each joint, turned by it, then T_b_e.
[[nodiscard]] std::vector<Rigid3> FramesOf(const Arm& arm, const JointVector& q);

/// T_b_e. @param J_pose_q  As PandaPose; columns of joints that the arm lacks are 0. May be null.
[[nodiscard]] Rigid3 PoseOf(const Arm& arm, const JointVector& q, JointJacobian* J_pose_q);

/// As SingularityDistance, of this arm.
[[nodiscard]] double SingularityDistance(const Arm& arm, const JointVector& q);

/// The joint angles that reach T_b_e to 1e-9, by Newton's method from `q`. With seven joints, of
/// all that do, those (locally) nearest to `preferred`, so that a path of poses that closes gives a
/// path of joints that closes.
/// @return  Nothing if it does not converge.
[[nodiscard]] std::optional<JointVector> InverseNear(const Arm& arm, const Rigid3& T_b_e,
                                                     const JointVector& q,
                                                     const JointVector& preferred);

/// Ways to stand at T_b_e within the range, nearest to arm.start first, that differ by more than
/// 0.5 rad in some joint: Newton's method from a lattice of joint angles. Usually all of them,
/// which is not proven.
[[nodiscard]] std::vector<JointVector> PosturesAt(const Arm& arm, const Rigid3& T_b_e,
                                                  const JointRange& range);

}  // namespace calibrato
