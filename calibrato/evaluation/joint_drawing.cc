#include "calibrato/evaluation/joint_drawing.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <utility>

#include "calibrato/motion/panda_dynamics.h"
#include "calibrato/motion/robot_formats.h"

namespace calibrato {
namespace {

double Rounded(double x) {
  constexpr double kDigits = 1e5;
  return std::round(kDigits * x) / kDigits;
}

struct Quantity {
  const char* name;
  const char* unit;
  std::function<double(size_t sample, Eigen::Index joint)> value;
  std::function<double(double value, Eigen::Index joint)> share;
};

Value Drawn(const Quantity& quantity, const JointsAgainstLimits& joints) {
  constexpr size_t kMostSpans = 600;
  const size_t num_samples = joints.samples.size();
  const size_t span = (num_samples + kMostSpans - 1) / kMostSpans;
  Value times = Value::Array();
  for (size_t k = 0; k < num_samples; k += span) {
    times.Append(Rounded(joints.step_s * static_cast<double>(k)));
  }
  double largest = 0.0;
  int worst_joint = 1;
  Value all_values = Value::Array();
  Value all_shares = Value::Array();
  for (Eigen::Index joint = 0; joint < static_cast<Eigen::Index>(joints.names.size()); ++joint) {
    Value values = Value::Array();
    Value shares = Value::Array();
    for (size_t begin = 0; begin < num_samples; begin += span) {
      double value = 0.0;
      double share = 0.0;
      for (size_t k = begin; k < std::min(begin + span, num_samples); ++k) {
        const double v = quantity.value(k, joint);
        const double s = quantity.share(v, joint);
        if (k > begin && std::abs(s) <= std::abs(share)) continue;
        value = v;
        share = s;
      }
      values.Append(Rounded(value));
      shares.Append(Rounded(share));
      if (!(std::abs(share) <= largest)) {  // NaN is the largest of all.
        largest = std::abs(share);
        worst_joint = static_cast<int>(joint) + 1;
      }
    }
    all_values.Append(std::move(values));
    all_shares.Append(std::move(shares));
  }
  return Value::Object()
      .Set("name", quantity.name)
      .Set("unit", quantity.unit)
      .Set("largest_share", largest)
      .Set("joint", worst_joint)
      .Set("t_s", std::move(times))
      .Set("values", std::move(all_values))
      .Set("shares", std::move(all_shares));
}

}  // namespace

JointsAgainstLimits PandaJointsOf(const TimedMotion& timed) {
  constexpr int kControlRate = 1000;  // [Hz]
  JointsAgainstLimits joints;
  for (int i = 1; i <= 7; ++i) joints.names.push_back("joint " + std::to_string(i));
  joints.step_s = 1.0 / kControlRate;
  joints.samples = JointSamples(timed, kControlRate);
  for (const JointMotion& sample : joints.samples) {
    joints.torque.push_back(PandaTorque(sample.position, sample.velocity, sample.acceleration));
  }
  joints.limits = Limits();
  return joints;
}

Value JointDrawing(const JointsAgainstLimits& joints) {
  assert(joints.samples.size() > 1);
  assert(joints.torque.empty() || joints.torque.size() == joints.samples.size());
  const PandaLimits& limits = joints.limits;
  const auto share_of = [](const JointVector& bound) {
    return [&bound](double value, Eigen::Index joint) { return value / bound[joint]; };
  };
  const auto part = [&](JointVector JointMotion::*member) {
    return [&joints, member](size_t k, Eigen::Index i) { return (joints.samples[k].*member)[i]; };
  };
  std::vector<Quantity> quantities = {
      {"position", "rad", part(&JointMotion::position),
       [&](double value, Eigen::Index i) {
         return (2.0 * value - limits.lower[i] - limits.upper[i]) /
                (limits.upper[i] - limits.lower[i]);
       }},
      {"velocity", "rad/s", part(&JointMotion::velocity), share_of(limits.velocity)},
      {"acceleration", "rad/s²", part(&JointMotion::acceleration), share_of(limits.acceleration)},
      {"jerk", "rad/s³", part(&JointMotion::jerk), share_of(limits.jerk)}};
  if (!joints.torque.empty()) {
    quantities.push_back({"torque", "N m",
                          [&](size_t k, Eigen::Index i) { return joints.torque[k][i]; },
                          share_of(limits.torque)});
  }
  Value names = Value::Array();
  for (const std::string& name : joints.names) names.Append(name);
  Value drawn = Value::Array();
  for (const Quantity& quantity : quantities) drawn.Append(Drawn(quantity, joints));
  return Value::Object().Set("names", std::move(names)).Set("quantities", std::move(drawn));
}

}  // namespace calibrato
