#pragma once

#include <Eigen/Core>
#include <vector>

#include "calibrato/motion/looped_trajectory.h"

namespace calibrato {

/// The state of the Markov decision process at step t (paper, section 3.2): all that was seen and
/// done so far, S_t = [A_0 .. A_{t-1}, Y_0 .. Y_t]. Actions are before scaling.
struct History {
  std::vector<Eigen::VectorXd> observations;  ///< Y_0 .. Y_t: always one more than actions.
  std::vector<LoopCoefficients> actions;      ///< A_0 .. A_{t-1}
};

/// One step as the networks learn from it (paper, Algorithm 1, line 17).
struct Transition {
  History history;
  LoopCoefficients action;           ///< A_t, before scaling.
  double reward = 0.0;               ///< R_t
  Eigen::VectorXd next_observation;  ///< Y_{t+1}
};

}  // namespace calibrato
