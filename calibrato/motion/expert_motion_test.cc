#include "calibrato/motion/expert_motion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <variant>

#include "calibrato/motion/carrier.h"
#include "calibrato/motion/paper_scene.h"

namespace calibrato {
namespace {

TEST(ExpertMotion, FitsTheFreeCarrierAtItsLimits) {
  const auto planned = PlanMotion(ExpertMotion(), PaperRig());
  const auto* timed = std::get_if<TimedMotion>(&planned);
  ASSERT_NE(timed, nullptr) << std::get<Refusal>(planned).Describe();
  // Somewhere in every loop one of the limits is reached.
  const FreeCarrierLimits limits;
  double start_s = 0.0;
  for (const double duration_s : timed->loop_duration_s) {
    double largest = 0.0;
    for (int i = 0; i <= 500; ++i) {
      const CarrierState state = timed->At(start_s + duration_s * i / 500);
      largest = std::max({largest, state.velocity_b.norm() / limits.speed,
                          state.acceleration_b.norm() / limits.acceleration,
                          state.angular_velocity_b.norm() / limits.angular_speed,
                          state.angular_acceleration_b.norm() / limits.angular_acceleration});
    }
    EXPECT_NEAR(largest, 1.0, 1e-3);
    start_s += duration_s;
  }
}

TEST(ExpertMotion, SweepsEachDegreeOfFreedomThreeTimesToBothSides) {
  const Motion motion = ExpertMotion();
  ASSERT_EQ(motion.loops.size(), 13U);
  for (int k = 0; k < 6; ++k) {
    int num_turns = 0;
    for (size_t loop = 2 * static_cast<size_t>(k); loop < 2 * static_cast<size_t>(k) + 2; ++loop) {
      double before = 0.0;
      for (int i = 1; i <= 1000; ++i) {
        const PoseVector offset =
            LoopOffsetAt(motion.loops[loop].coefficients, 2.0 * M_PI * i / 1000).value;
        // Nothing else moves.
        EXPECT_NEAR(offset.norm(), std::abs(offset[k]), 1e-12);
        if (before <= 0.0 && offset[k] > 1e-9) ++num_turns;
        before = offset[k] > 1e-9 ? 1.0 : -1.0;
      }
    }
    EXPECT_EQ(num_turns, 3) << "degree of freedom " << k;
  }
}

}  // namespace
}  // namespace calibrato
