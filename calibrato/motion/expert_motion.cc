#include "calibrato/motion/expert_motion.h"

namespace calibrato {
namespace {

// Indices of harmonics within a degree of freedom.
constexpr int kSin1 = 1;
constexpr int kSin2 = 3;
constexpr double kWishedDuration = 0.5;  // [s]

// How far the controlled frame goes to either side in the paper's scene, so that the free carrier
// reaches and the whole board stays in an image of 1 rad: x y z [m], roll pitch yaw [rad].
const PoseVector kAmplitude = (PoseVector() << 0.15, 0.15, 0.15, 0.25, 0.5, 0.3).finished();
// Of these, in the figure eight, where all of them come together.
constexpr double kShareInFigureEight = 0.4;

Loop SweepLoop(int degree_of_freedom, int harmonic) {
  Loop loop;
  loop.duration_s = kWishedDuration;
  loop.coefficients[6 * degree_of_freedom + harmonic] = kAmplitude[degree_of_freedom];
  return loop;
}

// Across once while up and down twice; and so with the angles.
Loop FigureEight() {
  Loop loop;
  loop.duration_s = kWishedDuration;
  for (int k = 0; k < kAmplitude.size(); ++k) {
    const int harmonic = k % 2 == 1 ? kSin1 : kSin2;
    loop.coefficients[6 * k + harmonic] = kShareInFigureEight * kAmplitude[k];
  }
  return loop;
}

}  // namespace

Motion ExpertMotion() {
  Motion motion;
  for (int k = 0; k < kAmplitude.size(); ++k) {
    motion.loops.push_back(SweepLoop(k, kSin1));
    motion.loops.push_back(SweepLoop(k, kSin2));
  }
  motion.loops.push_back(FigureEight());
  motion.provenance.Set("method", "expert");
  return motion;
}

}  // namespace calibrato
