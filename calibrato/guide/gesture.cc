#include "calibrato/guide/gesture.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <optional>
#include <utility>

#include "calibrato/calibration/planned_frame.h"
#include "calibrato/geometry/so3.h"
#include "calibrato/motion/time_law.h"

namespace calibrato {
namespace {

using Eigen::Vector3d;

constexpr double kTwoPi = 2.0 * std::numbers::pi;
constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr double kMargin = 12.0;           // Of the board inside the image [px].
constexpr double kSmallestShare = 0.2;     // Of a gesture's full width; below it is left out.
constexpr double kShortestPeriod = 0.8;    // What a person can follow [s].
constexpr double kShortestDuration = 3.0;  // Of what goes to and fro [s].
constexpr double kHoldDuration = 1.5;      // [s]

// Rises from 0 to 1 with velocity and acceleration zero at both ends.
double Quintic(double s) {
  const double x = std::clamp(s, 0.0, 1.0);
  return x * x * x * (10.0 - 15.0 * x + 6.0 * x * x);
}

bool IsHeld(const Gesture& gesture) {
  return !gesture.loop && gesture.turn.isZero() && gesture.turn_aside.isZero() &&
         gesture.shift.isZero();
}

// As fast as the hand is.
void SetPace(const HandLimits& hand, Gesture* gesture) {
  const double angle = std::max(gesture->turn.norm(), gesture->turn_aside.norm());
  const double way = gesture->shift.norm();
  gesture->period_s =
      std::max({kShortestPeriod, kTwoPi * angle / hand.angular_speed,
                kTwoPi * std::sqrt(angle / hand.angular_acceleration), kTwoPi * way / hand.speed,
                kTwoPi * std::sqrt(way / hand.acceleration)});
  gesture->duration_s = gesture->period_s * std::ceil(kShortestDuration / gesture->period_s);
}

// As wide as the board stays in view: nothing where that is hardly a motion.
std::optional<Gesture> Fitted(const GestureSetting& setting, const Gesture& full) {
  const auto scaled = [&](double share) {
    Gesture gesture = full;
    gesture.turn *= share;
    gesture.turn_aside *= share;
    gesture.shift *= share;
    if (!IsHeld(gesture)) SetPace(setting.hand, &gesture);
    return gesture;
  };
  if (KeepsBoardInView(setting, scaled(1.0))) return scaled(1.0);
  if (IsHeld(full) || !KeepsBoardInView(setting, scaled(kSmallestShare))) return std::nullopt;
  double low = kSmallestShare;
  double high = 1.0;
  while (high - low > 0.02) {
    const double middle = 0.5 * (low + high);
    (KeepsBoardInView(setting, scaled(middle)) ? low : high) = middle;
  }
  return scaled(low);
}

// The camera turned on its place until the board's middle is seen along this direction, as far as
// the whole board stays in view.
std::optional<Gesture> HeldTowards(const GestureSetting& setting, std::string name,
                                   std::string words, const Vector3d& turn) {
  for (double share = 1.0; share >= 0.4; share -= 0.1) {
    Gesture gesture;
    gesture.name = name;
    gesture.words = words;
    gesture.duration_s = kHoldDuration;
    gesture.T_g_c = setting.T_g_c * Rigid3{ExpSo3(share * turn), Vector3d::Zero()};
    if (KeepsBoardInView(setting, gesture)) return gesture;
  }
  return std::nullopt;
}

}  // namespace

bool KeepsBoardInView(const GestureSetting& setting, const Gesture& gesture) {
  constexpr double kInstantsPerPeriod = 16.0;
  const int num_instants =
      IsHeld(gesture)
          ? 1
          : static_cast<int>(std::ceil(kInstantsPerPeriod * gesture.duration_s / gesture.period_s));
  for (int k = 0; k <= num_instants; ++k) {
    const Rigid3 T_c_g = PoseAt(gesture, gesture.duration_s * k / num_instants).Inverse();
    if (!(MarginInImage(setting.camera, setting.resolution, setting.points, T_c_g) >= kMargin)) {
      return false;
    }
  }
  return true;
}

Rigid3 PoseAt(const Gesture& gesture, double t_s) {
  const double t = std::clamp(t_s, 0.0, gesture.duration_s);
  if (gesture.loop) {
    return gesture.T_g_c * PoseAt(*gesture.loop, QuinticPhaseAt(t, gesture.duration_s).theta);
  }
  const double ramp = 0.5 * std::min(gesture.period_s, gesture.duration_s);
  const double window = Quintic(t / ramp) * Quintic((gesture.duration_s - t) / ramp);
  const double phase = kTwoPi * t / gesture.period_s;
  const double to_and_fro = window * std::sin(phase);
  const double aside = window * std::cos(phase);
  return gesture.T_g_c * Rigid3{ExpSo3(to_and_fro * gesture.turn + aside * gesture.turn_aside),
                                to_and_fro * gesture.shift};
}

std::string Describe(const Gesture& gesture) {
  char text[160];
  if (IsHeld(gesture)) {
    std::snprintf(text, sizeof text, "hold still for %.1f s", gesture.duration_s);
    return text;
  }
  if (gesture.loop) {
    std::snprintf(text, sizeof text, "once around, in %.0f s", gesture.duration_s);
    return text;
  }
  char width[80];
  const double way_cm = 100.0 * gesture.shift.norm();
  const double angle = kDegrees * std::max(gesture.turn.norm(), gesture.turn_aside.norm());
  if (angle == 0.0) {
    std::snprintf(width, sizeof width, "%.0f cm", way_cm);
  } else if (way_cm == 0.0) {
    std::snprintf(width, sizeof width, "%.0f degrees", angle);
  } else {
    std::snprintf(width, sizeof width, "%.0f cm and %.0f degrees", way_cm, angle);
  }
  std::snprintf(text, sizeof text, "%s to either side, %.1f s to and fro, for %.0f s", width,
                gesture.period_s, gesture.duration_s);
  return text;
}

Rigid3 FacingBoard(const BoardView& points, const Rigid3& T_g_c) {
  const Vector3d middle =
      0.5 * (points.points_g.rowwise().minCoeff() + points.points_g.rowwise().maxCoeff());
  const Vector3d seen = T_g_c.Inverse() * middle;
  const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), seen);
  return T_g_c * Rigid3{turn.toRotationMatrix(), Vector3d::Zero()};
}

