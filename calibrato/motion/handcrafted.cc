#include <utility>
#include <vector>

#include "calibrato/motion/motion.h"

namespace calibrato {
namespace {

// Degree of freedom and harmonic make the index of a coefficient: 6 * dof + k.
enum DegreeOfFreedom { kX, kY, kZ, kRoll, kPitch, kYaw };
enum Harmonic { kCos1, kSin1, kCos2, kSin2, kCos4, kSin4 };

struct Entry {
  DegreeOfFreedom degree_of_freedom;
  Harmonic harmonic;
  double coefficient;
};

LoopCoefficients Action(const std::vector<Entry>& entries, double multiplier) {
  LoopCoefficients action = LoopCoefficients::Zero();
  for (const Entry& entry : entries) {
    action[6 * entry.degree_of_freedom + entry.harmonic] = multiplier * entry.coefficient;
  }
  return action;
}

// Roll of the image; a bow in depth and height; one in depth and to the side; a figure eight.
const std::vector<std::vector<Entry>> kIntrinsicLoops = {
    {{kPitch, kSin2, 0.02}},
    {{kX, kCos2, 0.02}, {kZ, kSin1, 0.02}, {kRoll, kSin1, -0.02}},
    {{kX, kCos2, -0.02}, {kY, kSin1, 0.02}, {kYaw, kSin1, 0.02}},
    {{kY, kSin1, 0.02}, {kZ, kSin2, 0.02}, {kRoll, kSin2, 0.02}, {kYaw, kSin1, -0.02}}};
constexpr double kIntrinsicMultiplier = 5.1;

const std::vector<std::vector<Entry>> kExtrinsicLoops = {
    {{kPitch, kSin2, 0.025},
     {kY, kSin1, 0.02},
     {kZ, kSin2, 0.02},
     {kRoll, kSin2, 0.02},
     {kYaw, kSin1, -0.02},
     {kX, kSin1, 0.02}},
    {{kX, kCos2, 0.02}, {kZ, kSin1, 0.02}, {kRoll, kSin1, -0.02}, {kPitch, kSin2, 0.02}},
    {{kX, kCos2, -0.02}, {kY, kSin1, 0.02}, {kYaw, kSin1, 0.02}, {kPitch, kSin2, 0.02}}};
constexpr double kExtrinsicMultiplier = 1.0;

}  // namespace

Motion HandcraftedMotion(Task task) {
  const bool intrinsic = task != Task::kExtrinsic;
  Motion motion;
  for (const std::vector<Entry>& entries : intrinsic ? kIntrinsicLoops : kExtrinsicLoops) {
    const LoopCoefficients action =
        Action(entries, intrinsic ? kIntrinsicMultiplier : kExtrinsicMultiplier);
    motion.loops.push_back({.coefficients = ScaledAction(action)});
  }
  motion.provenance.Set("method", "handcrafted").Set("task", TaskName(task));
  return motion;
}

}  // namespace calibrato
