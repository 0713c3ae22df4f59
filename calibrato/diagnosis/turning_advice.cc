#include "calibrato/diagnosis/turning_advice.h"

#include <array>

#include "calibrato/diagnosis/finding.h"

namespace calibrato {
namespace {

constexpr double kHardlyTurned = 0.05;  // [rad/s]

constexpr std::array<const char*, 3> kAxes = {"x", "y", "z"};
// What a hand does to turn the camera about its axes.
constexpr std::array<const char*, 3> kTurns = {"x (look up and down)", "y (look left and right)",
                                               "z (roll)"};

int SlowerOfTheOthers(int axis, const Eigen::Vector3d& turning) {
  const int one = (axis + 1) % 3;
  const int other = (axis + 2) % 3;
  return turning(one) < turning(other) ? one : other;
}

}  // namespace

std::string AdviceOnTurning(int axis, const Eigen::Vector3d& turning) {
  const int slower = SlowerOfTheOthers(axis, turning);
  const char* turn = kTurns[size_t(slower)];
  if (turning(slower) < kHardlyTurned) {
    return Format("turn the camera to and fro about its %s, which it hardly did", turn);
  }
  return Format("turn the camera to and fro about its %s faster; so far %.2f rad/s on average",
                turn, turning(slower));
}

std::string AxisToTurnAbout(int axis, const Eigen::Vector3d& turning) {
  return kAxes[size_t(SlowerOfTheOthers(axis, turning))];
}

}  // namespace calibrato
