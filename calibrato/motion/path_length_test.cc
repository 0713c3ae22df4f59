#include <gtest/gtest.h>

#include <numbers>

#include "calibrato/motion/motion.h"

namespace calibrato {
namespace {

TEST(PathLength, OfTheHandcraftedMotionsIsThePapers) {
  const Motion intrinsic = HandcraftedMotion(Task::kIntrinsic);
  const Motion extrinsic = HandcraftedMotion(Task::kExtrinsic);
  EXPECT_NEAR(PathLengthOriginal(intrinsic), 11.1156, 1e-4);  // 11.116 m in Table 1
  EXPECT_NEAR(PathLengthOriginal(extrinsic), 3.3062, 1e-4);   // 3.306 m in Table 1
  EXPECT_NEAR(PathLength(intrinsic), 11.3641, 1e-4);
  EXPECT_NEAR(PathLength(extrinsic), 3.3786, 1e-4);
}

TEST(PathLength, OfACircleIsItsPolygonsPerimeter) {
  const double radius = 0.1;
  LoopCoefficients circle = LoopCoefficients::Zero();
  circle[0] = radius;      // x cos1
  circle[6 + 1] = radius;  // y sin1
  const double chord = 2.0 * radius * std::sin(std::numbers::pi / 62.0);
  EXPECT_NEAR(PathLength(circle), 62.0 * chord, 1e-12);
  // The original's way-points are 0.1 rad apart and leave out its first step.
  Motion motion;
  motion.loops.push_back({.coefficients = circle});
  EXPECT_NEAR(PathLengthOriginal(motion), 61.0 * 2.0 * radius * std::sin(0.05), 1e-12);
}

TEST(PathLength, GrowsWithTheCoefficientsAndAddsUpOverLoops) {
  Rng rng(1);
  Motion motion = RandomMotion(Task::kIntrinsic, rng);
  const double length = PathLength(motion);
  double sum = 0.0;
  for (Loop& loop : motion.loops) {
    sum += PathLength(loop.coefficients);
    loop.coefficients *= 0.5;
  }
  EXPECT_NEAR(sum, length, 1e-12);
  EXPECT_NEAR(PathLength(motion), 0.5 * length, 1e-12);
}

}  // namespace
}  // namespace calibrato
