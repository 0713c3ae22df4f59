#include "calibrato/motion/loop_kinematics.h"

#include <gtest/gtest.h>

#include "calibrato/base/rng.h"
#include "calibrato/geometry/expect_jacobian.h"
#include "calibrato/geometry/so3.h"
#include "calibrato/motion/loop_state.h"

namespace calibrato {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

LoopCoefficients RandomCoefficients(uint64_t seed) {
  Rng rng(seed);
  LoopCoefficients coefficients;
  for (double& c : coefficients) c = 0.05 * rng.Normal();
  return coefficients;
}

TEST(LoopKinematics, AreTheCarriersState) {
  const BasePose base;
  const LoopCoefficients coefficients = RandomCoefficients(1);
  constexpr double kDuration = 4.3;
  for (const double s : {0.0, 0.13, 0.5, 0.77, 1.0}) {
    const CarrierState state =
        LoopStateAt(base, coefficients, QuinticPhaseAt(s * kDuration, kDuration));
    const FrameKinematics kinematics = KinematicsOf(LoopJetAt(base, coefficients, s, kDuration));
    EXPECT_LT((kinematics.R_b_e - state.T_b_e.R).norm(), 1e-12);
    EXPECT_LT((kinematics.position_b - state.T_b_e.t).norm(), 1e-12);
    EXPECT_LT((kinematics.velocity_b - state.velocity_b).norm(), 1e-12);
    EXPECT_LT((kinematics.acceleration_b - state.acceleration_b).norm(), 1e-12);
    EXPECT_LT((kinematics.R_b_e * kinematics.omega_e - state.angular_velocity_b).norm(), 1e-12);
    EXPECT_LT((kinematics.R_b_e * kinematics.alpha_e - state.angular_acceleration_b).norm(), 1e-11);
  }
}

// A number that depends on everything.
struct Weights {
  FrameKinematicsGradient of;
  Weights() {
    Rng rng(5);
    for (Vector3d* w : {&of.rotation, &of.position_b, &of.velocity_b, &of.acceleration_b,
                        &of.omega_e, &of.alpha_e}) {
      *w = Vector3d(rng.Normal(), rng.Normal(), rng.Normal());
    }
  }
  double Of(const FrameKinematics& k, const Eigen::Matrix3d& R_0) const {
    return of.rotation.dot(LogSo3(R_0.transpose() * k.R_b_e)) + of.position_b.dot(k.position_b) +
           of.velocity_b.dot(k.velocity_b) + of.acceleration_b.dot(k.acceleration_b) +
           of.omega_e.dot(k.omega_e) + of.alpha_e.dot(k.alpha_e);
  }
};

TEST(LoopKinematics, TheirGradientGoesBackToCoefficientsAndDuration) {
  const BasePose base;
  const Weights weights;
  const LoopCoefficients coefficients = RandomCoefficients(2);
  constexpr double kDuration = 4.3;
  for (const double s : {0.21, 0.5, 0.86}) {
    const PoseVectorJet jet = LoopJetAt(base, coefficients, s, kDuration);
    const Eigen::Matrix3d R_0 = KinematicsOf(jet).R_b_e;
    LoopGradient gradient;
    AddToLoopGradient(jet, GradientByJet(jet, weights.of), s, kDuration, &gradient);
    MatrixXd J(1, 37);
    J << gradient.coefficients.transpose(), gradient.duration_s;
    VectorXd x(37);
    x << coefficients, kDuration;
    ExpectJacobian(
        [&](const VectorXd& at) {
          const FrameKinematics k =
              KinematicsOf(LoopJetAt(base, LoopCoefficients(at.head<36>()), s, at[36]));
          return VectorXd::Constant(1, weights.Of(k, R_0));
        },
        x, J, 1e-7, 1e-4);
  }
}

}  // namespace
}  // namespace calibrato
