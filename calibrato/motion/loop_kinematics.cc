#include "calibrato/motion/loop_kinematics.h"

#include <cmath>

#include "calibrato/geometry/rpy.h"
#include "calibrato/motion/time_law.h"

namespace calibrato {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// omega_e = B d(rpy)/dt for R = Rz(yaw) Ry(pitch) Rx(roll), and how B changes with roll and pitch
// (yaw turns the frame that e is seen from: it changes nothing in e's own axes).
struct BodyRates {
  Matrix3d B;
  Matrix3d by_roll;
  Matrix3d by_pitch;
  Matrix3d by_roll_twice;
  Matrix3d by_roll_and_pitch;
  Matrix3d by_pitch_twice;
};

BodyRates BodyRatesAt(double roll, double pitch) {
  const double sr = std::sin(roll);
  const double cr = std::cos(roll);
  const double sp = std::sin(pitch);
  const double cp = std::cos(pitch);
  BodyRates rates;
  rates.B << 1.0, 0.0, -sp, 0.0, cr, sr * cp, 0.0, -sr, cr * cp;
  rates.by_roll << 0.0, 0.0, 0.0, 0.0, -sr, cr * cp, 0.0, -cr, -sr * cp;
  rates.by_pitch << 0.0, 0.0, -cp, 0.0, 0.0, -sr * sp, 0.0, 0.0, -cr * sp;
  rates.by_roll_twice << 0.0, 0.0, 0.0, 0.0, -cr, -sr * cp, 0.0, sr, -cr * cp;
  rates.by_roll_and_pitch << 0.0, 0.0, 0.0, 0.0, 0.0, -cr * sp, 0.0, 0.0, sr * sp;
  rates.by_pitch_twice << 0.0, 0.0, sp, 0.0, 0.0, -sr * cp, 0.0, 0.0, -cr * cp;
  return rates;
}

// How an offset depends on the coefficients of its degree of freedom, and so do its derivatives by
// the phase.
struct Harmonics {
  Eigen::Vector<double, 6> value;
  Eigen::Vector<double, 6> first;
  Eigen::Vector<double, 6> second;
};

Harmonics HarmonicsAt(double theta) {
  Harmonics harmonics;
  int k = 0;
  for (const double q : {1.0, 2.0, 4.0}) {
    const double cosine = std::cos(q * theta);
    const double sine = std::sin(q * theta);
    harmonics.value.segment<2>(k) << cosine - 1.0, sine;
    harmonics.first.segment<2>(k) << -q * sine, q * cosine;
    harmonics.second.segment<2>(k) << -q * q * cosine, -q * q * sine;
    k += 2;
  }
  return harmonics;
}

}  // namespace

PoseVectorJet LoopJetAt(const BasePose& base, const LoopCoefficients& coefficients, double s,
                        double duration_s) {
  const Phase phase = QuinticPhaseAt(s * duration_s, duration_s);
  const LoopOffset offset = LoopOffsetAt(coefficients, phase.theta);
  PoseVectorJet jet;
  jet.value << base.xyz_m, base.rpy_rad;
  jet.value += offset.value;
  jet.first = offset.first * phase.first;
  jet.second = offset.second * (phase.first * phase.first) + offset.first * phase.second;
  return jet;
}

void AddToLoopGradient(const PoseVectorJet& jet, const PoseVectorJet& by_jet, double s,
                       double duration_s, LoopGradient* gradient) {
  const Phase phase = QuinticPhaseAt(s * duration_s, duration_s);
  const Harmonics harmonics = HarmonicsAt(phase.theta);
  for (int dof = 0; dof < 6; ++dof) {
    gradient->coefficients.segment<6>(6 * dof) +=
        by_jet.value[dof] * harmonics.value +
        (by_jet.first[dof] * phase.first + by_jet.second[dof] * phase.second) * harmonics.first +
        by_jet.second[dof] * phase.first * phase.first * harmonics.second;
  }
  // At a fixed s, first and second derivatives are as 1 / duration and its square.
  gradient->duration_s -=
      (by_jet.first.dot(jet.first) + 2.0 * by_jet.second.dot(jet.second)) / duration_s;
}

void AddOffsetGradient(const PoseVector& by_offset, double theta, LoopCoefficients* gradient) {
  const Harmonics harmonics = HarmonicsAt(theta);
  for (int dof = 0; dof < 6; ++dof) {
    gradient->segment<6>(6 * dof) += by_offset[dof] * harmonics.value;
  }
}

FrameKinematics KinematicsOf(const PoseVectorJet& jet) {
  const Vector3d rates = jet.first.tail<3>();
  const BodyRates body = BodyRatesAt(jet.value[3], jet.value[4]);
  return {
      .R_b_e = RotationFromRpy(jet.value.tail<3>()),
      .position_b = jet.value.head<3>(),
      .velocity_b = jet.first.head<3>(),
      .acceleration_b = jet.second.head<3>(),
      .omega_e = body.B * rates,
      .alpha_e = body.B * jet.second.tail<3>() +
                 (rates[0] * body.by_roll + rates[1] * body.by_pitch) * rates,
  };
}

PoseVectorJet GradientByJet(const PoseVectorJet& jet, const FrameKinematicsGradient& gradient) {
  const Vector3d rates = jet.first.tail<3>();
  const Vector3d accelerations = jet.second.tail<3>();
  const BodyRates body = BodyRatesAt(jet.value[3], jet.value[4]);
  const Vector3d& omega = gradient.omega_e;
  const Vector3d& alpha = gradient.alpha_e;
  PoseVectorJet by_jet{PoseVector::Zero(), PoseVector::Zero(), PoseVector::Zero()};
  by_jet.value.head<3>() = gradient.position_b;
  by_jet.first.head<3>() = gradient.velocity_b;
  by_jet.second.head<3>() = gradient.acceleration_b;

  // A change of the angles turns the frame by eps = B d(rpy).
  by_jet.value.tail<3>() = body.B.transpose() * gradient.rotation;
  const Matrix3d B_dot = rates[0] * body.by_roll + rates[1] * body.by_pitch;
  by_jet.value[3] +=
      omega.dot(body.by_roll * rates) + alpha.dot(body.by_roll * accelerations) +
      alpha.dot((rates[0] * body.by_roll_twice + rates[1] * body.by_roll_and_pitch) * rates);
  by_jet.value[4] +=
      omega.dot(body.by_pitch * rates) + alpha.dot(body.by_pitch * accelerations) +
      alpha.dot((rates[0] * body.by_roll_and_pitch + rates[1] * body.by_pitch_twice) * rates);
  by_jet.first.tail<3>() = body.B.transpose() * omega + B_dot.transpose() * alpha;
  by_jet.first[3] += alpha.dot(body.by_roll * rates);
  by_jet.first[4] += alpha.dot(body.by_pitch * rates);
  by_jet.second.tail<3>() = body.B.transpose() * alpha;
  return by_jet;
}

}  // namespace calibrato
