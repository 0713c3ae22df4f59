#include "calibrato/sensors/arm_limits.h"

#include "calibrato/sensors/camera_chain.h"

namespace calibrato {
namespace {

using JointVector = Eigen::Matrix<double, 7, 1>;

void AppendUnknown(const Value& value, const std::vector<std::string>& known,
                   std::vector<std::string>* warnings) {
  if (warnings == nullptr) return;
  const std::vector<std::string> unknown = value.UnknownKeys(known);
  warnings->insert(warnings->end(), unknown.begin(), unknown.end());
}

// One limit a joint; null for a joint without.
JointVector LimitsFromValue(const Value& value, double none) {
  JointVector limits = JointVector::Constant(none);
  const Value::Elements& joints = value.elements();
  if (joints.size() != 7) {
    value.Fail("bad joint limits", "there must be seven, found " + std::to_string(joints.size()),
               "write one number a joint, or null for a joint without a limit");
  }
  for (Eigen::Index i = 0; i < 7; ++i) {
    const Value& limit = joints[static_cast<size_t>(i)];
    if (!limit.IsNull()) limits[i] = limit.AsDouble();
  }
  return limits;
}

KeepOutBox KeepOutFromValue(const Value& value, std::vector<std::string>* warnings) {
  AppendUnknown(value, {"name", "T_b_box", "size_m"}, warnings);
  KeepOutBox box;
  box.name = value.At("name").AsString();
  box.T_b_box = Rigid3FromValue(value.At("T_b_box"));
  box.size_m = Eigen::Vector3d(value.At("size_m").AsDoubles(3).data());
  if (!(box.size_m.minCoeff() > 0.0)) {
    value.At("size_m").Fail("bad size of a box", "lengths must be positive",
                            "write three lengths in metres");
  }
  return box;
}

}  // namespace

ArmLimits ArmLimitsFromValue(const Value& value, std::vector<std::string>* warnings) {
  AppendUnknown(
      value,
      {"joint_lower_rad", "joint_upper_rad", "max_wrist_turn_rad", "clearance_m", "keep_out"},
      warnings);
  ArmLimits limits;
  if (const Value* x = value.Find("joint_lower_rad")) {
    limits.joint_lower = LimitsFromValue(*x, -std::numeric_limits<double>::infinity());
  }
  if (const Value* x = value.Find("joint_upper_rad")) {
    limits.joint_upper = LimitsFromValue(*x, std::numeric_limits<double>::infinity());
  }
  if (!((limits.joint_upper - limits.joint_lower).minCoeff() > 0.0)) {
    value.Fail("bad joint limits", "each lower limit must be below the upper one",
               "check joint_lower_rad and joint_upper_rad, seven numbers each");
  }
  if (const Value* x = value.Find("max_wrist_turn_rad")) limits.max_wrist_turn = x->AsPositive();
  if (const Value* x = value.Find("clearance_m")) limits.clearance_m = x->AsNonNegative();
  if (const Value* x = value.Find("keep_out")) {
    for (const Value& box : x->elements()) {
      limits.keep_out.push_back(KeepOutFromValue(box, warnings));
    }
  }
  return limits;
}

Value ToValue(const ArmLimits& limits) {
  Value value = Value::Object();
  // Infinities are written as null.
  if (limits.joint_lower.array().isFinite().any()) {
    value.Set("joint_lower_rad", Value::Numbers(limits.joint_lower));
  }
  if (limits.joint_upper.array().isFinite().any()) {
    value.Set("joint_upper_rad", Value::Numbers(limits.joint_upper));
  }
  value.Set("max_wrist_turn_rad", limits.max_wrist_turn).Set("clearance_m", limits.clearance_m);
  if (!limits.keep_out.empty()) {
    Value boxes = Value::Array();
    for (const KeepOutBox& box : limits.keep_out) {
      Value entry = Value::Object();
      entry.Set("name", box.name)
          .Set("T_b_box", ToValue(box.T_b_box))
          .Set("size_m", Value::Numbers(box.size_m));
      boxes.Append(std::move(entry));
    }
    value.Set("keep_out", std::move(boxes));
  }
  return value;
}

}  // namespace calibrato
