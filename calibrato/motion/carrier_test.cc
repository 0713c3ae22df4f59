#include "calibrato/motion/carrier.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "calibrato/base/input_error.h"
#include "calibrato/geometry/so3.h"
#include "calibrato/motion/board_in_view.h"
#include "calibrato/motion/paper_scene.h"

namespace calibrato {
namespace {

Motion OneLoop(int coefficient, double value) {
  Motion motion;
  motion.loops.emplace_back();
  motion.loops[0].coefficients[coefficient] = value;
  return motion;
}

TEST(Setting, InitialViewIsTheOriginals) {
  const Rig rig = PaperRig();
  const Rigid3 T_w_c0 =
      ArmBaseInWorld() * LoopPoseAt(BasePose(), LoopCoefficients::Zero(), 0.0) * rig.T_e_c0;
  EXPECT_NEAR(T_w_c0.t.x(), -0.5584, 5e-5);
  EXPECT_NEAR(T_w_c0.t.y(), -0.3300, 5e-5);
  EXPECT_NEAR(T_w_c0.t.z(), 0.4696, 5e-5);
  EXPECT_NEAR((rig.T_w_g * BoardCentre(rig.board) - T_w_c0.t).norm(), 1.4421, 5e-5);

  const Eigen::Matrix3Xd points_g = BoardPoints(rig.board);
  Eigen::Matrix2Xd pixels(2, points_g.cols());
  for (Eigen::Index i = 0; i < points_g.cols(); ++i) {
    const auto pixel =
        rig.cameras[0].model.Project(T_w_c0.Inverse() * (rig.T_w_g * points_g.col(i)));
    ASSERT_TRUE(pixel.has_value());
    pixels.col(i) = *pixel;
  }
  const Eigen::Vector2d mean = pixels.rowwise().mean();
  EXPECT_NEAR(mean.x(), 312.55, 0.05);
  EXPECT_NEAR(mean.y(), 228.02, 0.05);
  const Eigen::Vector2d size = pixels.rowwise().maxCoeff() - pixels.rowwise().minCoeff();
  EXPECT_NEAR(size.x(), 124.0, 0.1);
  EXPECT_NEAR(size.y(), 148.0, 0.1);
}

TEST(FreeCarrier, MakesBothHandcraftedMotions) {
  for (const Task task : {Task::kIntrinsic, Task::kExtrinsic}) {
    const auto plan = PlanMotion(HandcraftedMotion(task), PaperRig());
    EXPECT_TRUE(std::holds_alternative<TimedMotion>(plan)) << std::get<Refusal>(plan).Describe();
  }
}

TEST(FreeCarrier, StretchesALoopToExactlyItsSpeedLimit) {
  // y = 0.3 sin theta over 3 s: the peak of 0.3 m * 2 pi * 1.875 / 3 s = 1.178 m/s comes halfway.
  Motion motion = OneLoop(7, 0.3);
  motion.loops[0].duration_s = 3.0;
  motion.base_pose.xyz_m << 0.3, 0.0, 0.47;
  Rig rig = PaperRig();
  rig.cameras[0].resolution = {10000, 480};
  const auto plan = PlanMotion(motion, rig);
  ASSERT_TRUE(std::holds_alternative<TimedMotion>(plan)) << std::get<Refusal>(plan).Describe();
  const TimedMotion& timed = std::get<TimedMotion>(plan);
  double speed = 0.0;
  double acceleration = 0.0;
  for (int i = 0; i <= 10000; ++i) {
    const CarrierState state = timed.At(timed.duration_s() * i / 10000.0);
    speed = std::max(speed, state.velocity_b.norm());
    acceleration = std::max(acceleration, state.acceleration_b.norm());
  }
  const FreeCarrierLimits limits;
  EXPECT_GT(timed.duration_s(), 3.0);
  EXPECT_LE(speed, limits.speed * (1.0 + 1e-4));
  EXPECT_LE(acceleration, limits.acceleration * (1.0 + 1e-4));
  EXPECT_NEAR(std::max(speed / limits.speed, acceleration / limits.acceleration), 1.0, 1e-3);
}

TEST(FreeCarrier, NeverShortensALoop) {
  const auto plan = PlanMotion(OneLoop(7, 0.001), PaperRig());
  EXPECT_EQ(std::get<TimedMotion>(plan).duration_s(), 5.0);
}

TEST(FreeCarrier, RefusesByReachHeightAndViewAndNamesTheFirstWayPoint) {
  const Rig rig = PaperRig();
  // x = 0.4 + 0.4 sin theta at y = 0.3, z - 0.333 = 0.137: the reach of 0.75 m is left where x
  // passes 0.674, at sin theta = 0.684, theta = 0.753 = 7.4 way-points; it comes back mirrored.
  const auto reach = PlanMotion(OneLoop(1, 0.4), rig);
  ASSERT_TRUE(std::holds_alternative<Refusal>(reach));
  EXPECT_EQ(std::get<Refusal>(reach).limit, "reach from the shoulder");
  EXPECT_EQ(std::get<Refusal>(reach).loop, 0);
  EXPECT_EQ(std::get<Refusal>(reach).way_point, 8);
  EXPECT_EQ(std::get<Refusal>(reach).num_bad_way_points, 16);  // 8 .. 23
  EXPECT_EQ(std::get<Refusal>(reach).num_way_points, 62);

  const auto height = PlanMotion(OneLoop(13, -0.4), rig);
  EXPECT_EQ(std::get<Refusal>(height).limit, "height above the arm's base");
  EXPECT_LT(std::get<Refusal>(height).value, 0.1);

  const auto view = PlanMotion(OneLoop(31, 1.0), rig);
  EXPECT_EQ(std::get<Refusal>(view).limit, "board in view");
  EXPECT_EQ(std::get<Refusal>(view).unit, "px");

  const auto behind = PlanMotion(OneLoop(30, -1.5), rig);  // yaw by up to 3 rad
  EXPECT_EQ(std::get<Refusal>(behind).limit, "board in view");
}

TEST(CheckBoardInView, AWideLensMaySeeTheBoardBesideAndBehindIt) {
  const Motion motion = OneLoop(0, 0.0);
  const Rigid3 T_b_e = LoopPoseAt(motion.base_pose, motion.loops[0].coefficients, 0.0);
  const Rig pinhole = PaperRig();
  Rig fisheye = pinhole;
  fisheye.cameras[0].model = CameraModel(
      "pinhole-equi", (Eigen::VectorXd(8) << 120, 120, 319.5, 239.5, 0, 0, 0, 0).finished());
  EXPECT_FALSE(CheckBoardInView(T_b_e, pinhole));
  EXPECT_FALSE(CheckBoardInView(T_b_e, fisheye));
  // The camera turned away about its y axis by 1.75 rad: 120 * 1.75 = 210 px from the middle.
  const Rigid3 turn(ExpSo3(Eigen::Vector3d(0.0, 1.75, 0.0)), Eigen::Vector3d::Zero());
  const Rigid3 away = T_b_e * pinhole.T_e_c0 * turn * pinhole.T_e_c0.Inverse();
  EXPECT_FALSE(CheckBoardInView(away, fisheye));
  const auto refusal = CheckBoardInView(away, pinhole);
  ASSERT_TRUE(refusal);
  EXPECT_EQ(refusal->unit, "rad");
  EXPECT_NEAR(refusal->value, 1.75, 0.1);
}

TEST(FreeCarrier, RefusesNotANumber) {
  EXPECT_TRUE(std::holds_alternative<Refusal>(PlanMotion(OneLoop(0, std::nan("")), PaperRig())));
  EXPECT_TRUE(std::holds_alternative<Refusal>(PlanMotion(OneLoop(20, std::nan("")), PaperRig())));
}

TEST(TimedMotion, VelocitiesAndAccelerationsAreThoseOfThePoses) {
  const auto plan = PlanMotion(HandcraftedMotion(Task::kExtrinsic), PaperRig());
  const TimedMotion& timed = std::get<TimedMotion>(plan);
  const double step = 1e-4;
  for (const double t : {0.7, 4.9, 5.2, 8.3, 13.1}) {
    const CarrierState before = timed.At(t - step);
    const CarrierState here = timed.At(t);
    const CarrierState after = timed.At(t + step);
    EXPECT_LT((here.velocity_b - (after.T_b_e.t - before.T_b_e.t) / (2.0 * step)).norm(), 1e-6);
    EXPECT_LT((here.acceleration_b - (after.velocity_b - before.velocity_b) / (2.0 * step)).norm(),
              1e-5);
    const Eigen::Vector3d turn = LogSo3(after.T_b_e.R * before.T_b_e.R.transpose());
    EXPECT_LT((here.angular_velocity_b - turn / (2.0 * step)).norm(), 1e-6);
    EXPECT_LT((here.angular_acceleration_b -
               (after.angular_velocity_b - before.angular_velocity_b) / (2.0 * step))
                  .norm(),
              1e-5);
  }
}

TEST(TimedMotion, RestsAtTheBasePoseBetweenLoopsAndBeyondItsEnds) {
  const auto plan = PlanMotion(HandcraftedMotion(Task::kExtrinsic), PaperRig());
  const TimedMotion& timed = std::get<TimedMotion>(plan);
  const Rigid3 T_b_e = LoopPoseAt(BasePose(), LoopCoefficients::Zero(), 0.0);
  const double first = timed.loop_duration_s[0];
  for (const double t : {-1.0, 0.0, first, timed.duration_s(), 1e6}) {
    const CarrierState state = timed.At(t);
    EXPECT_LT(state.T_b_e.DifferenceTo(T_b_e).norm(), 1e-13);
    EXPECT_LT(state.velocity_b.norm(), 1e-13);
    EXPECT_LT(state.angular_acceleration_b.norm(), 1e-12);
  }
}

TEST(TimedMotion, TellsItsReadersHowItsPhaseRuns) {
  Motion motion = HandcraftedMotion(Task::kExtrinsic);
  const Value quintic = ToValue(std::get<TimedMotion>(PlanMotion(motion, PaperRig())));
  EXPECT_EQ(quintic.Find("loop_phase_control_points_rad"), nullptr);
  EXPECT_EQ(quintic.Find("joint_path_t_s_q_rad"), nullptr);
  motion.timing = Timing::kOptimal;
  const TimedMotion timed = std::get<TimedMotion>(PlanMotion(motion, PaperRig()));
  const Value optimal = ToValue(timed);
  EXPECT_EQ(optimal.At("timing").AsString(), "optimal");
  ASSERT_EQ(optimal.At("loop_duration_s").size(), 3u);
  // The phase in the middle of the first loop from what is written alone, by de Boor's recursion.
  const Value& points = optimal.At("loop_phase_control_points_rad").elements().at(0);
  std::vector<double> c = points.AsDoubles(points.size());
  const double position = 0.37 * static_cast<double>(c.size() - 3);
  const auto segment = static_cast<size_t>(position);
  const double u = position - static_cast<double>(segment);
  std::vector<double> d(c.begin() + static_cast<std::ptrdiff_t>(segment),
                        c.begin() + static_cast<std::ptrdiff_t>(segment) + 4);
  for (int level = 1; level <= 3; ++level) {
    for (int j = 3; j >= level; --j) {
      const double share = (u + 3 - j) / (4 - level);
      d[j] = (1.0 - share) * d[j - 1] + share * d[j];
    }
  }
  const double t_s = 0.37 * timed.loop_duration_s[0];
  const Rigid3 expected = LoopPoseAt(motion.base_pose, motion.loops[0].coefficients, d[3]);
  EXPECT_LT(timed.At(t_s).T_b_e.DifferenceTo(expected).norm(), 1e-12);
}

TEST(Refusal, DescribesItselfAndCountsLoopsFromOne) {
  Refusal refusal{.limit = "joint 4 lower limit",
                  .loop = 2,
                  .way_point = 17,
                  .value = -3.112,
                  .bound = -3.0718,
                  .unit = "rad",
                  .num_bad_way_points = 6,
                  .num_way_points = 248};
  EXPECT_EQ(refusal.Describe(),
            "joint 4 lower limit at loop 3, way-point 17: -3.11 rad, allowed -3.07 rad (6 of 248 "
            "way-points do not fit)");
  refusal.value = -3.07181;  // the digits show the difference, however small
  EXPECT_NE(refusal.Describe().find("-3.07181 rad, allowed -3.0718 rad"), std::string::npos);
  refusal.bound = std::numeric_limits<double>::quiet_NaN();  // nothing to hold it against
  EXPECT_EQ(refusal.Describe().find("allowed"), std::string::npos) << refusal.Describe();
}

TEST(PlanScaledToFit, LeavesAMotionThatFitsAsItIs) {
  const Motion motion = HandcraftedMotion(Task::kIntrinsic);
  const TimedMotion timed = PlanScaledToFit(motion, PaperRig());
  EXPECT_EQ(timed.scale, 1.0);
  EXPECT_EQ(timed.motion.loops[1].coefficients, motion.loops[1].coefficients);
}

TEST(PlanScaledToFit, FindsTheLargestFactor) {
  // The reach allows x = 0.6739 (above), of a motion to 0.4 + 0.4.
  const double expected = (std::sqrt(0.75 * 0.75 - 0.3 * 0.3 - 0.137 * 0.137) - 0.4) / 0.4;
  const TimedMotion timed = PlanScaledToFit(OneLoop(1, 0.4), PaperRig());
  EXPECT_LE(timed.scale, expected + 1e-3);  // way-points stand 0.0013 off the peak
  EXPECT_NEAR(timed.scale, expected, 3e-3);
  EXPECT_NEAR(timed.motion.loops[0].coefficients[1], 0.4 * timed.scale, 1e-15);
  EXPECT_TRUE(std::holds_alternative<TimedMotion>(PlanMotion(timed.motion, PaperRig())));
}

TEST(PlanScaledToFit, RefusesABasePoseOutOfReach) {
  Motion motion = OneLoop(1, 0.4);
  motion.base_pose.xyz_m.x() = 0.9;
  EXPECT_THROW((void)PlanScaledToFit(motion, PaperRig()), InputError);
}

}  // namespace
}  // namespace calibrato
