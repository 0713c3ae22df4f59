#pragma once

#include <Eigen/Core>
#include <vector>

#include "calibrato/base/rng.h"
#include "calibrato/guide/gesture.h"
#include "calibrato/guide/live_estimate.h"
#include "calibrato/motion/carrier.h"
#include "calibrato/sensors/rig.h"

namespace calibrato {

/// How clumsily a hand does what it is asked for.
struct Clumsiness {
  double amplitude_share = 0.15;  ///< Of amplitudes and periods, standard deviation [-].
  double crosstalk = 0.15;        ///< Into the other axes, of the amplitude [-].
  double out_of_step_rad = 0.3;   ///< Of turns, and of shifts, against what was meant: a lag.
  double place_m = 0.015;         ///< Of where the gesture is made [m], each axis ...
  double angle_rad = 0.03;        ///< ... and of its orientation.
  double drift_m = 0.01;          ///< Slow wandering, below 0.2 Hz.
  double drift_rad = 0.02;
  double tremor_m = 2e-4;  ///< At 8 to 11 Hz.
  double tremor_rad = 5e-4;
};

/// A rig in a person's hand, who makes one gesture after the other. Its way is smooth to the second
/// derivative and in closed form: the estimators' splines are not in it.
class SimulatedHand {
 public:
  /// @param rng  Of errors, drift and tremor; of camera and IMU.
  SimulatedHand(const Rig& rig, const Clumsiness& clumsiness, const Rng& rng);

  /// Where the camera stands first, the board in the middle of its image.
  const Rigid3& start() const { return T_g_start_; }
  /// Until now [s]: so long the hand has moved.
  double now_s() const { return now_s_; }

  /// Does nothing for so long: waits for a hint, and reads it.
  void Wait(double duration_s) { now_s_ += duration_s; }
  /// Goes to the gesture's place and makes it.
  void Make(const Gesture& gesture);

  /// What camera and IMU saw until then; that of a shorter time is its beginning.
  [[nodiscard]] GuideData RecordedUntil(double t_s) const;

 private:
  using Offset = Eigen::Matrix<double, 6, 1>;  // [turn, shift] from the start's pose.
  struct Piece {
    double begin_s = 0.0;  // Of the way to its place ...
    double there_s = 0.0;  // ... and of the gesture.
    Offset from = Offset::Zero();
    Offset place = Offset::Zero();
    Offset to_and_fro = Offset::Zero();
    Offset aside = Offset::Zero();
    double period_s = 1.0;
    double duration_s = 0.0;
  };
  struct Wave {
    double frequency_hz = 0.0;
    Offset amplitude = Offset::Zero();
    Offset phase = Offset::Zero();
  };
  [[nodiscard]] Offset OffsetAt(double t_s) const;
  [[nodiscard]] CarrierState StateAt(double t_s) const;

  Rig rig_;
  Clumsiness clumsiness_;
  Rng rng_;
  Rng errors_;
  Rigid3 T_g_start_;
  std::vector<Piece> pieces_;
  std::vector<Wave> waves_;
  double now_s_ = 0.0;
};

}  // namespace calibrato
