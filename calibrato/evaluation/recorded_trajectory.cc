#include "calibrato/evaluation/recorded_trajectory.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <sstream>

#include "calibrato/base/input_error.h"
#include "calibrato/base/scalar_text.h"
#include "calibrato/base/value.h"
#include "calibrato/geometry/pose_spline.h"
#include "calibrato/geometry/so3.h"

namespace calibrato {
namespace {

constexpr double kLongestInterval = 0.2;  // [s]
constexpr double kShortestTrajectory = 1.0;
constexpr double kKnotSpacing = 0.1;
constexpr int kOrder = 6;

using Numbers = std::array<double, 8>;

[[noreturn]] void Fail(const std::string& name, int line, const std::string& why) {
  throw InputError({"bad trajectory", name + " line " + std::to_string(line), why,
                    "write each pose as: stamp tx ty tz qx qy qz qw"});
}

Numbers ParseLine(const std::string& line, const std::string& name, int number) {
  std::istringstream words(line);
  Numbers numbers{};
  size_t count = 0;
  for (std::string word; words >> word; ++count) {
    const std::optional<double> value = ParseDecimal(word);
    if (!value || !std::isfinite(*value)) Fail(name, number, "'" + word + "' is no number");
    if (count < numbers.size()) numbers[count] = *value;
  }
  if (count != numbers.size()) {
    Fail(name, number, "expected 8 numbers, found " + std::to_string(count));
  }
  return numbers;
}

Rigid3 PoseOf(const Numbers& numbers, const std::string& name, int line) {
  const Eigen::Quaterniond q(numbers[7], numbers[4], numbers[5], numbers[6]);
  constexpr double kTolerance = 0.01;
  if (!(std::abs(q.norm() - 1.0) <= kTolerance)) {
    Fail(name, line, "the quaternion's norm is " + FormatNumber(q.norm()));
  }
  return {q.normalized().toRotationMatrix(), {numbers[1], numbers[2], numbers[3]}};
}

// Between two poses: straight, and turning at a steady rate.
Rigid3 PoseAt(const RecordedTrajectory& trajectory, double t_s) {
  const std::vector<double>& t = trajectory.t_s;
  if (t_s <= t.front()) return trajectory.T_g_c0.front();
  if (t_s >= t.back()) return trajectory.T_g_c0.back();
  const auto after = static_cast<size_t>(std::upper_bound(t.begin(), t.end(), t_s) - t.begin());
  const Rigid3& from = trajectory.T_g_c0[after - 1];
  const double share = (t_s - t[after - 1]) / (t[after] - t[after - 1]);
  return from.Perturbed(share * trajectory.T_g_c0[after].DifferenceTo(from));
}

}  // namespace

RecordedTrajectory ParseTumTrajectory(const std::string& text, const std::string& name) {
  RecordedTrajectory trajectory;
  std::optional<double> start;
  std::istringstream lines(text);
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    if (line.find_first_not_of(" \t\r") == std::string::npos || line.front() == '#') continue;
    const Numbers numbers = ParseLine(line, name, number);
    if (!start) start = numbers[0];
    const double t_s = numbers[0] - *start;
    if (!trajectory.t_s.empty()) {
      const double interval = t_s - trajectory.t_s.back();
      if (!(interval > 0.0)) Fail(name, number, "its stamp does not come after the one before");
      if (!(interval <= kLongestInterval)) {
        Fail(name, number,
             "it comes " + FormatNumber(interval) +
                 " s after the pose before; at most 0.2 s may be between two");
      }
    }
    trajectory.t_s.push_back(t_s);
    trajectory.T_g_c0.push_back(PoseOf(numbers, name, number));
  }
  if (trajectory.t_s.empty() || !(trajectory.t_s.back() >= kShortestTrajectory)) {
    Fail(name, number,
         "it ends after " + FormatNumber(trajectory.t_s.empty() ? 0.0 : trajectory.t_s.back()) +
             " s; at least one second is needed");
  }
  return trajectory;
}

CarrierPath PathAlong(const RecordedTrajectory& trajectory, const Rig& rig) {
  const double duration_s = trajectory.t_s.back();
  double spacing_s = kKnotSpacing;
  for (size_t i = 1; i < trajectory.t_s.size(); ++i) {
    spacing_s = std::max(spacing_s, trajectory.t_s[i] - trajectory.t_s[i - 1]);
  }
  const auto spline = std::make_shared<const PoseSpline>(SplineAlong(
      [&](double t_s) { return PoseAt(trajectory, t_s); }, kOrder, spacing_s, duration_s));
  const Rigid3 T_b_g = ArmBaseInWorld().Inverse() * rig.T_w_g;
  const Rigid3 T_c0_e = rig.T_e_c0.Inverse();
  CarrierPath path;
  path.duration_s = duration_s;
  path.at = [spline, T_b_g, T_c0_e, duration_s](double t_s) -> CarrierState {
    const bool is_moving = t_s >= 0.0 && t_s <= duration_s;
    const SplinePoint point = spline->At(std::clamp(t_s, 0.0, duration_s));
    const Rigid3& T_g_c0 = point.T_a_b;
    CarrierState state;
    state.T_b_e = T_b_g * T_g_c0 * T_c0_e;
    const auto in_b = [&](const Eigen::Vector3d& v_c0) -> Eigen::Vector3d {
      return T_b_g.R * (T_g_c0.R * v_c0);
    };
    const double moves = is_moving ? 1.0 : 0.0;
    const Eigen::Vector3d& omega = point.omega_b;
    const Eigen::Vector3d& arm = T_c0_e.t;
    state.velocity_b = moves * (T_b_g.R * point.velocity_a + in_b(omega.cross(arm)));
    state.acceleration_b = moves * (T_b_g.R * point.acceleration_a +
                                    in_b(point.alpha_b.cross(arm) + omega.cross(omega.cross(arm))));
    state.angular_velocity_b = moves * in_b(omega);
    state.angular_acceleration_b = moves * in_b(point.alpha_b);
    return state;
  };
  return path;
}

double PathLength(const CarrierPath& path) {
  constexpr double kStep = 5.0 / 62.0;
  const int num_steps = std::max(1, static_cast<int>(std::ceil(path.duration_s / kStep)));
  double length = 0.0;
  Rigid3 previous = path.at(0.0).T_b_e;
  for (int i = 1; i <= num_steps; ++i) {
    const Rigid3 current = path.at(path.duration_s * i / num_steps).T_b_e;
    length += (current.t - previous.t).norm() + LogSo3(previous.R.transpose() * current.R).norm();
    previous = current;
  }
  return length;
}

}  // namespace calibrato
