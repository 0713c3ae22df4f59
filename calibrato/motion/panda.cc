#include "calibrato/motion/panda.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <kdl/chain.hpp>
#include <limits>
#include <numbers>

namespace calibrato {
namespace {

constexpr int kNumJoints = 7;
constexpr double kShoulderHeight = 0.333;
constexpr double kUpperArm = 0.316;
constexpr double kElbowOffset = 0.0825;
constexpr double kForearm = 0.384;
constexpr double kWristOffset = 0.088;
constexpr double kFlange = 0.107;

KDL::Chain MakeChain() {
  constexpr double kRight = std::numbers::pi / 2.0;
  // A KDL segment turns its joint first and ends where the next joint begins; in Craig's convention
  // a row (alpha, a, d) goes from the joint before to this joint.
  struct Row {
    double alpha, a, d;
  };
  const std::array<Row, kNumJoints> rows = {{{0.0, 0.0, kShoulderHeight},
                                             {-kRight, 0.0, 0.0},
                                             {kRight, 0.0, kUpperArm},
                                             {kRight, kElbowOffset, 0.0},
                                             {-kRight, -kElbowOffset, kForearm},
                                             {kRight, 0.0, 0.0},
                                             {kRight, kWristOffset, 0.0}}};
  const auto frame = [](const Row& row) {
    return KDL::Frame::DH_Craig1989(row.a, row.alpha, row.d, 0.0);
  };
  KDL::Chain chain;
  chain.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::None), frame(rows[0])));
  for (int i = 1; i < kNumJoints; ++i) {
    chain.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::RotZ), frame(rows[i])));
  }
  chain.addSegment(
      KDL::Segment(KDL::Joint(KDL::Joint::RotZ), KDL::Frame(KDL::Vector(0.0, 0.0, kFlange))));
  return chain;
}

Rigid3 ToRigid3(const KDL::Frame& frame) {
  Rigid3 T;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) T.R(row, column) = frame.M(row, column);
    T.t[row] = frame.p[row];
  }
  return T;
}

// The angle that differs from `angle` by whole turns and lies within pi of the middle of its
// joint's limits.
double UnwrapToLimits(double angle, int joint) {
  const double middle = 0.5 * (Limits().lower[joint] + Limits().upper[joint]);
  while (angle > middle + std::numbers::pi) angle -= 2.0 * std::numbers::pi;
  while (angle < middle - std::numbers::pi) angle += 2.0 * std::numbers::pi;
  return angle;
}

// What pose and last joint leave to the other six: the wrist (where axes 5 and 6 meet) and the axes
// of joint 6.
struct Wrist {
  Eigen::Vector3d from_shoulder;  // D
  Eigen::Vector3d x6;
  Eigen::Vector3d y6;
  Eigen::Vector3d z6;
};

Wrist WristAt(const Rigid3& T_b_e, double q7) {
  const Eigen::Vector3d x7 = T_b_e.R.col(0);
  const Eigen::Vector3d y7 = T_b_e.R.col(1);
  const Eigen::Vector3d z7 = T_b_e.R.col(2);
  Wrist wrist;
  wrist.x6 = std::cos(q7) * x7 - std::sin(q7) * y7;
  wrist.z6 = std::sin(q7) * x7 + std::cos(q7) * y7;
  wrist.y6 = -z7;
  wrist.from_shoulder =
      T_b_e.t - kFlange * z7 - kWristOffset * wrist.x6 - Eigen::Vector3d(0.0, 0.0, kShoulderHeight);
  return wrist;
}

// Upper arm u1 = (a, d3) and forearm u2 = (-a, d5), turned by q4, lie in one plane with axes x3,
// z3: D = u1 + R(q4) u2. By length, |D|^2 = |u1|^2 + |u2|^2 + 2 (kCosine cos q4 + kSine sin q4).
constexpr double kCosine = kUpperArm * kForearm - kElbowOffset * kElbowOffset;
constexpr double kSine = -kElbowOffset * (kUpperArm + kForearm);
constexpr double kSumOfSquares =
    kUpperArm * kUpperArm + kForearm * kForearm + 2.0 * kElbowOffset * kElbowOffset;

