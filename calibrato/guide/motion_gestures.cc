#include "calibrato/guide/motion_gestures.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "calibrato/geometry/so3.h"
#include "calibrato/motion/paper_scene.h"

namespace calibrato {
namespace {

using Eigen::Vector3d;

constexpr double kSmallestShare = 0.2;
constexpr double kHardlyAMotion = 1e-3;  // Of the root sum of squares of the coefficients.
constexpr int kNumInstants = 128;        // Of a loop whose harmonics go up to the fourth.
constexpr double kFastest = 4.0;         // Of the harmonics.

// The time that the hand takes at least, for a loop that begins and ends at rest.
double ShortestDuration(const HandLimits& hand, const Gesture& gesture) {
  Gesture of_one_second = gesture;
  of_one_second.duration_s = 1.0;
  constexpr double kStep = 1.0 / kNumInstants;
  double shortest = 0.0;
  for (int k = 1; k < kNumInstants; ++k) {
    const Rigid3 before = PoseAt(of_one_second, (k - 1) * kStep);
    const Rigid3 now = PoseAt(of_one_second, k * kStep);
    const Rigid3 after = PoseAt(of_one_second, (k + 1) * kStep);
    const Vector3d to = LogSo3(before.R.transpose() * now.R) / kStep;
    const Vector3d from = LogSo3(now.R.transpose() * after.R) / kStep;
    const double speed = (after.t - before.t).norm() / (2.0 * kStep);
    const double acceleration = (after.t - 2.0 * now.t + before.t).norm() / (kStep * kStep);
    shortest = std::max({shortest, speed / hand.speed, std::sqrt(acceleration / hand.acceleration),
                         0.5 * (to + from).norm() / hand.angular_speed,
                         std::sqrt((from - to).norm() / kStep / hand.angular_acceleration)});
  }
  return shortest;
}

bool IsWithinReach(const GestureSetting& setting, const Gesture& gesture) {
  for (int k = 0; k <= kNumInstants; ++k) {
    const Rigid3 T_g_c = PoseAt(gesture, gesture.duration_s * k / kNumInstants);
    if ((T_g_c.t - setting.T_g_c.t).norm() > setting.hand.reach_m) return false;
  }
  return true;
}

}  // namespace

std::vector<Gesture> GesturesOfMotion(const GestureSetting& setting, const Motion& motion) {
  std::vector<Gesture> gestures;
  const Rigid3 T_e_c = PaperRig().T_e_c0;
  for (size_t k = 0; k < motion.loops.size(); ++k) {
    const Loop& loop = motion.loops[k];
    if (!(loop.coefficients.norm() > kHardlyAMotion)) continue;
    const auto scaled = [&](double share) {
      Gesture gesture;
      gesture.name = "loop " + std::to_string(k + 1);
      gesture.words = "Follow the yellow board with yours: loop " + std::to_string(k + 1) + " of " +
                      std::to_string(motion.loops.size());
      gesture.T_g_c = setting.T_g_c;
      gesture.loop = CameraLoop{motion.base_pose, share * loop.coefficients, T_e_c};
      gesture.loop_number = static_cast<int>(k) + 1;
      gesture.duration_s = std::max(loop.duration_s, ShortestDuration(setting.hand, gesture));
      gesture.period_s = gesture.duration_s / kFastest;
      return gesture;
    };
    const auto fits = [&](const Gesture& gesture) {
      return IsWithinReach(setting, gesture) && KeepsBoardInView(setting, gesture);
    };
    double low = kSmallestShare;
    double high = 1.0;
    if (!fits(scaled(low))) continue;
    if (fits(scaled(high))) low = high;
    while (high - low > 0.02) {
      const double middle = 0.5 * (low + high);
      (fits(scaled(middle)) ? low : high) = middle;
    }
    gestures.push_back(scaled(low));
  }
  return gestures;
}

}  // namespace calibrato
