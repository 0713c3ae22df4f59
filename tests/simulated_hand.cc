#include "simulated_hand.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "calibrato/calibration/planned_frame.h"
#include "calibrato/geometry/so3.h"
#include "calibrato/simulation/fast_simulation.h"
#include "calibrato/simulation/imu_simulation.h"

namespace calibrato {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;
constexpr double kStep = 1e-4;  // Of differences in time [s].

double Quintic(double s) {
  const double x = std::clamp(s, 0.0, 1.0);
  return x * x * x * (10.0 - 15.0 * x + 6.0 * x * x);
}

}  // namespace

SimulatedHand::SimulatedHand(const Rig& rig, const Clumsiness& clumsiness, const Rng& rng)
    : rig_(rig), clumsiness_(clumsiness), rng_(rng), errors_(rng.Stream("errors")) {
  const BasePose base;
  const Rigid3 T_b_e = LoopPoseAt(base, LoopCoefficients::Zero(), 0.0);
  T_g_start_ = FacingBoard(PlannedView(rig.board), BoardInCamera(rig, T_b_e).Inverse());
  Rng draw = rng.Stream("waves");
  const auto add = [&](double low_hz, double high_hz, double turn, double shift) {
    Wave wave;
    wave.frequency_hz = draw.Uniform(low_hz, high_hz);
    for (int k = 0; k < 6; ++k) {
      wave.amplitude(k) = std::numbers::sqrt2 * (k < 3 ? turn : shift) * draw.Uniform(0.5, 1.5);
      wave.phase(k) = draw.Uniform(0.0, kTwoPi);
    }
    waves_.push_back(wave);
  };
  add(0.05, 0.2, clumsiness.drift_rad, clumsiness.drift_m);
  add(8.0, 11.0, clumsiness.tremor_rad, clumsiness.tremor_m);
}

void SimulatedHand::Make(const Gesture& gesture) {
  const Rigid3 T_start_there = T_g_start_.Inverse() * gesture.T_g_c;
  Piece piece;
  piece.begin_s = now_s_;
  if (!pieces_.empty()) piece.from = pieces_.back().place;
  piece.place << LogSo3(T_start_there.R), T_start_there.t;
  for (int k = 0; k < 6; ++k) {
    piece.place(k) += errors_.Normal(0.0, k < 3 ? clumsiness_.angle_rad : clumsiness_.place_m);
  }
  const auto scaled = [&] {
    return std::clamp(errors_.Normal(1.0, clumsiness_.amplitude_share), 0.6, 1.4);
  };
  const double size = scaled();
  const auto clumsy = [&](const Offset& meant) {
    Offset done = size * meant;
    const double angle = meant.head<3>().norm();
    const double way = meant.tail<3>().norm();
    for (int k = 0; k < 6; ++k) {
      done(k) += errors_.Normal(0.0, clumsiness_.crosstalk * (k < 3 ? angle : way) / 1.7);
    }
    return done;
  };
  Offset to_and_fro;
  to_and_fro << gesture.turn, gesture.shift;
  Offset aside;
  aside << gesture.turn_aside, Eigen::Vector3d::Zero();
  piece.to_and_fro = clumsy(to_and_fro);
  piece.aside = clumsy(aside);
  // A sine that lags is a sine and a cosine.
  for (const int part : {0, 3}) {
    const double lag = errors_.Normal(0.0, clumsiness_.out_of_step_rad);
    const Eigen::Vector3d sine = piece.to_and_fro.segment<3>(part);
    const Eigen::Vector3d cosine = piece.aside.segment<3>(part);
    piece.to_and_fro.segment<3>(part) = std::cos(lag) * sine + std::sin(lag) * cosine;
    piece.aside.segment<3>(part) = std::cos(lag) * cosine - std::sin(lag) * sine;
  }
  piece.period_s = gesture.period_s * std::max(1.0, scaled());
  piece.duration_s = gesture.duration_s * piece.period_s / gesture.period_s;
  // A quintic's peak velocity is 15/8 of its mean.
  const Offset way = piece.place - piece.from;
  const double travel =
      std::max({0.6, 1.875 * way.head<3>().norm() / 1.6, 1.875 * way.tail<3>().norm() / 0.8});
  piece.there_s = piece.begin_s + travel;
  now_s_ = piece.there_s + piece.duration_s;
  pieces_.push_back(piece);
}

SimulatedHand::Offset SimulatedHand::OffsetAt(double t_s) const {
  Offset offset = Offset::Zero();
  const auto next = std::upper_bound(pieces_.begin(), pieces_.end(), t_s,
                                     [](double t, const Piece& p) { return t < p.begin_s; });
  if (next != pieces_.begin()) {
    const Piece& piece = *(next - 1);
    const double travel = (t_s - piece.begin_s) / (piece.there_s - piece.begin_s);
    offset = piece.from + Quintic(travel) * (piece.place - piece.from);
    const double t = t_s - piece.there_s;
    const double ramp = 0.5 * std::min(piece.period_s, piece.duration_s);
    const double window = Quintic(t / ramp) * Quintic((piece.duration_s - t) / ramp);
    offset += window * (std::sin(kTwoPi * t / piece.period_s) * piece.to_and_fro +
                        std::cos(kTwoPi * t / piece.period_s) * piece.aside);
  }
  for (const Wave& wave : waves_) {
    for (int k = 0; k < 6; ++k) {
      offset(k) += wave.amplitude(k) * std::sin(kTwoPi * wave.frequency_hz * t_s + wave.phase(k));
    }
  }
  return offset;
}

CarrierState SimulatedHand::StateAt(double t_s) const {
  const Rigid3 T_b_g = ArmBaseInWorld().Inverse() * rig_.T_w_g;
  const auto pose = [&](double t) {
    const Offset offset = OffsetAt(t);
    return T_b_g * T_g_start_ * Rigid3{ExpSo3(offset.head<3>()), offset.tail<3>()} *
           rig_.T_e_c0.Inverse();
  };
  const Rigid3 before = pose(t_s - kStep);
  const Rigid3 now = pose(t_s);
  const Rigid3 after = pose(t_s + kStep);
  const Eigen::Vector3d first = LogSo3(now.R * before.R.transpose()) / kStep;
  const Eigen::Vector3d second = LogSo3(after.R * now.R.transpose()) / kStep;
  return {now, (after.t - before.t) / (2.0 * kStep),
          (after.t - 2.0 * now.t + before.t) / (kStep * kStep), 0.5 * (first + second),
          (second - first) / kStep};
}

GuideData SimulatedHand::RecordedUntil(double t_s) const {
  const CarrierPath path{t_s, [this](double t) { return StateAt(t); }, {}};
  const Time start = Time::FromNanoseconds(1'700'000'000'000'000'000);
  GuideData data;
  Rng camera = rng_.Stream("camera");
  data.views = SimulateFrames(rig_, path, start, camera).views;
  Rng imu = rng_.Stream("imu");
  data.imu = SimulateImu(rig_, path, start, imu).stream;
  return data;
}

}  // namespace calibrato
