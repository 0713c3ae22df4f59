#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "calibrato/motion/panda.h"
#include "calibrato/sensors/rig.h"

namespace calibrato {

/// A box at any angle; its axes are those of its own frame.
struct Box {
  Rigid3 T_b_box;             ///< The frame's origin is the middle of the box.
  Eigen::Vector3d half_size;  ///< > 0 [m]
};
struct NamedBox {
  std::string name;
  Box box;
};

/// What the arm could run into: "table", "board" (a sheet of 6 mm with its margin), "stand" (the
/// post behind the board, down to the floor).
[[nodiscard]] std::vector<NamedBox> SurroundingsOf(const Rig& rig);

/// Everything within `radius_m` of the line from a to b.
struct Capsule {
  Eigen::Vector3d a;
  Eigen::Vector3d b;
  double radius_m;
};
/// A part of the arm, in the frame of its link.
struct ArmPart {
  std::string name;  ///< "link 5", "hand"
  int link;          ///< 0 is the base; one more than the arm has joints is the controlled frame e.
  Capsule capsule;
};
/// Links 1 to 7 and the hand with its fingers: capsules around the maker's shape of each.
[[nodiscard]] const std::vector<ArmPart>& ArmParts();
/// The right finger with what it holds (Rig::finger_reach_m), in the controlled frame e.
[[nodiscard]] Capsule RightFinger(const Rig& rig);

/// From surface to surface; negative where they overlap [m].
[[nodiscard]] double Distance(const Capsule& capsule, const Box& box);
[[nodiscard]] double Distance(const Capsule& first, const Capsule& second);

/// The two that are nearest to each other.
struct Clearance {
  double distance_m = 0.0;
  std::string what;  ///< "hand to table", "link 3 to hand"
};

/// How far the arm is from its surroundings, from the boxes that its owner keeps it out of, and
/// from itself. The camera and the IMU of the rig count as spheres of 20 mm on the hand. Links that
/// touch by their build are left out: neighbours, and those with one link between; the base and
/// link 1, which can't leave their place, against boxes.
class ClearanceCheck {
 public:
  /// Of the Panda.
  explicit ClearanceCheck(const Rig& rig);
  /// Of any arm.
  /// @param frames  Of the links: T_b_link of link 1, 2, .., then T_b_e.
  ClearanceCheck(const Rig& rig, std::vector<ArmPart> parts,
                 std::function<std::vector<Rigid3>(const JointVector& q)> frames, int num_joints);
  [[nodiscard]] Clearance Least(const JointVector& q) const;

 private:
  std::function<std::vector<Rigid3>(const JointVector& q)> frames_;
  std::vector<ArmPart> parts_;
  std::vector<NamedBox> things_;
};

}  // namespace calibrato