double CosineOfElbowOpening(const Wrist& wrist) {
  return 0.5 * (wrist.from_shoulder.squaredNorm() - kSumOfSquares) / std::hypot(kCosine, kSine);
}

std::array<double, 2> ElbowAngles(double cosine_of_opening) {
  const double stretched = std::atan2(kSine, kCosine);
  const double opening = std::acos(cosine_of_opening);
  return {stretched - opening, stretched + opening};
}

// The part of D along the forearm's axis z5.
double AlongForearm(double q4) {
  return kUpperArm * std::cos(q4) - kElbowOffset * std::sin(q4) + kForearm;
}

}  // namespace

const PandaLimits& Limits() {
  static const PandaLimits limits = [] {
    PandaLimits l;
    l.lower << -2.8973, -1.7628, -2.8973, -3.0718, -2.8973, -0.0175, -2.8973;
    l.upper << 2.8973, 1.7628, 2.8973, -0.0698, 2.8973, 3.7525, 2.8973;
    l.velocity << 2.175, 2.175, 2.175, 2.175, 2.61, 2.61, 2.61;
    l.acceleration << 3.75, 1.875, 2.5, 3.125, 3.75, 5.0, 5.0;
    l.jerk << 7500.0, 3750.0, 5000.0, 6250.0, 7500.0, 10000.0, 10000.0;
    l.torque << 87.0, 87.0, 87.0, 87.0, 12.0, 12.0, 12.0;
    return l;
  }();
  return limits;
}

double JointLimitExcess(const JointVector& q, const JointRange& range) {
  return (range.lower - q).cwiseMax(q - range.upper).maxCoeff<Eigen::PropagateNaN>();
}

PandaAxes AxesOf(const JointVector& q) {
  static const KDL::Chain chain = MakeChain();
  PandaAxes axes;
  KDL::Frame tip = chain.getSegment(0).pose(0.0);
  for (int i = 0; i < kNumJoints; ++i) {
    axes.T_b_link[i] = ToRigid3(KDL::Frame(tip.M * KDL::Rotation::RotZ(q[i]), tip.p));
    tip = tip * chain.getSegment(i + 1).pose(q[i]);
  }
  axes.T_b_e = ToRigid3(tip);
  return axes;
}

Rigid3 PandaPose(const JointVector& q, JointJacobian* J_pose_q) {
  const PandaAxes axes = AxesOf(q);
  if (J_pose_q != nullptr) {
    for (int i = 0; i < kNumJoints; ++i) {
      const Rigid3& link = axes.T_b_link[i];
      const Eigen::Vector3d axis = link.R.col(2);
      J_pose_q->col(i) << axis, axis.cross(axes.T_b_e.t - link.t);
    }
  }
  return axes.T_b_e;
}

