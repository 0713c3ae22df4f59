#include "calibrato/evaluation/joint_drawing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <variant>

#include "calibrato/motion/paper_scene.h"

namespace calibrato {
namespace {

TEST(JointDrawing, LosesNoPeakAndNamesItsJoint) {
  JointsAgainstLimits joints;
  joints.names = {"shoulder", "elbow"};
  joints.step_s = 0.001;
  joints.limits = Limits();
  const JointVector none = JointVector::Zero();
  const JointMotion still{0.5 * (Limits().lower + Limits().upper), none, none, none};
  joints.samples.assign(6001, still);
  joints.samples[4321].velocity[1] = -0.5 * Limits().velocity[1];
  joints.samples[17].position[0] = Limits().upper[0];
  const Value drawing = JointDrawing(joints);
  ASSERT_EQ(drawing.At("quantities").size(), 4U);  // no torques were given
  const Value& position = drawing.At("quantities").elements()[0];
  EXPECT_EQ(position.At("joint").AsInt(), 1);
  EXPECT_NEAR(position.At("largest_share").AsDouble(), 1.0, 1e-12);
  const Value& velocity = drawing.At("quantities").elements()[1];
  EXPECT_EQ(velocity.At("joint").AsInt(), 2);
  EXPECT_NEAR(velocity.At("largest_share").AsDouble(), 0.5, 1e-12);
  const auto& times = velocity.At("t_s").elements();
  const auto& shares = velocity.At("shares").elements()[1].elements();
  ASSERT_EQ(times.size(), shares.size());
  EXPECT_LE(times.size(), 600U);
  const auto peak = std::ranges::min_element(
      shares, [](const Value& a, const Value& b) { return a.AsDouble() < b.AsDouble(); });
  EXPECT_NEAR(peak->AsDouble(), -0.5, 1e-5);
  EXPECT_NEAR(times[static_cast<size_t>(peak - shares.begin())].AsDouble(), 4.321, 0.011);
}

TEST(JointDrawing, OfAPlanKeepsAllLimits) {
  Motion motion = HandcraftedMotion(Task::kExtrinsic);
  motion.carrier = Carrier::kArm;
  motion.timing = Timing::kOptimal;
  const TimedMotion timed = std::get<TimedMotion>(PlanMotion(motion, PaperRig()));
  const Value drawing = JointDrawing(PandaJointsOf(timed));
  const auto& quantities = drawing.At("quantities").elements();
  ASSERT_EQ(quantities.size(), 5U);
  double largest = 0.0;
  for (const Value& quantity : quantities) {
    EXPECT_LE(quantity.At("largest_share").AsDouble(), 1.0 + 1e-3)
        << quantity.At("name").AsString();
    EXPECT_EQ(quantity.At("values").size(), 7U);
    if (quantity.At("name").AsString() == "position") continue;
    largest = std::max(largest, quantity.At("largest_share").AsDouble());
  }
  // As fast as the limits allow: something is at one.
  EXPECT_GT(largest, 0.95);
}

}  // namespace
}  // namespace calibrato
