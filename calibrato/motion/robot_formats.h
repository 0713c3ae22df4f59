#pragma once

#include <string>
#include <vector>

#include "calibrato/motion/carrier.h"
#include "calibrato/motion/joint_motion.h"

namespace calibrato {

/// The joints at equal times, from rest to rest: the first sample at 0, the last at the first
/// multiple of 1 / rate_hz at or after the motion's end.
/// @pre The motion was planned on the arm.
[[nodiscard]] std::vector<JointMotion> JointSamples(const TimedMotion& timed, int rate_hz);

/// What a robot calls its joints, and the frame that its first one turns in.
struct RobotNames {
  std::vector<std::string> joints;
  std::string base_frame;
};
[[nodiscard]] const RobotNames& PandaNames();

/// What robots read (docs/formats.md section 3). All angles in rad, all numbers to the last bit, so
/// that a reader's differences are the motion's.
enum class RobotFormat {
  kJointCsv,   ///< 1 kHz: t [s], q1 .. q7 [rad], dq1 .. dq7 [rad/s], ddq1 .. ddq7 [rad/s^2].
  kMoveIt,     ///< A JointTrajectory message of ROS 2 as YAML, 100 points a second.
  kFrankaCsv,  ///< 1 kHz: q1 .. q7 [rad] a row, no header: one command a control cycle.
};
[[nodiscard]] RobotFormat RobotFormatFromName(const std::string& name);  ///< @throws InputError

/// @pre The motion was planned on the arm.
/// @param names  As many joints as the arm has: seven at most.
[[nodiscard]] std::string RobotFile(const TimedMotion& timed, RobotFormat format,
                                    const RobotNames& names = PandaNames());

}  // namespace calibrato
