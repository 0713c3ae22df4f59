#pragma once

#include "calibrato/motion/carrier.h"
#include "calibrato/motion/loop_kinematics.h"
#include "calibrato/motion/motion.h"

// What a loop demands of the free carrier, as smooth numbers with gradients: the constraints of
// those who improve motions by their gradients. Whether a motion fits is PlanMotion's to say.

namespace calibrato {

/// A number and its derivatives by the loop's coefficients and duration.
struct LoopDemand {
  double value = 0.0;
  double largest = 0.0;  ///< Of the instants' own, where the value is their smooth maximum.
  LoopGradient gradient;
};

/// Each the largest over the loop, as a share of the carrier's limit: at most 1 where it fits. The
/// maximum over 126 instants x_k is a smooth one, log(sum exp(50 x_k)) / 50: never below the
/// largest of them and at most 0.11 above.
struct LoopDemands {
  LoopDemand speed;
  LoopDemand acceleration;
  LoopDemand angular_speed;
  LoopDemand angular_acceleration;
  LoopDemand reach;
  LoopDemand depth;  ///< min_height - height, plus 1.
  LoopDemand view;   ///< Board centre's distance from the image's middle, of half the image.
};
[[nodiscard]] LoopDemands DemandsOf(const BasePose& base, const Loop& loop, const Rig& rig,
                                    const FreeCarrierLimits& limits = {});

/// PathLength(coefficients), its square roots rounded off near zero by 1e-6 m [m].
[[nodiscard]] LoopDemand PathLengthWithGradient(const LoopCoefficients& coefficients);

}  // namespace calibrato
