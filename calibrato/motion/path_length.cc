#include "calibrato/motion/motion.h"
#include "calibrato/motion/way_point.h"

namespace calibrato {
namespace {

double TranslationStep(const PoseVector& from, const PoseVector& to) {
  return (to - from).head<3>().norm();
}

// With C = 1 m/rad.
double RotationStep(const PoseVector& from, const PoseVector& to) {
  return (to - from).tail<3>().norm();
}

}  // namespace

double PathLength(const LoopCoefficients& coefficients) {
  double length = 0.0;
  PoseVector previous = PoseVector::Zero();
  for (int way_point = 1; way_point <= kNumWayPoints; ++way_point) {
    const PoseVector current = LoopOffsetAt(coefficients, WayPointPhase(way_point)).value;
    length += TranslationStep(previous, current) + RotationStep(previous, current);
    previous = current;
  }
  return length;
}

double PathLength(const Motion& motion) {
  double length = 0.0;
  for (const Loop& loop : motion.loops) length += PathLength(loop.coefficients);
  return length;
}

double PathLengthOriginal(const Motion& motion) {
  double length = 0.0;
  for (const Loop& loop : motion.loops) {
    PoseVector previous = PoseVector::Zero();
    for (int way_point = 1; way_point <= kNumWayPoints; ++way_point) {
      const PoseVector current = LoopOffsetAt(loop.coefficients, 0.1 * way_point).value;
      if (way_point > 1) length += TranslationStep(previous, current);
      length += RotationStep(previous, current);
      previous = current;
    }
  }
  return length;
}

}  // namespace calibrato
