#include "calibrato/motion/robot_formats.h"

#include <cmath>
#include <cstdint>
#include <utility>

#include "calibrato/base/input_error.h"
#include "calibrato/base/nearest_name.h"
#include "calibrato/base/value.h"

namespace calibrato {
namespace {

constexpr size_t kPandaJoints = 7;
constexpr int kControlRate = 1000;  // [Hz], of the arm's controller
constexpr int kMoveItRate = 100;    // [Hz]; its controllers interpolate by polynomials of degree 5

void AppendNumbers(const JointVector& values, size_t num_joints, std::string* row) {
  for (size_t i = 0; i < num_joints; ++i) {
    if (!row->empty()) *row += ",";
    *row += FormatNumber(values[static_cast<Eigen::Index>(i)]);
  }
}

Value NumbersOf(const JointVector& values, size_t num_joints) {
  return Value::Numbers(Eigen::VectorXd(values.head(static_cast<Eigen::Index>(num_joints))));
}

std::string JointCsv(const TimedMotion& timed, size_t num_joints) {
  std::string text = "t [s]";
  const std::vector<std::pair<std::string, std::string>> columns = {
      {"q", " [rad]"}, {"dq", " [rad/s]"}, {"ddq", " [rad/s^2]"}};
  for (const auto& [name, unit] : columns) {
    for (size_t i = 1; i <= num_joints; ++i) text += "," + name + std::to_string(i) + unit;
  }
  text += "\n";
  int k = 0;
  for (const JointMotion& joints : JointSamples(timed, kControlRate)) {
    std::string row = FormatNumber(static_cast<double>(k++) / kControlRate);
    AppendNumbers(joints.position, num_joints, &row);
    AppendNumbers(joints.velocity, num_joints, &row);
    AppendNumbers(joints.acceleration, num_joints, &row);
    text += row + "\n";
  }
  return text;
}

std::string FrankaCsv(const TimedMotion& timed) {
  std::string text;
  for (const JointMotion& joints : JointSamples(timed, kControlRate)) {
    std::string row;
    AppendNumbers(joints.position, kPandaJoints, &row);
    text += row + "\n";
  }
  return text;
}

std::string MoveItTrajectory(const TimedMotion& timed, const RobotNames& robot) {
  const size_t num_joints = robot.joints.size();
  Value names = Value::Array();
  for (const std::string& name : robot.joints) names.Append(name);
  Value points = Value::Array();
  int k = 0;
  for (const JointMotion& joints : JointSamples(timed, kMoveItRate)) {
    constexpr int kNanosecondsPerPoint = 1'000'000'000 / kMoveItRate;
    Value time = Value::Object();
    time.Set("sec", k / kMoveItRate).Set("nanosec", k % kMoveItRate * kNanosecondsPerPoint);
    ++k;
    Value point = Value::Object();
    point.Set("positions", NumbersOf(joints.position, num_joints))
        .Set("velocities", NumbersOf(joints.velocity, num_joints))
        .Set("accelerations", NumbersOf(joints.acceleration, num_joints))
        .Set("time_from_start", std::move(time));
    points.Append(std::move(point));
  }
  Value header = Value::Object();
  header.Set("frame_id", robot.base_frame);
  Value trajectory = Value::Object();
  trajectory.Set("header", std::move(header))
      .Set("joint_names", std::move(names))
      .Set("points", std::move(points));
  Value file = Value::Object();
  file.Set("joint_trajectory", std::move(trajectory));
  return ToYaml(file);
}

}  // namespace

std::vector<JointMotion> JointSamples(const TimedMotion& timed, int rate_hz) {
  // A last step that a rounding error would add is none.
  constexpr double kRounding = 1e-9;
  const JointTrajectory trajectory(timed);
  const auto num_steps = static_cast<int64_t>(std::ceil(timed.duration_s() * rate_hz - kRounding));
  std::vector<JointMotion> samples;
  samples.reserve(static_cast<size_t>(num_steps) + 1);
  for (int64_t k = 0; k <= num_steps; ++k) {
    samples.push_back(trajectory.At(static_cast<double>(k) / rate_hz));
  }
  return samples;
}

RobotFormat RobotFormatFromName(const std::string& name) {
  if (name == "joint-csv") return RobotFormat::kJointCsv;
  if (name == "moveit") return RobotFormat::kMoveIt;
  if (name == "franka-csv") return RobotFormat::kFrankaCsv;
  const auto nearest = NearestName(name, {"joint-csv", "moveit", "franka-csv"});
  throw InputError({"unknown --format '" + name + "'", "",
                    "there are joint-csv, moveit and franka-csv",
                    nearest ? "did you mean " + *nearest + "?" : "choose one of them"});
}

const RobotNames& PandaNames() {
  static const RobotNames names = [] {
    RobotNames panda{{}, "panda_link0"};
    for (size_t i = 1; i <= kPandaJoints; ++i) {
      panda.joints.push_back("panda_joint" + std::to_string(i));
    }
    return panda;
  }();
  return names;
}

std::string RobotFile(const TimedMotion& timed, RobotFormat format, const RobotNames& names) {
  switch (format) {
    case RobotFormat::kJointCsv:
      return JointCsv(timed, names.joints.size());
    case RobotFormat::kMoveIt:
      return MoveItTrajectory(timed, names);
    case RobotFormat::kFrankaCsv:
      return FrankaCsv(timed);
  }
  return {};
}

}  // namespace calibrato
