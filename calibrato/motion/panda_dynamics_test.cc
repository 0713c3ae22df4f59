#include "calibrato/motion/panda_dynamics.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "calibrato/sensors/imu.h"

namespace calibrato {
namespace {

JointVector Bent() {
  JointVector q;
  q << 0.3, -0.6, 0.4, -2.1, 0.5, 1.7, 0.9;
  return q;
}

// m g h of all links.
double PotentialEnergy(const JointVector& q) {
  const PandaAxes axes = AxesOf(q);
  double energy = 0.0;
  for (size_t k = 0; k < PandaInertias().size(); ++k) {
    const Rigid3& T = k < 7 ? axes.T_b_link[k] : axes.T_b_e;
    energy += PandaInertias()[k].mass * kStandardGravity * (T * PandaInertias()[k].centre_link).z();
  }
  return energy;
}

TEST(PandaInertias, AreThoseOfBodies) {
  for (const LinkInertia& link : PandaInertias()) {
    EXPECT_GT(link.mass, 0.0);
    const Eigen::Vector3d moments =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(link.about_centre).eigenvalues();
    EXPECT_GT(moments[0], 0.0);
  }
}

TEST(PandaTorque, HoldsTheArmAgainstTheSlopeOfItsPotentialEnergy) {
  const JointVector still = JointVector::Zero();
  const JointVector torque = PandaTorque(Bent(), still, still);
  constexpr double kStep = 1e-6;
  for (int i = 0; i < 7; ++i) {
    const JointVector step = kStep * JointVector::Unit(i);
    const double slope =
        (PotentialEnergy(Bent() + step) - PotentialEnergy(Bent() - step)) / (2.0 * kStep);
    EXPECT_NEAR(torque[i], slope, 1e-6);
  }
  EXPECT_NEAR(torque[0], 0.0, 1e-12);  // joint 1 is upright
}

// Power put in, less what friction takes, is the change of kinetic and potential energy.
TEST(PandaTorque, KeepsTheBalanceOfEnergy) {
  JointVector velocity;
  velocity << 0.7, -0.4, 1.1, 0.6, -1.3, 0.8, 1.9;
  JointVector acceleration;
  acceleration << -2.0, 1.0, 0.5, 1.5, -0.7, 2.5, -3.0;
  const JointVector still = JointVector::Zero();
  // Kinetic energy is half of q' M q', and M a = torque(a) - torque(0) at rest.
  const auto energy = [&](const JointVector& q, const JointVector& v) {
    const JointVector momentum = PandaTorque(q, still, v) - PandaTorque(q, still, still);
    return 0.5 * v.dot(momentum) + PotentialEnergy(q);
  };
  constexpr double kStep = 1e-6;
  const auto energy_at = [&](double t_s) {
    return energy(Bent() + t_s * velocity + 0.5 * t_s * t_s * acceleration,
                  velocity + t_s * acceleration);
  };
  const double change = (energy_at(kStep) - energy_at(-kStep)) / (2.0 * kStep);
  const double power = velocity.dot(PandaTorque(Bent(), velocity, acceleration)) -
                       kViscousFriction * velocity.squaredNorm();
  EXPECT_NEAR(power, change, 1e-5 * std::abs(change) + 1e-5);
}

}  // namespace
}  // namespace calibrato
