#include "calibrato/motion/loop_demands.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "calibrato/base/rng.h"
#include "calibrato/geometry/expect_jacobian.h"
#include "calibrato/motion/board_in_view.h"
#include "calibrato/motion/loop_state.h"
#include "calibrato/motion/paper_scene.h"

namespace calibrato {
namespace {

using Eigen::VectorXd;

Loop RandomLoop(uint64_t seed) {
  Rng rng(seed);
  Motion motion = RandomMotion(Task::kIntrinsic, rng);
  motion.loops.front().duration_s = 4.2;
  return motion.loops.front();
}

std::vector<LoopDemand> All(const LoopDemands& d) {
  return {d.speed, d.acceleration, d.angular_speed, d.angular_acceleration,
          d.reach, d.depth,        d.view};
}

TEST(LoopDemands, AreTheLimitsOfTheFreeCarrier) {
  const BasePose base;
  const FreeCarrierLimits limits;
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    const Loop loop = RandomLoop(seed);
    std::vector<double> largest(6, 0.0);
    for (int i = 0; i <= 2000; ++i) {
      const CarrierState state = LoopStateAt(
          base, loop.coefficients, QuinticPhaseAt(loop.duration_s * i / 2000.0, loop.duration_s));
      const std::vector<double> shares = {
          state.velocity_b.norm() / limits.speed,
          state.acceleration_b.norm() / limits.acceleration,
          state.angular_velocity_b.norm() / limits.angular_speed,
          state.angular_acceleration_b.norm() / limits.angular_acceleration,
          (state.T_b_e.t - FreeCarrierShoulder()).norm() / limits.reach,
          1.0 + limits.min_height - state.T_b_e.t.z()};
      for (size_t k = 0; k < shares.size(); ++k) largest[k] = std::max(largest[k], shares[k]);
    }
    const std::vector<LoopDemand> demands = All(DemandsOf(base, loop, PaperRig()));
    for (size_t k = 0; k < largest.size(); ++k) {
      EXPECT_GE(demands[k].value, 0.99 * largest[k]) << seed << ' ' << k;
      EXPECT_LE(demands[k].value, largest[k] + 0.1) << seed << ' ' << k;
    }
  }
}

// Turned away until the board's centre leaves the image.
TEST(LoopDemands, KnowWhenTheBoardLeavesTheImage) {
  for (const double yaw : {0.1, 0.3, 0.5, 0.7}) {
    Loop loop;
    loop.coefficients[31] = yaw;
    bool in_view = true;
    for (int k = 0; k <= 1000; ++k) {
      const Rigid3 T_b_e = LoopPoseAt({}, loop.coefficients, 2.0 * M_PI * k / 1000.0);
      in_view = in_view && !CheckBoardInView(T_b_e, PaperRig());
    }
    const double value = DemandsOf({}, loop, PaperRig()).view.value;
    EXPECT_EQ(value <= 1.0 + 0.1, in_view) << yaw << ' ' << value;
  }
}

TEST(LoopDemands, HaveAnalyticGradients) {
  const BasePose base;
  for (uint64_t seed = 1; seed <= 3; ++seed) {
    const Loop loop = RandomLoop(seed);
    const std::vector<LoopDemand> demands = All(DemandsOf(base, loop, PaperRig()));
    Eigen::MatrixXd J(demands.size(), 37);
    for (size_t k = 0; k < demands.size(); ++k) {
      J.row(static_cast<Eigen::Index>(k)) << demands[k].gradient.coefficients.transpose(),
          demands[k].gradient.duration_s;
    }
    VectorXd x(37);
    x << loop.coefficients, loop.duration_s;
    ExpectJacobian(
        [&](const VectorXd& at) {
          const Loop moved{at.head<36>(), at[36]};
          const std::vector<LoopDemand> values = All(DemandsOf(base, moved, PaperRig()));
          VectorXd f(values.size());
          for (size_t k = 0; k < values.size(); ++k)
            f[static_cast<Eigen::Index>(k)] = values[k].value;
          return f;
        },
        x, J, 1e-5, 1e-5);
  }
}

TEST(PathLengthWithGradient, IsThePathLength) {
  const Loop loop = RandomLoop(7);
  const LoopDemand length = PathLengthWithGradient(loop.coefficients);
  EXPECT_NEAR(length.value, PathLength(loop.coefficients), 1e-6);
  ExpectJacobian(
      [&](const VectorXd& at) { return VectorXd::Constant(1, PathLength(LoopCoefficients(at))); },
      loop.coefficients, length.gradient.coefficients.transpose(), 1e-6, 1e-5);
}

}  // namespace
}  // namespace calibrato
