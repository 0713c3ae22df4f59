#include "calibrato/motion/robot_formats.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <sstream>
#include <variant>

#include "calibrato/base/full_sample_for_test.h"
#include "calibrato/base/input_error.h"
#include "calibrato/base/value.h"
#include "calibrato/motion/franka_checks_for_test.h"
#include "calibrato/motion/paper_scene.h"

namespace calibrato {
namespace {

TimedMotion OnArm(Motion motion, Timing timing) {
  motion.carrier = Carrier::kArm;
  motion.timing = timing;
  return std::get<TimedMotion>(PlanMotion(motion, PaperRig()));
}

// Rows of numbers, by a reader of its own.
std::vector<std::vector<double>> Rows(const std::string& csv, bool has_header) {
  std::vector<std::vector<double>> rows;
  std::istringstream lines(csv);
  std::string line;
  if (has_header) std::getline(lines, line);
  while (std::getline(lines, line)) {
    std::vector<double>& row = rows.emplace_back();
    std::istringstream cells(line);
    std::string cell;
    while (std::getline(cells, cell, ',')) row.push_back(std::stod(cell));
  }
  return rows;
}

TEST(FrankaCsv, PassesTheChecksOfTheArmsController) {
  const int num_motions = FullSample() ? 50 : 2;
  for (const Timing timing : {Timing::kQuintic, Timing::kOptimal}) {
    Rng rng(8);
    FrankaShares worst;
    for (int i = 0; i < num_motions; ++i) {
      const TimedMotion timed =
          OnArm(RandomMotion(i % 2 == 0 ? Task::kExtrinsic : Task::kIntrinsic, rng), timing);
      std::vector<JointVector> commands;
      for (const std::vector<double>& row :
           Rows(RobotFile(timed, RobotFormat::kFrankaCsv), false)) {
        ASSERT_EQ(row.size(), 7u);
        commands.emplace_back(row.data());
        EXPECT_LE(JointLimitExcess(commands.back()), 0.0);
      }
      EXPECT_EQ(commands.size(),
                static_cast<size_t>(std::ceil(1e3 * timed.duration_s() - 1e-9)) + 1);
      EXPECT_LT((commands.front() - commands.back()).norm(), 1e-12);
      const FrankaShares shares = JudgedByFranka(commands);
      EXPECT_LT(shares.velocity, 1.0);
      EXPECT_LT(shares.acceleration, 1.0);
      EXPECT_LT(shares.jerk, 1.0);
      worst.velocity = std::max(worst.velocity, shares.velocity);
      worst.acceleration = std::max(worst.acceleration, shares.acceleration);
      worst.jerk = std::max(worst.jerk, shares.jerk);
    }
    if (FullSample()) {
      std::printf("%s: largest shares of velocity %.3f, acceleration %.3f, jerk %.3f\n",
                  TimingName(timing).c_str(), worst.velocity, worst.acceleration, worst.jerk);
    }
  }
}

TEST(FrankaCsv, ChecksSeeAStepAndAKink) {
  // The checks themselves: a step of 0.1 mrad and a velocity that jumps by 0.1 rad/s.
  std::vector<JointVector> still(100, JointVector::Zero());
  EXPECT_EQ(JudgedByFranka(still).jerk, 0.0);
  std::vector<JointVector> step = still;
  for (size_t k = 50; k < step.size(); ++k) step[k][2] = 1e-4;
  EXPECT_GT(JudgedByFranka(step).acceleration, 1.0);
  std::vector<JointVector> kink = still;
  for (size_t k = 50; k < kink.size(); ++k) kink[k][2] = 1e-4 * static_cast<double>(k - 50);
  EXPECT_GT(JudgedByFranka(kink).jerk, 1.0);
}

TEST(JointCsv, HasRatesThatAreItsOwnDifferencesAndRestsAtBothEnds) {
  Rng rng(4);
  for (const Timing timing : {Timing::kQuintic, Timing::kOptimal}) {
    const TimedMotion timed = OnArm(RandomMotion(Task::kExtrinsic, rng), timing);
    const std::string csv = RobotFile(timed, RobotFormat::kJointCsv);
    EXPECT_EQ(csv.substr(0, csv.find('\n')),
              "t [s],q1 [rad],q2 [rad],q3 [rad],q4 [rad],q5 [rad],q6 [rad],q7 [rad],"
              "dq1 [rad/s],dq2 [rad/s],dq3 [rad/s],dq4 [rad/s],dq5 [rad/s],dq6 [rad/s],"
              "dq7 [rad/s],ddq1 [rad/s^2],ddq2 [rad/s^2],ddq3 [rad/s^2],ddq4 [rad/s^2],"
              "ddq5 [rad/s^2],ddq6 [rad/s^2],ddq7 [rad/s^2]");
    const auto rows = Rows(csv, true);
    for (const auto& end : {rows.front(), rows.back()}) {
      for (size_t column = 8; column < 22; ++column) EXPECT_NEAR(end[column], 0.0, 1e-9);
    }
    for (size_t k = 1; k + 1 < rows.size(); ++k) {
      EXPECT_NEAR(rows[k][0], 1e-3 * static_cast<double>(k), 1e-12);
      for (size_t joint = 1; joint <= 7; ++joint) {
        const double velocity = (rows[k + 1][joint] - rows[k - 1][joint]) / 2e-3;
        const double acceleration = (rows[k + 1][joint + 7] - rows[k - 1][joint + 7]) / 2e-3;
        EXPECT_NEAR(rows[k][joint + 7], velocity, 5e-4);
        EXPECT_NEAR(rows[k][joint + 14], acceleration, 0.3);
      }
    }
  }
}

TEST(MoveItTrajectory, HasTheSameJointsEveryTenMilliseconds) {
  Rng rng(4);
  const TimedMotion timed = OnArm(RandomMotion(Task::kExtrinsic, rng), Timing::kQuintic);
  const Value file = ParseYaml(RobotFile(timed, RobotFormat::kMoveIt), "trajectory.yaml");
  const Value& trajectory = file.At("joint_trajectory");
  EXPECT_EQ(trajectory.At("joint_names").elements().front().AsString(), "panda_joint1");
  EXPECT_EQ(trajectory.At("joint_names").size(), 7u);
  const JointTrajectory expected(timed);
  double t_s = 0.0;
  for (const Value& point : trajectory.At("points").elements()) {
    const Value& time = point.At("time_from_start");
    EXPECT_NEAR(time.At("sec").AsDouble() + 1e-9 * time.At("nanosec").AsDouble(), t_s, 1e-9);
    const JointMotion joints = expected.At(t_s);
    EXPECT_LT((JointVector(point.At("positions").AsDoubles(7).data()) - joints.position).norm(),
              1e-9);
    EXPECT_LT((JointVector(point.At("velocities").AsDoubles(7).data()) - joints.velocity).norm(),
              1e-6);
    EXPECT_LT(
        (JointVector(point.At("accelerations").AsDoubles(7).data()) - joints.acceleration).norm(),
        1e-4);
    t_s += 0.01;
  }
  EXPECT_GE(t_s, timed.duration_s());
}

TEST(RobotFormat, RefusesUnknownNames) {
  EXPECT_EQ(RobotFormatFromName("moveit"), RobotFormat::kMoveIt);
  EXPECT_THROW((void)RobotFormatFromName("moveit2"), InputError);
}

}  // namespace
}  // namespace calibrato