std::vector<Gesture> GesturesFor(const GestureSetting& setting) {
  constexpr double kWidestTurn = 0.45;  // [rad]
  constexpr double kWidestRoll = 0.7;
  constexpr double kCorner = 0.4;
  std::vector<Gesture> gestures;
  const auto add = [&](const std::optional<Gesture>& gesture) {
    if (gesture) gestures.push_back(*gesture);
  };
  struct Axis {
    const char* name;
    const char* turn_words;
    double turn;
    const char* shift_words;
  };
  const std::array<Axis, 3> axes = {
      Axis{"x", "Nod the camera up and down", kWidestTurn, "Slide it left and right"},
      Axis{"y", "Turn the camera left and right", kWidestTurn, "Slide it up and down"},
      Axis{"z", "Roll the camera like a steering wheel", kWidestRoll,
           "Push it towards the board and back"}};
  for (int k = 0; k < 3; ++k) {
    const Axis& axis = axes[static_cast<size_t>(k)];
    Gesture turn;
    turn.name = std::string("turn about ") + axis.name;
    turn.words = axis.turn_words;
    turn.T_g_c = setting.T_g_c;
    turn.turn = axis.turn * Vector3d::Unit(k);
    add(Fitted(setting, turn));
  }
  for (int k = 0; k < 3; ++k) {
    const Axis& axis = axes[static_cast<size_t>(k)];
    Gesture shift;
    shift.name = std::string("shift along ") + axis.name;
    shift.words = axis.shift_words;
    shift.T_g_c = setting.T_g_c;
    shift.shift = setting.hand.reach_m * Vector3d::Unit(k);
    add(Fitted(setting, shift));
  }
  Gesture circle;
  circle.name = "tip in a circle";
  circle.words = "Tip the camera around in a circle";
  circle.T_g_c = setting.T_g_c;
  circle.turn = kWidestTurn * Vector3d::UnitX();
  circle.turn_aside = kWidestTurn * Vector3d::UnitY();
  add(Fitted(setting, circle));
  Gesture screw;
  screw.name = "turn about the diagonal";
  screw.words = "Turn the camera about the diagonal, up left to down right";
  screw.T_g_c = setting.T_g_c;
  screw.turn = kWidestTurn * Vector3d(1.0, 1.0, 1.0).normalized();
  add(Fitted(setting, screw));

  // All at once: the way to the board tells the focal length from the distance, since the IMU knows
  // its length; turns about two axes tell the rest. In one gesture they cost the time of one.
  struct Push {
    const char* name;
    const char* words;
    Vector3d turn;
    Vector3d turn_aside;
  };
  for (const Push& push :
       {Push{"push and circle",
             "Push it towards the board and back while you tip it around in a circle",
             Vector3d::UnitX(), Vector3d::UnitY()},
        Push{"push, roll and turn",
             "Push it towards the board and back, rolling it on the way; "
             "in passing, turn it left and right",
             Vector3d::UnitZ(), Vector3d::UnitY()},
        Push{"push, roll and nod",
             "Push it towards the board and back, rolling it on the way; "
             "in passing, nod it up and down",
             Vector3d::UnitZ(), Vector3d::UnitX()}}) {
    Gesture gesture;
    gesture.name = push.name;
    gesture.words = push.words;
    gesture.T_g_c = setting.T_g_c;
    gesture.turn = kWidestTurn * push.turn;
    gesture.turn_aside = kWidestTurn * push.turn_aside;
    gesture.shift = setting.hand.reach_m * Vector3d::UnitZ();
    add(Fitted(setting, gesture));
  }

  // A camera that turns right has the board on its left.
  struct Corner {
    const char* name;
    double right;
    double down;
  };
  for (const Corner& corner : {Corner{"top left", 1, 1}, Corner{"top right", -1, 1},
                               Corner{"bottom left", 1, -1}, Corner{"bottom right", -1, -1}}) {
    add(HeldTowards(setting, std::string("board at the ") + corner.name,
                    std::string("Bring the board to the ") + corner.name + " of the image",
                    kCorner * Vector3d(-corner.down, corner.right, 0.0)));
  }
  struct Place {
    const char* name;
    const char* words;
    Vector3d offset;
  };
  for (const Place& place :
       {Place{"from nearby", "Go closer to the board", Vector3d::UnitZ()},
        Place{"from the left", "Look at the board from the left", -Vector3d::UnitX()},
        Place{"from the right", "Look at the board from the right", Vector3d::UnitX()},
        Place{"from above", "Look at the board from above", -Vector3d::UnitY()},
        Place{"from below", "Look at the board from below", Vector3d::UnitY()}}) {
    Gesture gesture;
    gesture.name = place.name;
    gesture.words = place.words;
    gesture.duration_s = kHoldDuration;
    const Rigid3 T_c_there{Eigen::Matrix3d::Identity(), setting.hand.reach_m * place.offset};
    gesture.T_g_c = FacingBoard(setting.points, setting.T_g_c * T_c_there);
    add(Fitted(setting, gesture));
  }
  return gestures;
}

}  // namespace calibrato
