#include "calibrato/motion/panda_dynamics.h"

#include <Eigen/Geometry>

#include "calibrato/sensors/imu.h"

namespace calibrato {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Matrix3d Symmetric(double xx, double yy, double zz, double xy, double xz, double yz) {
  Matrix3d matrix;
  matrix << xx, xy, xz, xy, yy, yz, xz, yz, zz;
  return matrix;
}

// What several bodies, all in one frame, are together.
LinkInertia Joined(const std::array<LinkInertia, 3>& bodies) {
  LinkInertia sum{0.0, Vector3d::Zero(), Matrix3d::Zero()};
  for (const LinkInertia& body : bodies) {
    sum.mass += body.mass;
    sum.centre_link += body.mass * body.centre_link;
  }
  sum.centre_link /= sum.mass;
  for (const LinkInertia& body : bodies) {
    const Vector3d d = body.centre_link - sum.centre_link;
    sum.about_centre += body.about_centre +
                        body.mass * (d.squaredNorm() * Matrix3d::Identity() - d * d.transpose());
  }
  return sum;
}

LinkInertia Turned(const Matrix3d& R_a_b, const LinkInertia& body_b) {
  return {body_b.mass, R_a_b * body_b.centre_link, R_a_b * body_b.about_centre * R_a_b.transpose()};
}

LinkInertia HandOnFlange() {
  const LinkInertia hand{0.73, {-0.01, 0.0, 0.03}, Symmetric(0.001, 0.0025, 0.0017, 0.0, 0.0, 0.0)};
  // In the middle of each finger, 30 mm to either side.
  const Matrix3d finger = Symmetric(2.375e-6, 2.375e-6, 7.5e-7, 0.0, 0.0, 0.0);
  const LinkInertia left{0.015, {0.0, 0.03, 0.0844}, finger};
  const LinkInertia right{0.015, {0.0, -0.03, 0.0844}, finger};
  const Matrix3d R_e_hand =
      Eigen::AngleAxisd(-0.25 * EIGEN_PI, Vector3d::UnitZ()).toRotationMatrix();
  return Turned(R_e_hand, Joined({hand, left, right}));
}

}  // namespace

const std::array<LinkInertia, 8>& PandaInertias() {
  static const std::array<LinkInertia, 8> inertias = {{
      {4.970684,
       {0.003875, 0.002081, -0.04762},
       Symmetric(0.70337, 0.70661, 0.009117, -0.000139, 0.006772, 0.019169)},
      {0.646926,
       {-0.003141, -0.02872, 0.003495},
       Symmetric(0.007962, 0.02811, 0.025995, -0.003925, 0.010254, 0.000704)},
      {3.228604,
       {0.027518, 0.039252, -0.066502},
       Symmetric(0.037242, 0.036155, 0.01083, -0.004761, -0.011396, -0.012805)},
      {3.587895,
       {-0.05317, 0.104419, 0.027454},
       Symmetric(0.025853, 0.019552, 0.028323, 0.007796, -0.001332, 0.008641)},
      {1.225946,
       {-0.011953, 0.041065, -0.038437},
       Symmetric(0.035549, 0.029474, 0.008627, -0.002117, -0.004037, 0.000229)},
      {1.666555,
       {0.060149, -0.014117, -0.010517},
       Symmetric(0.001964, 0.004354, 0.005433, 0.000109, -0.001158, 0.000341)},
      {0.735522,
       {0.010517, -0.004252, 0.061597},
       Symmetric(0.012516, 0.010027, 0.004815, -0.000428, -0.001196, -0.000741)},
      HandOnFlange(),
  }};
  return inertias;
}

JointVector PandaTorque(const JointVector& q, const JointVector& velocity,
                        const JointVector& acceleration) {
  const PandaAxes axes = AxesOf(q);
  const std::array<LinkInertia, 8>& inertias = PandaInertias();
  // Outwards. A base that accelerates upwards feels like gravity.
  std::array<Vector3d, 8> centre_b;
  std::array<Vector3d, 8> force_b;
  std::array<Vector3d, 8> moment_b;
  Vector3d omega = Vector3d::Zero();
  Vector3d alpha = Vector3d::Zero();
  Vector3d origin_accel(0.0, 0.0, kStandardGravity);
  Vector3d origin = Vector3d::Zero();
  for (size_t k = 0; k < inertias.size(); ++k) {
    const bool is_hand = k == 7;
    const Rigid3& T_b_link = is_hand ? axes.T_b_e : axes.T_b_link[k];
    const Vector3d step = T_b_link.t - origin;
    origin_accel += alpha.cross(step) + omega.cross(omega.cross(step));
    origin = T_b_link.t;
    if (!is_hand) {
      const auto joint = static_cast<Eigen::Index>(k);
      const Vector3d axis = T_b_link.R.col(2);
      alpha += axis * acceleration[joint] + omega.cross(axis) * velocity[joint];
      omega += axis * velocity[joint];
    }
    const LinkInertia& body = inertias[k];
    const Matrix3d inertia_b = T_b_link.R * body.about_centre * T_b_link.R.transpose();
    const Vector3d arm = T_b_link.R * body.centre_link;
    centre_b[k] = origin + arm;
    force_b[k] = body.mass * (origin_accel + alpha.cross(arm) + omega.cross(omega.cross(arm)));
    moment_b[k] = inertia_b * alpha + omega.cross(inertia_b * omega);
  }
  // Each joint carries all bodies from its own on.
  JointVector torque = kMotorInertia * acceleration + kViscousFriction * velocity;
  for (size_t joint = 0; joint < 7; ++joint) {
    const Rigid3& T_b_link = axes.T_b_link[joint];
    Vector3d moment = Vector3d::Zero();
    for (size_t k = joint; k < inertias.size(); ++k) {
      moment += moment_b[k] + (centre_b[k] - T_b_link.t).cross(force_b[k]);
    }
    torque[static_cast<Eigen::Index>(joint)] += T_b_link.R.col(2).dot(moment);
  }
  return torque;
}

}  // namespace calibrato
