// From a plan to the calibration that it promised, by nothing but the files that a robot reads.
//
// Rigs, boards, their places and the mounts of their cameras are drawn. The planner is told lens,
// board and IMU as a data sheet tells them, but not how the camera sits on the hand (within 2 cm in
// each axis and 5 degrees about each): it has the nominal mount, and one look at the board from the
// start pose. The motion is designed for that, exported, and its joint positions executed by the
// arm's dynamics with the rig as it is.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "calibrato/base/full_sample_for_test.h"
#include "calibrato/base/input_error.h"
#include "calibrato/base/parallel.h"
#include "calibrato/base/value.h"
#include "calibrato/evaluation/statistics.h"
#include "calibrato/evaluation/trial.h"
#include "calibrato/mdp/design_setting.h"
#include "calibrato/mdp/motion_design.h"
#include "calibrato/mdp/motion_information.h"
#include "calibrato/motion/franka_checks_for_test.h"
#include "calibrato/motion/paper_scene.h"
#include "calibrato/motion/robot_formats.h"
#include "calibrato/simulation/arm_execution.h"
#include "calibrato/simulation/rig_distribution.h"

namespace calibrato {
namespace {

Rig BelievedAfterOneLook(const Rig& truth) {
  const Rig nominal = PaperRig();
  Rig believed = AsEstimated(truth);
  believed.T_e_c0 = nominal.T_e_c0;
  believed.T_c0_i = nominal.T_c0_i;
  believed.time_offset_i_c = {};
  const Rigid3 T_w_e = ArmBaseInWorld() * LoopPoseAt(BasePose(), LoopCoefficients::Zero(), 0.0);
  const Rigid3 T_c0_g = (T_w_e * truth.T_e_c0).Inverse() * truth.T_w_g;
  believed.T_w_g = T_w_e * nominal.T_e_c0 * T_c0_g;
  return believed;
}

// Nothing where the arm can't stand before this board.
std::optional<TimedMotion> Plan(Task task, const Rig& believed, Rng& rng) {
  const int evaluations = FullSample() ? 40 : 4;
  MotionDesignProblem problem;
  problem.task = task;
  problem.rigs = {believed};
  problem.num_loops = NumLoops(task);
  problem.max_path_m = task == Task::kIntrinsic ? 11.3641 : 3.3786;  // the handcrafted motions'
  problem.max_duration_s = 5.0 * problem.num_loops;
  // What the camera's unknown place moves the board's image by, at least.
  problem.extra_margin_px = 10.0;
  try {
    problem.base_pose = BasePoseBeforeBoard(believed);
    const auto design = DesignMotion(problem, RandomMotion(task, rng), {evaluations});
    if (!design) return std::nullopt;
    Motion motion = design->motion;
    motion.carrier = Carrier::kArm;
    return PlanScaledToFit(motion, believed);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

// One joint position a millisecond, from the file.
struct Commands {
  std::vector<JointVector> position;
  double largest_rate_at_ends = 0.0;  // Of velocities [rad/s] and accelerations [rad/s^2].
};

Commands ReadJointCsv(const std::string& csv) {
  Commands commands;
  std::istringstream lines(csv);
  std::string line;
  std::getline(lines, line);
  std::vector<double> row;
  while (std::getline(lines, line)) {
    row.clear();
    std::istringstream cells(line);
    std::string cell;
    while (std::getline(cells, cell, ',')) row.push_back(std::stod(cell));
    EXPECT_EQ(row.size(), 22U);
    const bool is_first = commands.position.empty();
    commands.position.emplace_back(row.data() + 1);
    if (!is_first) continue;
    for (size_t k = 8; k < 22; ++k) {
      commands.largest_rate_at_ends = std::max(commands.largest_rate_at_ends, std::abs(row[k]));
    }
  }
  for (size_t k = 8; k < row.size(); ++k) {
    commands.largest_rate_at_ends = std::max(commands.largest_rate_at_ends, std::abs(row[k]));
  }
  return commands;
}

// A trajectory's points as a joint trajectory controller takes them: between two, the polynomial of
// degree 5 through positions, velocities and accelerations of both.
Commands ReadMoveIt(const std::string& yaml) {
  struct Point {
    double t_s;
    JointVector q, v, a;
  };
  const Value file = ParseYaml(yaml, "trajectory.yaml");
  std::vector<Point> points;
  for (const Value& point : file.At("joint_trajectory").At("points").elements()) {
    const Value& time = point.At("time_from_start");
    points.push_back({time.At("sec").AsDouble() + 1e-9 * time.At("nanosec").AsDouble(),
                      JointVector(point.At("positions").AsDoubles(7).data()),
                      JointVector(point.At("velocities").AsDoubles(7).data()),
                      JointVector(point.At("accelerations").AsDoubles(7).data())});
  }
  Commands commands;
  for (const Point& end : {points.front(), points.back()}) {
    commands.largest_rate_at_ends = std::max(
        {commands.largest_rate_at_ends, end.v.cwiseAbs().maxCoeff(), end.a.cwiseAbs().maxCoeff()});
  }
  size_t i = 0;
  const auto num_cycles = static_cast<int>(std::lround(1e3 * points.back().t_s));
  for (int k = 0; k <= num_cycles; ++k) {
    const double t_s = 1e-3 * k;
    while (i + 2 < points.size() && points[i + 1].t_s <= t_s) ++i;
    const Point& p = points[i];
    const Point& n = points[i + 1];
    const double h = n.t_s - p.t_s;
    const double u = (t_s - p.t_s) / h;
    const JointVector rise = n.q - p.q - h * p.v - 0.5 * h * h * p.a;
    const JointVector slope = h * (n.v - p.v - h * p.a);
    const JointVector bend = h * h * (n.a - p.a);
    commands.position.emplace_back(p.q + h * u * p.v + 0.5 * h * h * u * u * p.a +
                                   u * u * u *
                                       ((10.0 * rise - 4.0 * slope + 0.5 * bend) +
                                        u * ((-15.0 * rise + 7.0 * slope - bend) +
                                             u * (6.0 * rise - 3.0 * slope + 0.5 * bend))));
  }
  return commands;
}

// The largest share of each limit that the planner keeps, by differences.
struct Shares {
  double joint_excess_rad = -1.0;
  double velocity = 0.0;
  double acceleration = 0.0;
  double jerk = 0.0;  // Of libfranka's bound.

  void Take(const Shares& other) {
    joint_excess_rad = std::max(joint_excess_rad, other.joint_excess_rad);
    velocity = std::max(velocity, other.velocity);
    acceleration = std::max(acceleration, other.acceleration);
    jerk = std::max(jerk, other.jerk);
  }
};

Shares SharesOf(const std::vector<JointVector>& q) {
  constexpr double kCycle = 1e-3;  // [s]
  Shares shares;
  shares.jerk = JudgedByFranka(q).jerk;
  for (size_t k = 0; k < q.size(); ++k) {
    shares.joint_excess_rad = std::max(shares.joint_excess_rad, JointLimitExcess(q[k]));
    if (k + 1 == q.size()) break;
    const JointVector velocity = (q[k + 1] - q[k]) / kCycle;
    const JointVector before = k > 0 ? q[k - 1] : q[k];
    const JointVector acceleration = (q[k + 1] - 2.0 * q[k] + before) / (kCycle * kCycle);
    const auto share = [](const JointVector& values, const JointVector& limits) {
      return values.cwiseAbs().cwiseQuotient(limits).maxCoeff();
    };
    shares.velocity = std::max(shares.velocity, share(velocity, Limits().velocity));
    shares.acceleration = std::max(shares.acceleration, share(acceleration, Limits().acceleration));
  }
  return shares;
}

// @param beyond  How far what lies between the plan's samples may swing beyond the planner's own
// limits of velocity and acceleration, which are met exactly; those of libfranka are wider.
void ExpectAccepted(const Commands& commands, double beyond, const std::string& what) {
  const Shares shares = SharesOf(commands.position);
  EXPECT_LE(shares.joint_excess_rad, 0.0) << what;
  EXPECT_LE(shares.velocity, 1.0 + beyond) << what;
  EXPECT_LE(shares.acceleration, 1.0 + beyond) << what;
  const FrankaShares franka = JudgedByFranka(commands.position);
  EXPECT_LT(franka.velocity, 1.0) << what;
  EXPECT_LT(franka.acceleration, 1.0) << what;
  EXPECT_LT(franka.jerk, 1.0) << what;
  EXPECT_LT(commands.largest_rate_at_ends, 1e-9) << what;
}

// What a plan says of itself: standard deviations by the name of the error that they belong to.
std::map<std::string, double> Predicted(Task task, const Rig& believed, const Motion& motion) {
  if (task == Task::kIntrinsic) {
    const auto information = ExpectIntrinsicInformation(believed, motion);
    if (!information) return {};
    const int focal = CameraModel::FocalIndex(std::string(believed.cameras[0].model.name()));
    const Eigen::Vector4d variance = information->covariance.diagonal().segment<4>(focal);
    return {{"focal length", std::sqrt(variance.head<2>().mean())},
            {"image centre", std::sqrt(variance.tail<2>().mean())}};
  }
  const auto information = ExpectExtrinsicInformation(believed, motion);
  if (!information) return {};
  const Eigen::VectorXd variance = information->covariance.diagonal();
  return {{"rotation", std::sqrt(variance.head<3>().sum())},
          {"translation", std::sqrt(variance.segment<3>(3).sum())},
          {"time offset", std::sqrt(variance(6))}};
}

std::map<std::string, double> Errors(Task task, const Trial& trial) {
  if (task == Task::kIntrinsic) {
    return {{"focal length", trial.focal_error_px}, {"image centre", trial.centre_error_px}};
  }
  return {{"rotation", trial.rotation_error_rad},
          {"translation", trial.translation_error_m},
          {"time offset", trial.time_offset_error_s}};
}

struct Outcome {
  bool is_planned = false;
  std::string failure;  // Of the calibration.
  Shares shares;
  std::map<std::string, double> squared_ratio;  // (error / predicted)^2 by name.
};

TimedMotion WithDurations(TimedMotion timed) {
  for (size_t i = 0; i < timed.motion.loops.size(); ++i) {
    timed.motion.loops[i].duration_s = timed.loop_duration_s[i];
  }
  return timed;
}

Outcome PlanExportAndReplay(Task task, uint64_t index) {
  const Rng rng(20);
  Rng draws = rng.Stream("rig", index);
  Rng start = rng.Stream(TaskName(task), index);
  const Rig rig = DrawRig(RigDistribution::kBroad, draws);
  const Rig believed = BelievedAfterOneLook(rig);
  Outcome outcome;
  const std::optional<TimedMotion> plan = Plan(task, believed, start);
  if (!plan) return outcome;
  outcome.is_planned = true;
  const TimedMotion timed = WithDurations(*plan);

  const Commands commands = ReadJointCsv(RobotFile(timed, RobotFormat::kJointCsv));
  const Commands points = ReadMoveIt(RobotFile(timed, RobotFormat::kMoveIt));
  const std::string what = TaskName(task) + " " + std::to_string(index);
  // Jerk jumps at way-points, which polynomials over 10 ms can't follow.
  ExpectAccepted(commands, 1e-3, what + ", joint-csv");
  ExpectAccepted(points, 5e-3, what + ", moveit");
  outcome.shares = SharesOf(commands.position);
  outcome.shares.Take(SharesOf(points.position));
  for (size_t k = 0; k < commands.position.size(); ++k) {
    constexpr double kFarBelowTracking = 1e-5;  // [rad]
    EXPECT_LT((commands.position[k] - points.position[k]).norm(), kFarBelowTracking) << what;
  }

  const ArmScene scene(rig);
  Rng ripple = rng.Stream("ripple", index);
  const ArmExecution execution = ExecuteCommands(scene, rig, commands.position, ripple);
  ExecutableMotion replayed;
  replayed.path = PathOf(execution, 1e-3 * static_cast<double>(commands.position.size() - 1));
  const Trial trial = RunTrial(task, rig, replayed, Fidelity::kFast, rng.Stream("noise", index));
  outcome.failure = trial.failure;
  const std::map<std::string, double> predicted = Predicted(task, believed, timed.motion);
  EXPECT_FALSE(predicted.empty()) << what;
  for (const auto& [name, error] : Errors(task, trial)) {
    const double ratio = error / predicted.at(name);
    outcome.squared_ratio[name] = ratio * ratio;
  }
  return outcome;
}

// One outcome a rig, for this many rigs that the arm can stand before.
void ExpectWhatWasPredicted(Task task, size_t num_rigs) {
  constexpr size_t kTried = 8;  // at a time, whatever the number of threads
  std::vector<Outcome> outcomes;
  size_t num_drawn = 0;
  while (outcomes.size() < num_rigs) {
    const size_t num_now = std::min(kTried, num_rigs - outcomes.size());
    for (Outcome& outcome : ParallelMap<Outcome>(
             num_now, [&](size_t i) { return PlanExportAndReplay(task, num_drawn + i); })) {
      if (outcome.is_planned) outcomes.push_back(std::move(outcome));
    }
    num_drawn += num_now;
    ASSERT_LT(num_drawn, 2 * num_rigs + kTried) << "the arm can't stand before most boards";
  }
  Shares worst;
  std::map<std::string, std::vector<double>> squared;
  for (const Outcome& outcome : outcomes) {
    EXPECT_EQ(outcome.failure, "") << TaskName(task);
    worst.Take(outcome.shares);
    for (const auto& [name, ratio] : outcome.squared_ratio) squared[name].push_back(ratio);
  }
  std::printf(
      "%s: %zu rigs of %zu drawn; largest shares of velocity %.4f, acceleration %.4f, "
      "libfranka's jerk %.3f; joints within limits by %.4f rad\n",
      TaskName(task).c_str(), outcomes.size(), num_drawn, worst.velocity, worst.acceleration,
      worst.jerk, -worst.joint_excess_rad);
  for (const auto& [name, ratios] : squared) {
    const double ratio = std::sqrt(Mean(ratios));
    const Interval interval = BootstrapMean(ratios, Rng(1));
    std::printf("  %-12s error over predicted %.3f [%.3f, %.3f]\n", name.c_str(), ratio,
                std::sqrt(interval.low), std::sqrt(interval.high));
    if (FullSample()) {
      EXPECT_GT(ratio, 0.8) << name;
      EXPECT_LT(ratio, 1.2) << name;
    } else {
      // Of few rigs: by luck below, but not far above.
      EXPECT_GT(ratio, 0.0) << name;
      EXPECT_LT(ratio, 3.0) << name;
    }
  }
}

TEST(ExportedMotions, CalibrateAsPredictedWhenReplayedOnTheArm) {
  const size_t num_rigs = FullSample() ? 100 : 1;
  ExpectWhatWasPredicted(Task::kIntrinsic, num_rigs);
  ExpectWhatWasPredicted(Task::kExtrinsic, num_rigs);
}

}  // namespace
}  // namespace calibrato