std::vector<JointVector> PandaInverse(const Rigid3& T_b_e, double q7) {
  std::vector<JointVector> solutions;
  const Wrist wrist = WristAt(T_b_e, q7);
  const Eigen::Vector3d& D = wrist.from_shoulder;
  const double cosine_of_opening = CosineOfElbowOpening(wrist);
  if (!(std::abs(cosine_of_opening) <= 1.0)) return solutions;
  const double D_x6 = D.dot(wrist.x6);
  const double D_y6 = D.dot(wrist.y6);
  for (const double q4 : ElbowAngles(cosine_of_opening)) {
    // z5 = sin q6 x6 + cos q6 y6, and D . z5 follows from q4.
    const double cosine_of_turn = AlongForearm(q4) / std::hypot(D_x6, D_y6);
    if (!(std::abs(cosine_of_turn) <= 1.0)) continue;
    const double turn = std::acos(cosine_of_turn);
    const double cos4 = std::cos(q4);
    const double sin4 = std::sin(q4);
    for (const double q6 : {std::atan2(D_x6, D_y6) - turn, std::atan2(D_x6, D_y6) + turn}) {
      const Eigen::Vector3d z5 = std::sin(q6) * wrist.x6 + std::cos(q6) * wrist.y6;
      // The arm's plane from two vectors in it: D = D_x3 x3 + D_z3 z3, z5 = -sin4 x3 + cos4 z3.
      const double D_x3 = kElbowOffset - kElbowOffset * cos4 - kForearm * sin4;
      const double D_z3 = kUpperArm - kElbowOffset * sin4 + kForearm * cos4;
      const double determinant = D_x3 * cos4 + D_z3 * sin4;
      if (std::abs(determinant) < 1e-9) continue;  // the wrist on the upper arm's axis: no plane
      const Eigen::Vector3d x3 = (cos4 * D - D_z3 * z5) / determinant;
      const Eigen::Vector3d z3 = (sin4 * D + D_x3 * z5) / determinant;
      const Eigen::Vector3d z4 = x3.cross(z3);
      const Eigen::Vector3d x4 = cos4 * x3 + sin4 * z3;
      const double q5 = std::atan2(wrist.z6.dot(x4), wrist.z6.dot(z4));
      for (const double side : {1.0, -1.0}) {
        const double q1 = std::atan2(side * z3.y(), side * z3.x());
        const double q2 = side * std::atan2(std::hypot(z3.x(), z3.y()), z3.z());
        const Eigen::Vector3d x2(std::cos(q1) * std::cos(q2), std::sin(q1) * std::cos(q2),
                                 -std::sin(q2));
        const Eigen::Vector3d side_2(-std::sin(q1), std::cos(q1), 0.0);
        const double q3 = std::atan2(x3.dot(side_2), x3.dot(x2));
        JointVector q;
        q << q1, q2, q3, q4, q5, q6, q7;
        for (int i = 0; i < kNumJoints; ++i) q[i] = UnwrapToLimits(q[i], i);
        solutions.push_back(q);
      }
    }
  }
  return solutions;
}

double StretchedElbow() { return std::atan2(kSine, kCosine); }

double PandaShortfall(const Rigid3& T_b_e, double q7) {
  const Wrist wrist = WristAt(T_b_e, q7);
  const double cosine_of_opening = CosineOfElbowOpening(wrist);
  if (!(std::abs(cosine_of_opening) <= 1.0)) {
    const double limit =
        kSumOfSquares + std::copysign(2.0, cosine_of_opening) * std::hypot(kCosine, kSine);
    return std::abs(wrist.from_shoulder.norm() - std::sqrt(limit));
  }
  const double across_joint_6 =
      std::hypot(wrist.from_shoulder.dot(wrist.x6), wrist.from_shoulder.dot(wrist.y6));
  double shortfall = std::numeric_limits<double>::infinity();
  for (const double q4 : ElbowAngles(cosine_of_opening)) {
    shortfall = std::min(shortfall, std::max(0.0, std::abs(AlongForearm(q4)) - across_joint_6));
  }
  return shortfall;
}

std::optional<JointVector> PandaInverseNear(const Rigid3& T_b_e, const JointVector& q) {
  constexpr int kMaxIterations = 12;
  constexpr double kTolerance = 1e-10;
  constexpr double kSquaredDamping = 1e-8;
  JointVector solution = q;
  for (int i = 0; i < kMaxIterations; ++i) {
    JointJacobian J;
    const Rigid3 reached = PandaPose(solution, &J);
    const Eigen::Matrix<double, 6, 1> error = T_b_e.DifferenceTo(reached);
    if (!(error.norm() < 1.0)) return std::nullopt;
    if (error.norm() < kTolerance) return solution;
    // Damped less and less: without bias at the end, and still Newton's fast convergence.
    const double damping = kSquaredDamping * std::min(1.0, error.norm());
    Eigen::Matrix<double, 6, 6> normal = J * J.transpose();
    normal.diagonal().array() += damping;
    solution += J.transpose() * normal.llt().solve(error);
  }
  return std::nullopt;
}

JointVector PandaNullDirection(const JointJacobian& J_pose_q) {
  const Eigen::HouseholderQR<Eigen::Matrix<double, 7, 6>> qr(J_pose_q.transpose());
  return qr.householderQ() * JointVector::Unit(6);
}

}  // namespace calibrato
