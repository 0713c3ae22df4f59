#include "calibrato/cli/learn_document.h"

#include <cmath>
#include <sstream>
#include <utility>

#include "calibrato/base/files.h"
#include "calibrato/base/input_error.h"
#include "calibrato/motion/carrier.h"

namespace calibrato {
namespace {

constexpr size_t kMaxLogBytes = size_t{2} << 30;

template <typename Vector>
Value Rounded(const Vector& vector) {
  Value array = Value::Array();
  for (const double x : vector) array.Append(std::round(1e4 * x) / 1e4);
  return array;
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

}  // namespace

Value TrainingLines(const std::string& folder) {
  const std::string path = folder + "/training.jsonl";
  std::istringstream lines(ReadFile(path, kMaxLogBytes));
  Value array = Value::Array();
  for (std::string line; std::getline(lines, line) && !lines.eof();) {
    array.Append(ParseJson(line, path));
  }
  return array;
}

Value MotionDrawing(const Motion& motion, const Rig& rig) {
  constexpr int kPointsALoop = 60;
  constexpr int kAxesEvery = 6;
  if (motion.loops.empty()) return {};
  TimedMotion timed;
  try {
    timed = PlanScaledToFit(motion, rig);
  } catch (const InputError&) {
    return {};
  }
  Value loops = Value::Array();
  Value axes = Value::Array();
  double start_s = 0.0;
  for (const double duration_s : timed.loop_duration_s) {
    Value loop = Value::Array();
    for (int k = 0; k <= kPointsALoop; ++k) {
      const Rigid3 T_b_c0 = timed.At(start_s + duration_s * k / kPointsALoop).T_b_e * rig.T_e_c0;
      loop.Append(Rounded(T_b_c0.t));
      if (k % kAxesEvery != 0) continue;
      Eigen::Matrix<double, 6, 1> axis;
      axis << T_b_c0.t, T_b_c0.R.col(2);
      axes.Append(Rounded(axis));
    }
    start_s += duration_s;
    loops.Append(std::move(loop));
  }
  Value drawing = Value::Object();
  drawing.Set("policy", "learned")
      .Set("path_length_m", PathLength(motion))
      .Set("motion_s", timed.duration_s())
      .Set("loops", std::move(loops))
      .Set("axis_b", std::move(axes))
      .Set("board_outline_b", BoardOutline(rig));
  return drawing;
}

}  // namespace calibrato
