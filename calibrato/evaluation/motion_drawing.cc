#include "calibrato/evaluation/motion_drawing.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "calibrato/motion/panda.h"

namespace calibrato {
namespace {

// With no more digits than a picture shows; pages hold thousands of these.
template <typename Vector>
Value Rounded(const Vector& v) {
  Value value = Value::Array();
  for (const double x : v) value.Append(std::round(1e4 * x) / 1e4);
  return value;
}

// Where the motion's loops begin and end [s]; a recorded trajectory is one.
std::vector<double> LoopEnds(const ExecutableMotion& motion) {
  if (!motion.timed) return {0.0, motion.path.duration_s};
  std::vector<double> ends = {0.0};
  for (const double duration_s : motion.timed->loop_duration_s) {
    ends.push_back(ends.back() + duration_s);
  }
  return ends;
}

// Foot, elbows, wrist, flange: the origins of the links' frames, where they are not the same point.
Eigen::Matrix3Xd PandaPoints(const JointVector& q) {
  const PandaAxes axes = AxesOf(q);
  Eigen::Matrix3Xd points(3, 7);
  points << Eigen::Vector3d::Zero(), axes.T_b_link[1].t, axes.T_b_link[2].t, axes.T_b_link[3].t,
      axes.T_b_link[4].t, axes.T_b_link[6].t, axes.T_b_e.t;
  return points;
}

using ArmPoints = std::function<Eigen::Matrix3Xd(const JointVector& q)>;

Value Played(const CarrierPath& path, const Rigid3& T_e_c0, const ArmPoints& arm_points) {
  constexpr double kStep = 0.1;  // [s]
  constexpr int kMostSteps = 240;
  const int num_steps =
      std::clamp(static_cast<int>(std::ceil(path.duration_s / kStep)), 1, kMostSteps);
  const double step_s = path.duration_s / num_steps;
  Value camera = Value::Array();
  Value arm = Value::Array();
  for (int k = 0; k <= num_steps; ++k) {
    const Rigid3 T_b_c0 = path.at(k * step_s).T_b_e * T_e_c0;
    Eigen::Matrix<double, 7, 1> pose;
    pose << T_b_c0.t, Eigen::Quaterniond(T_b_c0.R).coeffs();
    camera.Append(Rounded(pose));
    if (path.joints) arm.Append(Rounded(arm_points(path.joints(k * step_s)).reshaped()));
  }
  Value played = Value::Object();
  played.Set("step_s", step_s).Set("camera_b", std::move(camera)).Set("arm_b", std::move(arm));
  return played;
}

}  // namespace

Value MotionDrawing(const ExecutableMotion& motion, const Rig& rig, const ArmPoints& arm_points) {
  constexpr int kPointsALoop = 60;
  constexpr int kAxesEvery = 6;
  const std::vector<double> ends = LoopEnds(motion);
  Value loops = Value::Array();
  Value axes = Value::Array();
  for (size_t i = 0; i + 1 < ends.size(); ++i) {
    Value loop = Value::Array();
    for (int k = 0; k <= kPointsALoop; ++k) {
      const double t_s = ends[i] + (ends[i + 1] - ends[i]) * k / kPointsALoop;
      const Rigid3 T_b_c0 = motion.path.at(t_s).T_b_e * rig.T_e_c0;
      loop.Append(Rounded(T_b_c0.t));
      if (k % kAxesEvery != 0) continue;
      Eigen::Matrix<double, 6, 1> axis;
      axis << T_b_c0.t, T_b_c0.R.col(2);
      axes.Append(Rounded(axis));
    }
    loops.Append(std::move(loop));
  }
  Value drawing = Value::Object();
  drawing.Set("path_length_m", motion.path_length_m)
      .Set("motion_s", motion.path.duration_s)
      .Set("loops", std::move(loops))
      .Set("axis_b", std::move(axes))
      .Set("played", Played(motion.path, rig.T_e_c0, arm_points ? arm_points : PandaPoints));
  return drawing;
}

Value BoardOutline(const Rig& rig) {
  const Rigid3 T_b_g = ArmBaseInWorld().Inverse() * rig.T_w_g;
  const Eigen::Matrix3Xd points = BoardPoints(rig.board);
  const Eigen::Vector3d near = points.rowwise().minCoeff();
  const Eigen::Vector3d far = points.rowwise().maxCoeff();
  Value outline = Value::Array();
  for (const auto& [x, y] : {std::pair{near.x(), near.y()},
                             {far.x(), near.y()},
                             {far.x(), far.y()},
                             {near.x(), far.y()}}) {
    const Eigen::Vector3d corner_b = T_b_g * Eigen::Vector3d(x, y, 0.0);
    outline.Append(Rounded(corner_b));
  }
  return outline;
}

}  // namespace calibrato
