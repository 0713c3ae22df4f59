#include "calibrato/motion/looped_trajectory.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "calibrato/base/rng.h"

namespace calibrato {
namespace {

LoopCoefficients RandomCoefficients(uint64_t seed) {
  Rng rng(seed);
  LoopCoefficients coefficients;
  for (double& x : coefficients) x = rng.Uniform(-0.1, 0.1);
  return coefficients;
}

TEST(ScaledAction, ScalesRollPitchAndYawOnly) {
  const LoopCoefficients scaled = ScaledAction(LoopCoefficients::Ones());
  for (int i = 0; i < 18; ++i) EXPECT_EQ(scaled[i], 1.0);
  for (int i = 18; i < 24; ++i) EXPECT_EQ(scaled[i], 2.5);
  for (int i = 24; i < 30; ++i) EXPECT_EQ(scaled[i], 5.0);
  for (int i = 30; i < 36; ++i) EXPECT_EQ(scaled[i], 2.5);
}

TEST(LoopOffset, IsThatOfTheFormulaForEachHarmonicAndDegreeOfFreedom) {
  const double theta = 0.7;
  const int harmonics[] = {1, 2, 4};
  for (int i = 0; i < 36; ++i) {
    const LoopOffset offset = LoopOffsetAt(LoopCoefficients::Unit(i), theta);
    const double q = harmonics[(i % 6) / 2];
    const double expected = i % 2 == 0 ? std::cos(q * theta) - 1.0 : std::sin(q * theta);
    EXPECT_NEAR(offset.value[i / 6], expected, 1e-15);
    EXPECT_NEAR(offset.value.norm(), std::abs(expected), 1e-15);
  }
}

TEST(LoopOffset, VanishesAtTheStartAndAtTheEnd) {
  const LoopCoefficients coefficients = RandomCoefficients(1);
  EXPECT_EQ(LoopOffsetAt(coefficients, 0.0).value.norm(), 0.0);
  EXPECT_LT(LoopOffsetAt(coefficients, 2.0 * std::numbers::pi).value.norm(), 1e-14);
}

TEST(LoopOffset, DerivativesAgreeWithDifferences) {
  const LoopCoefficients coefficients = RandomCoefficients(2);
  const double step = 1e-5;
  for (const double theta : {0.0, 0.3, 2.0, 5.9}) {
    const LoopOffset here = LoopOffsetAt(coefficients, theta);
    const LoopOffset before = LoopOffsetAt(coefficients, theta - step);
    const LoopOffset after = LoopOffsetAt(coefficients, theta + step);
    EXPECT_LT((here.first - (after.value - before.value) / (2.0 * step)).norm(), 1e-8);
    EXPECT_LT((here.second - (after.first - before.first) / (2.0 * step)).norm(), 1e-8);
  }
}

TEST(LoopPose, AddsOffsetsToPositionAndFixedAxisAngles) {
  // At the default base pose, whose roll and yaw are a quarter turn to 4e-6, the controlled frame's
  // z axis is (cos 0.8, 0, -sin 0.8) turned: by hand R = Rz(90) Ry(p) Rx(90) has columns
  // (0, cos p, -sin p), (0, sin p, cos p), (1, 0, 0).
  const Rigid3 T_b_e = LoopPoseAt(BasePose(), LoopCoefficients::Zero(), 1.0);
  Eigen::Matrix3d expected;
  expected << 0.0, 0.0, 1.0, std::cos(0.8), std::sin(0.8), 0.0, -std::sin(0.8), std::cos(0.8), 0.0;
  EXPECT_LT((T_b_e.R - expected).norm(), 2e-5);
  EXPECT_EQ(T_b_e.t, Eigen::Vector3d(0.4, 0.3, 0.47));

  LoopCoefficients coefficients = LoopCoefficients::Zero();
  coefficients[6 * 2 + 1] = 0.1;   // z sin1
  coefficients[6 * 4 + 1] = -0.8;  // pitch sin1
  const Rigid3 moved = LoopPoseAt(BasePose(), coefficients, std::numbers::pi / 2.0);
  expected << 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0;
  EXPECT_LT((moved.R - expected).norm(), 2e-5);
  EXPECT_LT((moved.t - Eigen::Vector3d(0.4, 0.3, 0.57)).norm(), 1e-15);
}

}  // namespace
}  // namespace calibrato
