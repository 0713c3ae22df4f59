#include "calibrato/mdp/motion_information.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <optional>
#include <variant>

#include "calibrato/geometry/expect_jacobian.h"
#include "calibrato/motion/carrier.h"
#include "calibrato/motion/paper_scene.h"

namespace calibrato {
namespace {

using Eigen::VectorXd;

using Expect = std::optional<MotionInformation> (*)(const Rig&, const Motion&,
                                                    const MotionInformationOptions&);

// The motion with the durations that the free carrier needs.
Motion OnFreeCarrier(const Motion& motion) {
  const TimedMotion timed = std::get<TimedMotion>(PlanMotion(motion, PaperRig()));
  Motion executed = motion;
  for (size_t i = 0; i < executed.loops.size(); ++i) {
    executed.loops[i].duration_s = timed.loop_duration_s[i];
  }
  return executed;
}

// Number 3 of the independent figures: with the quintic time law and 50 frames a loop about 0.24 %.
TEST(ExpectIntrinsicInformation, OfTheHandcraftedMotionIsWhatOthersFound) {
  const Rig rig = PaperRig();
  Rig undistorted = rig;
  undistorted.cameras.front().model = CameraModel("pinhole-radtan5", [&] {
    VectorXd parameters = VectorXd::Zero(9);
    parameters.head<4>() = rig.cameras.front().model.focal_and_centre();
    return parameters;
  }());
  MotionInformationOptions options;
  options.visibility_softness_px = 1e-3;
  const auto information =
      ExpectIntrinsicInformation(undistorted, HandcraftedMotion(Task::kIntrinsic), options);
  ASSERT_TRUE(information.has_value());
  const double bound = std::sqrt(information->criterion) /
                       undistorted.cameras.front().model.focal_and_centre().norm();
  EXPECT_NEAR(bound, 0.0024, 0.0001);
}

// Number 5: sigmas of rotation, translation and time offset.
TEST(ExpectExtrinsicInformation, OfTheHandcraftedMotionIsWhatOthersFound) {
  const auto information = ExpectExtrinsicInformation(
      PaperRig(), OnFreeCarrier(HandcraftedMotion(Task::kExtrinsic)), {});
  ASSERT_TRUE(information.has_value());
  const VectorXd variance = information->covariance.diagonal();
  EXPECT_NEAR(std::sqrt(variance.segment<3>(0).sum()), 7.8e-4, 0.15 * 7.8e-4);
  EXPECT_NEAR(std::sqrt(variance.segment<3>(3).sum()), 1.29e-3, 0.15 * 1.29e-3);
  EXPECT_NEAR(std::sqrt(variance(6)), 0.054e-3, 0.15 * 0.054e-3);
}

void ExpectGradient(const Expect expect, const Motion& motion, DesignCriterion criterion) {
  const Rig rig = PaperRig();
  MotionInformationOptions options;
  options.criterion = criterion;
  options.want_gradient = true;
  const auto information = expect(rig, motion, options);
  ASSERT_TRUE(information.has_value());
  ASSERT_EQ(information->gradient.size(), motion.loops.size());
  options.want_gradient = false;
  for (size_t loop = 0; loop < motion.loops.size(); ++loop) {
    // In every seventh coefficient, and in the duration.
    for (int i = static_cast<int>(loop); i <= 36; i += 7) {
      const double analytic = i < 36 ? information->gradient[loop].coefficients[i]
                                     : information->gradient[loop].duration_s;
      const auto value = [&](double h) {
        Motion moved = motion;
        (i < 36 ? moved.loops[loop].coefficients[i] : moved.loops[loop].duration_s) += h;
        return expect(rig, moved, options).value().criterion;
      };
      const double step = i < 36 ? 1e-5 : 1e-3;
      const auto central = [&](double h) { return (value(h) - value(-h)) / (2.0 * h); };
      const double numeric = (4.0 * central(0.5 * step) - central(step)) / 3.0;
      EXPECT_NEAR(analytic, numeric,
                  2e-3 * std::abs(numeric) + 1e-7 * std::abs(information->criterion) / step)
          << "loop " << loop << ", number " << i;
    }
  }
}

Motion SomeMotion(Task task) {
  Rng rng(4);
  return OnFreeCarrier(RandomMotion(task, rng));
}

TEST(ExpectIntrinsicInformation, HasAnAnalyticGradient) {
  ExpectGradient(&ExpectIntrinsicInformation, SomeMotion(Task::kIntrinsic), DesignCriterion::kA);
  ExpectGradient(&ExpectIntrinsicInformation, SomeMotion(Task::kIntrinsic), DesignCriterion::kD);
}

TEST(ExpectExtrinsicInformation, HasAnAnalyticGradient) {
  ExpectGradient(&ExpectExtrinsicInformation, SomeMotion(Task::kExtrinsic), DesignCriterion::kA);
  ExpectGradient(&ExpectExtrinsicInformation, SomeMotion(Task::kExtrinsic), DesignCriterion::kD);
}

TEST(MotionInformation, IsNothingWhereNothingMoves) {
  Motion still = HandcraftedMotion(Task::kExtrinsic);
  for (Loop& loop : still.loops) loop.coefficients.setZero();
  EXPECT_FALSE(ExpectIntrinsicInformation(PaperRig(), still).has_value());
}

}  // namespace
}  // namespace calibrato
