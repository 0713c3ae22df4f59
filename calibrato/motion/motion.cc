#include "calibrato/motion/motion.h"

#include <array>
#include <cmath>
#include <optional>

#include "calibrato/base/input_error.h"
#include "calibrato/base/nearest_name.h"

namespace calibrato {
namespace {

// In the order of the enums.
const std::vector<std::string> kCarrierNames = {"free", "arm"};
const std::vector<std::string> kTaskNames = {"intrinsic", "extrinsic", "joint"};
const std::vector<std::string> kTimingNames = {"quintic", "optimal"};

// An enum's value from its name. @throws InputError that gives all names.
template <typename Enum>
Enum FromName(const std::string& kind, const std::string& name,
              const std::vector<std::string>& names) {
  for (size_t i = 0; i < names.size(); ++i) {
    if (names[i] == name) return static_cast<Enum>(i);
  }
  const std::optional<std::string> nearest = NearestName(name, names);
  std::string list = names.front();
  for (size_t i = 1; i < names.size(); ++i) {
    list += (i + 1 == names.size() ? " and " : ", ") + names[i];
  }
  throw InputError({"unknown " + kind + " '" + name + "'", "", "there are " + list,
                    nearest ? "did you mean " + *nearest + "?" : "choose one of them"});
}

void AppendUnknownKeys(const Value& value, const std::vector<std::string>& known,
                       std::vector<std::string>* warnings) {
  if (warnings == nullptr) return;
  const std::vector<std::string> unknown = value.UnknownKeys(known);
  warnings->insert(warnings->end(), unknown.begin(), unknown.end());
}

Eigen::Vector3d VectorFromValue(const Value& value) {
  return Eigen::Vector3d(value.AsDoubles(3).data());
}

Loop LoopFromValue(const Value& value, std::vector<std::string>* warnings) {
  AppendUnknownKeys(value, {"coefficients", "duration_s"}, warnings);
  constexpr double kMaxCoefficient = 10.0;
  const Value& coefficients = value.At("coefficients");
  Loop loop;
  loop.coefficients = LoopCoefficients(coefficients.AsDoubles(loop.coefficients.size()).data());
  if (!(loop.coefficients.cwiseAbs().maxCoeff() <= kMaxCoefficient)) {
    coefficients.Fail("bad coefficient", "it must lie within +-10 m or rad",
                      "write metres and radians, after scaling");
  }
  loop.duration_s = value.At("duration_s").AsPositive();
  return loop;
}

Value ToValue(const Loop& loop) {
  Value value = Value::Object();
  value.Set("coefficients", Value::Numbers(loop.coefficients)).Set("duration_s", loop.duration_s);
  return value;
}

}  // namespace

std::string CarrierName(Carrier carrier) { return kCarrierNames[static_cast<size_t>(carrier)]; }
Carrier CarrierFromName(const std::string& name) {
  return FromName<Carrier>("carrier", name, kCarrierNames);
}

std::string TimingName(Timing timing) { return kTimingNames[static_cast<size_t>(timing)]; }
Timing TimingFromName(const std::string& name) {
  return FromName<Timing>("timing", name, kTimingNames);
}

std::string TaskName(Task task) { return kTaskNames[static_cast<size_t>(task)]; }
Task TaskFromName(const std::string& name) { return FromName<Task>("task", name, kTaskNames); }

int NumLoops(Task task) { return task == Task::kExtrinsic ? 3 : 4; }

Motion MotionFromValue(const Value& value, std::vector<std::string>* warnings) {
  // How the motion ran is written for its readers; it follows from the rest and is not read.
  AppendUnknownKeys(value,
                    {"carrier", "timing", "base_pose", "loops", "provenance", "scale",
                     "loop_duration_s", "loop_phase_control_points_rad", "joint_path_t_s_q_rad"},
                    warnings);
  Motion motion;
  const Value& carrier = value.At("carrier");
  const std::string carrier_name = carrier.AsString();
  try {
    motion.carrier = CarrierFromName(carrier_name);
  } catch (const InputError&) {
    carrier.Fail("unknown carrier '" + carrier_name + "'", "there are free and arm",
                 "write carrier: free or carrier: arm");
  }
  if (const Value* timing = value.Find("timing")) {
    const std::string timing_name = timing->AsString();
    try {
      motion.timing = TimingFromName(timing_name);
    } catch (const InputError&) {
      timing->Fail("unknown timing '" + timing_name + "'", "there are quintic and optimal",
                   "write timing: quintic or timing: optimal");
    }
  }
  if (const Value* base_pose = value.Find("base_pose")) {
    AppendUnknownKeys(*base_pose, {"xyz_m", "rpy_rad"}, warnings);
    motion.base_pose.xyz_m = VectorFromValue(base_pose->At("xyz_m"));
    motion.base_pose.rpy_rad = VectorFromValue(base_pose->At("rpy_rad"));
  }
  const Value& loops = value.At("loops");
  constexpr size_t kMaxLoops = 1000;
  if (loops.elements().empty() || loops.size() > kMaxLoops) {
    loops.Fail("bad number of loops",
               "there must be 1 to 1000, found " + std::to_string(loops.size()),
               "give each loop as {coefficients: [36 numbers], duration_s: 5.0}");
  }
  for (const Value& loop : loops.elements()) motion.loops.push_back(LoopFromValue(loop, warnings));
  if (const Value* provenance = value.Find("provenance")) motion.provenance = *provenance;
  return motion;
}

Value ToValue(const Motion& motion) {
  Value base_pose = Value::Object();
  base_pose.Set("xyz_m", Value::Numbers(motion.base_pose.xyz_m))
      .Set("rpy_rad", Value::Numbers(motion.base_pose.rpy_rad));
  Value loops = Value::Array();
  for (const Loop& loop : motion.loops) loops.Append(ToValue(loop));
  Value value = Value::Object();
  value.Set("carrier", CarrierName(motion.carrier));
  if (motion.timing != Timing::kQuintic) value.Set("timing", TimingName(motion.timing));
  value.Set("base_pose", std::move(base_pose))
      .Set("loops", std::move(loops))
      .Set("provenance", motion.provenance);
  return value;
}

}  // namespace calibrato
