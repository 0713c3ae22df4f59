#include "calibrato/motion/motion.h"

namespace calibrato {

Motion RandomMotion(Task task, Rng& rng) {
  constexpr double kAmplitude = 0.02;
  Motion motion;
  for (int i = 0; i < NumLoops(task); ++i) {
    LoopCoefficients action;
    for (double& coefficient : action) coefficient = rng.Uniform(-kAmplitude, kAmplitude);
    motion.loops.push_back({.coefficients = ScaledAction(action)});
  }
  motion.provenance.Set("method", "random").Set("task", TaskName(task));
  return motion;
}

}  // namespace calibrato
