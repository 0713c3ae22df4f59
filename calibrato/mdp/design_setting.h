#pragma once

#include <vector>

#include "calibrato/base/rng.h"
#include "calibrato/motion/carrier.h"
#include "calibrato/motion/motion.h"
#include "calibrato/motion/paper_scene.h"
#include "calibrato/sensors/rig.h"
#include "calibrato/simulation/rig_distribution.h"

// What a MotionDesignProblem is usually made of.

namespace calibrato {

/// The rig with its camera as the intrinsic task estimates it: pinholes with all five distortion
/// parameters (those it lacks 0), other lenses as they are.
[[nodiscard]] Rig AsEstimated(Rig rig);

/// What a distribution lets one believe: the nominal rig, then draws, all as estimated. The draws'
/// mounts are the nominal rig's, and the middles of their boards where its board has it, since a
/// motion is planned anew before each board (BeforeBoard).
/// @param num_draws  >= 0
[[nodiscard]] std::vector<Rig> BelievedRigs(RigDistribution distribution, int num_draws,
                                            const Rng& rng, const Rig& nominal = PaperRig());

/// What was planned in the paper's scene, planned anew before a board that stands elsewhere
/// (BasePoseBeforeBoard); shrunk where it does not fit there.
/// @throws InputError if it fits at no scale.
[[nodiscard]] TimedMotion BeforeBoard(const TimedMotion& motion, const Rig& rig);

/// What a motion takes.
struct MotionBudget {
  double path_m = 0.0;      ///< path_length_m [m]
  double duration_s = 0.0;  ///< [s]
};
/// Of a motion as its carrier makes it: stretched, and shrunk where it does not fit.
/// @throws InputError if it fits at no scale.
[[nodiscard]] MotionBudget BudgetOf(const Motion& motion, const Rig& rig);

}  // namespace calibrato
