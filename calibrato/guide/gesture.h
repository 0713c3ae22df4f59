#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "calibrato/geometry/rigid3.h"
#include "calibrato/guide/camera_loop.h"
#include "calibrato/sensors/camera_model.h"
#include "calibrato/sensors/measurements.h"

namespace calibrato {

/// A simple motion that a person is asked to make with a rig in hand, before a board at rest: to a
/// place, and there to and fro. Camera 0 is at
///
///     T_g_c(t) = T_g_c * (Exp(turn o(t) + turn_aside q(t)), shift o(t))
///
/// with o = w sin(2 pi t / period), q = w cos(2 pi t / period) and w a window that rises and falls
/// within half a period, so that it begins and ends at rest in its middle. Or, where it has a loop,
/// once around that, T_g_c * PoseAt(loop, theta), with the phase of a quintic (time_law.h).
struct Gesture {
  std::string name;   ///< "turn about y", short, for lists.
  std::string words;  ///< "Turn the camera left and right", for whoever holds it.
  Rigid3 T_g_c;       ///< Its middle.
  Eigen::Vector3d turn =
      Eigen::Vector3d::Zero();  ///< To either side, about the camera's axes [rad].
  Eigen::Vector3d turn_aside = Eigen::Vector3d::Zero();  ///< A quarter of a period later [rad].
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();       ///< To either side, along these axes [m].
  double period_s = 1.0;                                 ///< Of one to and fro, > 0 [s].
  double duration_s = 2.0;                               ///< > 0
  std::optional<CameraLoop> loop{};                      ///< Made instead of turns and shifts.
  int loop_number = 0;                                   ///< In its motion, from 1.
};

/// @param t_s  In [0, duration_s]; clamped outside [s].
[[nodiscard]] Rigid3 PoseAt(const Gesture& gesture, double t_s);

/// How far "about y, 12 degrees to either side, 1 s to and fro, for 4 s" goes, for people.
[[nodiscard]] std::string Describe(const Gesture& gesture);

/// What a hand does without effort.
struct HandLimits {
  double speed = 0.8;                 ///< [m/s]
  double acceleration = 2.4;          ///< [m/s^2]
  double angular_speed = 1.6;         ///< [rad/s]
  double angular_acceleration = 8.0;  ///< [rad/s^2]
  double reach_m = 0.25;              ///< Of the camera from where it stood first [m] > 0.
};

/// Where gestures are made, and of what.
struct GestureSetting {
  CameraModel camera;
  Resolution resolution;
  BoardView points;  ///< Of the whole board, as from PlannedView.
  Rigid3 T_g_c;      ///< Where the camera stands, with the board in its middle (FacingBoard).
  HandLimits hand;
};

/// The pose at the same place and upright as this one, turned so that the board's middle is in the
/// middle of the image.
[[nodiscard]] Rigid3 FacingBoard(const BoardView& points, const Rigid3& T_g_c);

/// True where the whole board stays in view all along, with a little margin.
[[nodiscard]] bool KeepsBoardInView(const GestureSetting& setting, const Gesture& gesture);

/// What can be asked for in a setting: turns about and shifts along each axis, a tip in a circle,
/// pushes to the board and back that turn about two axes on their way, as fast as the hand is and
/// as wide as the board stays in view; and places to hold the camera at, with the board near a
/// corner of the image, from nearby, and from aside. What does not keep the board in view, or
/// hardly moves, is left out. The order is fixed.
[[nodiscard]] std::vector<Gesture> GesturesFor(const GestureSetting& setting);

}  // namespace calibrato
