#pragma once

#include <string>
#include <vector>

#include "calibrato/base/value.h"
#include "calibrato/motion/joint_motion.h"

namespace calibrato {

/// What the joints of an arm do, and may do.
struct JointsAgainstLimits {
  std::vector<std::string> names;    ///< One a joint.
  double step_s = 0.001;             ///< Between samples.
  std::vector<JointMotion> samples;  ///< Two or more.
  std::vector<JointVector> torque;   ///< One a sample [N m]; empty where dynamics are not known.
  PandaLimits limits;                ///< torque counts only where torques are given.
};

/// The same of a motion that was planned on the Panda, at the rate of its controller.
[[nodiscard]] JointsAgainstLimits PandaJointsOf(const TimedMotion& timed);

/// As the page of a dry run draws them:
///
///     names       one a joint
///     quantities  [{name, unit, largest_share, joint: which takes it, from 1; t_s: [..];
///                   values: one list a joint; shares: one list a joint}..]
///
/// A share is the value over its limit; of positions, where it is between the limits: -1 at the
/// lower, 1 at the upper. Of each span of a few milliseconds the sample of the largest share of the
/// joint is drawn, so that no peak is lost; `largest_share` is over all samples.
[[nodiscard]] Value JointDrawing(const JointsAgainstLimits& joints);

}  // namespace calibrato
