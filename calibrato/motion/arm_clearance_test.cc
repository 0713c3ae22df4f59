#include "calibrato/motion/arm_clearance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "calibrato/base/rng.h"
#include "calibrato/geometry/so3.h"
#include "calibrato/motion/carrier.h"
#include "calibrato/motion/paper_scene.h"

namespace calibrato {
namespace {

using Eigen::Vector3d;

Vector3d Draw(Rng& rng) { return {rng.Normal(), rng.Normal(), rng.Normal()}; }

TEST(Distance, OfACapsuleBesideAndInsideABox) {
  const Box box{{}, {1.0, 0.5, 0.25}};
  EXPECT_NEAR(Distance(Capsule{{2.0, 0.0, 0.0}, {2.0, 3.0, 0.0}, 0.1}, box), 0.9, 1e-9);
  // Across the corner (1, 0.5): 3 and 4 parts beyond it.
  EXPECT_NEAR(Distance(Capsule{{1.3, 0.9, 0.0}, {1.3, 0.9, 0.0}, 0.1}, box), 0.4, 1e-9);
  // Through the middle: the way out is half the height.
  EXPECT_NEAR(Distance(Capsule{{-2.0, 0.0, 0.0}, {2.0, 0.0, 0.0}, 0.1}, box), -0.35, 1e-9);
}

TEST(Distance, OfCapsulesIsTheLeastOverAllPairsOfTheirPoints) {
  Rng rng(3);
  for (int i = 0; i < 50; ++i) {
    const Capsule first{Draw(rng), Draw(rng), 0.1};
    const Capsule second{Draw(rng), i % 5 == 0 ? first.a : Draw(rng), 0.2};
    constexpr int kGrid = 300;
    double least = std::numeric_limits<double>::infinity();
    for (int a = 0; a <= kGrid; ++a) {
      for (int b = 0; b <= kGrid; ++b) {
        const Vector3d p = first.a + (first.b - first.a) * a / kGrid;
        const Vector3d q = second.a + (second.b - second.a) * b / kGrid;
        least = std::min(least, (p - q).norm());
      }
    }
    EXPECT_NEAR(Distance(first, second), least - 0.3, 0.02);
    EXPECT_LE(Distance(first, second), least - 0.3 + 1e-12);
    EXPECT_NEAR(Distance(first, second), Distance(second, first), 1e-12);
  }
}

TEST(Distance, OfACapsuleAndABoxIsTheLeastOverItsLine) {
  Rng rng(4);
  for (int i = 0; i < 50; ++i) {
    const Box box{{ExpSo3(Draw(rng)), Draw(rng)}, Draw(rng).cwiseAbs()};
    const Capsule capsule{2.0 * Draw(rng), 2.0 * Draw(rng), 0.0};
    double least = std::numeric_limits<double>::infinity();
    constexpr int kGrid = 3000;
    for (int k = 0; k <= kGrid; ++k) {
      const Vector3d p = box.T_b_box.Inverse() * (capsule.a + (capsule.b - capsule.a) * k / kGrid);
      // The nearest point of the box to a point outside it.
      const Vector3d nearest = p.cwiseMax(-box.half_size).cwiseMin(box.half_size);
      least = std::min(least, (p - nearest).norm());
    }
    EXPECT_NEAR(std::max(Distance(capsule, box), 0.0), least, 2e-3);
  }
}

TEST(ClearanceCheck, AtTheStartOfTheMotionsIsWide) {
  JointVector ready;
  ready << 0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785;
  const Rig rig = PaperRig();
  const Clearance clearance = ClearanceCheck(rig).Least(ready);
  EXPECT_GT(clearance.distance_m, 0.05) << clearance.what;
}

TEST(ClearanceCheck, NamesTheTableUnderALowHand) {
  const Rig rig = PaperRig();
  JointVector low;
  low << 0.0, 1.1, 0.0, -1.9, 0.0, 3.0, 0.785;
  const Clearance clearance = ClearanceCheck(rig).Least(low);
  EXPECT_LT(clearance.distance_m, 0.0);
  EXPECT_NE(clearance.what.find("to table"), std::string::npos) << clearance.what;
}

// A ball of a link on the base's, the third away: whichever of the two is named first.
TEST(ClearanceCheck, HoldsTheArmAgainstItsBaseInAnyOrderOfParts) {
  const Rig rig = PaperRig();
  const Vector3d place(0.0, 0.0, 5.0);  // far from table and board
  const auto ball = [&](const char* name, int link, double way) {
    const Vector3d middle = place + Vector3d(way, 0.0, 0.0);
    return ArmPart{name, link, {middle, middle, 0.1}};
  };
  const auto frames = [](const JointVector&) {
    std::vector<Rigid3> all(7);
    all.back().t.z() = 10.0;  // the hand with camera and IMU, far as well
    return all;
  };
  const auto least = [&](const std::vector<ArmPart>& parts) {
    return ClearanceCheck(rig, parts, frames, 6).Least(JointVector::Zero());
  };
  EXPECT_NEAR(least({ball("base", 0, 0.0), ball("wrist", 3, 0.25)}).distance_m, 0.05, 1e-12);
  EXPECT_NEAR(least({ball("wrist", 3, 0.25), ball("base", 0, 0.0)}).distance_m, 0.05, 1e-12);
  EXPECT_EQ(least({ball("wrist", 3, 0.25), ball("base", 0, 0.0)}).what, "wrist to base");
  // Two links on they may touch by their build.
  EXPECT_GT(least({ball("base", 0, 0.0), ball("elbow", 2, 0.25)}).distance_m, 0.06);
}

TEST(SurroundingsOf, TheBoardsFrontIsWhereItsPointsAre) {
  const Rig rig = PaperRig();
  for (const NamedBox& thing : SurroundingsOf(rig)) {
    if (thing.name != "board") continue;
    const Rigid3 T_box_g = (ArmBaseInWorld() * thing.box.T_b_box).Inverse() * rig.T_w_g;
    const Eigen::Matrix3Xd points_g = BoardPoints(rig.board);
    for (Eigen::Index k = 0; k < points_g.cols(); ++k) {
      const Vector3d p = T_box_g * points_g.col(k);
      EXPECT_NEAR(p.z(), thing.box.half_size.z(), 1e-12);
      EXPECT_LT(std::abs(p.x()), thing.box.half_size.x() - 0.06);
      EXPECT_LT(std::abs(p.y()), thing.box.half_size.y() - 0.06);
    }
  }
}

}  // namespace
}  // namespace calibrato
