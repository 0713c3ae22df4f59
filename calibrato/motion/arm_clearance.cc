#include "calibrato/motion/arm_clearance.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <utility>

#include "calibrato/motion/carrier.h"

namespace calibrato {
namespace {

using Eigen::Vector3d;

constexpr double kFloorHeight = -0.75;  // of the room, under the arm's base [m]
constexpr double kBoardThickness = 0.006;
constexpr double kPostHalfWidth = 0.02;
constexpr double kSensorRadius = 0.02;
constexpr int kHand = 8;

std::vector<Rigid3> PandaFrames(const JointVector& q) {
  const PandaAxes axes = AxesOf(q);
  std::vector<Rigid3> frames(axes.T_b_link.begin(), axes.T_b_link.end());
  frames.push_back(axes.T_b_e);
  return frames;
}

std::vector<ArmPart> PandaParts(const Rig& rig) {
  std::vector<ArmPart> parts = ArmParts();
  parts.back().capsule = RightFinger(rig);
  return parts;
}

Capsule InBase(const std::vector<Rigid3>& frames, const ArmPart& part) {
  if (part.link == 0) return part.capsule;
  const Rigid3& T = frames[static_cast<size_t>(part.link) - 1];
  return {T * part.capsule.a, T * part.capsule.b, part.capsule.radius_m};
}

// The sheet beyond the outermost points: one spacing, and half of one for the margin.
Box BoardBox(const Rig& rig) {
  const Eigen::Matrix3Xd points_g = BoardPoints(rig.board);
  const std::vector<std::pair<int, int>> neighbours = NeighbouringPoints(rig.board);
  double spacing = 0.0;
  for (const auto& [i, j] : neighbours) {
    spacing = std::max(spacing, (points_g.col(i) - points_g.col(j)).norm());
  }
  const Vector3d low = points_g.rowwise().minCoeff();
  const Vector3d high = points_g.rowwise().maxCoeff();
  Box box;
  box.half_size = 0.5 * (high - low) + Vector3d::Constant(1.5 * spacing);
  box.half_size.z() = 0.5 * kBoardThickness;
  const Rigid3 T_g_box{Eigen::Matrix3d::Identity(),
                       0.5 * (low + high) - Vector3d(0.0, 0.0, 0.5 * kBoardThickness)};
  box.T_b_box = ArmBaseInWorld().Inverse() * rig.T_w_g * T_g_box;
  return box;
}

// Upright, behind the board's middle.
Box PostBox(const Box& board) {
  Vector3d top = board.T_b_box.t;
  Vector3d back = -board.T_b_box.R.col(2);
  back.z() = 0.0;
  constexpr double kFlat = 1e-3;  // a board that lies has its post underneath
  if (back.norm() > kFlat) top += 2.0 * kPostHalfWidth * back.normalized();
  Box post;
  const double half_height = std::max(0.5 * (top.z() - kFloorHeight), kPostHalfWidth);
  post.half_size = {kPostHalfWidth, kPostHalfWidth, half_height};
  post.T_b_box.t = {top.x(), top.y(), top.z() - half_height};
  return post;
}

}  // namespace

std::vector<NamedBox> SurroundingsOf(const Rig& rig) {
  const Box table{{Eigen::Matrix3d::Identity(), {0.2, 0.0, -0.02}}, {0.6, 0.6, 0.02}};
  const Box board = BoardBox(rig);
  return {{"table", table}, {"board", board}, {"stand", PostBox(board)}};
}

const std::vector<ArmPart>& ArmParts() {
  static const std::vector<ArmPart> parts = [] {
    std::vector<ArmPart> all = {
        {"link 1", 1, {{0.0, 0.0, -0.25}, {0.0, 0.0, -0.05}, 0.06}},
        {"link 2", 2, {{0.0, 0.0, -0.06}, {0.0, 0.0, 0.06}, 0.06}},
        {"link 3", 3, {{0.0, 0.0, -0.22}, {0.0, 0.0, -0.07}, 0.06}},
        {"link 4", 4, {{0.0, 0.0, -0.06}, {0.0, 0.0, 0.06}, 0.06}},
        {"link 5", 5, {{0.0, 0.0, -0.31}, {0.0, 0.0, -0.21}, 0.06}},
        {"link 5", 5, {{0.0, 0.05, -0.21}, {0.0, 0.06, -0.05}, 0.045}},
        {"link 6", 6, {{0.0, 0.0, -0.07}, {0.0, 0.0, 0.01}, 0.05}},
        {"link 7", 7, {{0.0, 0.0, -0.06}, {0.0, 0.0, 0.08}, 0.04}},
    };
    const Eigen::Matrix3d R_e_hand =
        Eigen::AngleAxisd(-0.25 * EIGEN_PI, Vector3d::UnitZ()).toRotationMatrix();
    const auto on_hand = [&](const Vector3d& a, const Vector3d& b, double radius_m) {
      all.push_back({"hand", kHand, {R_e_hand * a, R_e_hand * b, radius_m}});
    };
    on_hand({0.0, -0.05, 0.04}, {0.0, 0.05, 0.04}, 0.04);
    on_hand({0.0, 0.036, 0.0634}, {0.0, 0.036, 0.1034}, 0.011);
    on_hand({0.0, -0.036, 0.0634}, {0.0, -0.036, 0.1034}, 0.011);
    return all;
  }();
  return parts;
}

Capsule RightFinger(const Rig& rig) {
  Capsule finger = ArmParts().back().capsule;
  finger.b += rig.finger_reach_m * (finger.b - finger.a).normalized();
  return finger;
}

double Distance(const Capsule& capsule, const Box& box) {
  const Rigid3 T_box_b = box.T_b_box.Inverse();
  const Vector3d a = T_box_b * capsule.a;
  const Vector3d along = T_box_b * capsule.b - a;
  // Of a point: outside its distance, inside minus the way out. Convex along the line.
  const auto distance_at = [&](double s) {
    const Vector3d beyond = (a + s * along).cwiseAbs() - box.half_size;
    return beyond.cwiseMax(0.0).norm() + std::min(beyond.maxCoeff(), 0.0);
  };
  if (along.isZero(0.0)) return distance_at(0.0) - capsule.radius_m;
  double low = 0.0;
  double high = 1.0;
  constexpr int kNumCuts = 40;  // each by a third
  for (int i = 0; i < kNumCuts; ++i) {
    const double left = low + (high - low) / 3.0;
    const double right = high - (high - low) / 3.0;
    if (distance_at(left) < distance_at(right)) {
      high = right;
    } else {
      low = left;
    }
  }
  return distance_at(0.5 * (low + high)) - capsule.radius_m;
}

double Distance(const Capsule& first, const Capsule& second) {
  const Vector3d u = first.b - first.a;
  const Vector3d v = second.b - second.a;
  const Vector3d w = first.a - second.a;
  // |w + s u - t v|^2 is convex in s and t, each in [0, 1]: least where both slopes vanish, or else
  // on an end of one of the lines.
  const auto on_second = [&](double s) {
    const double length = v.squaredNorm();
    return length > 0.0 ? std::clamp((w + s * u).dot(v) / length, 0.0, 1.0) : 0.0;
  };
  const auto on_first = [&](double t) {
    const double length = u.squaredNorm();
    return length > 0.0 ? std::clamp((t * v - w).dot(u) / length, 0.0, 1.0) : 0.0;
  };
  const double uu = u.squaredNorm();
  const double vv = v.squaredNorm();
  const double uv = u.dot(v);
  const double determinant = uu * vv - uv * uv;
  double least = std::numeric_limits<double>::infinity();
  const auto consider = [&](double s, double t) {
    least = std::min(least, (w + s * u - t * v).norm());
  };
  if (determinant > 0.0) {
    const double s = std::clamp((uv * v.dot(w) - vv * u.dot(w)) / determinant, 0.0, 1.0);
    consider(s, on_second(s));
  }
  for (const double end : {0.0, 1.0}) {
    consider(end, on_second(end));
    consider(on_first(end), end);
  }
  return least - first.radius_m - second.radius_m;
}

ClearanceCheck::ClearanceCheck(const Rig& rig)
    : ClearanceCheck(rig, PandaParts(rig), PandaFrames, kHand - 1) {}

ClearanceCheck::ClearanceCheck(const Rig& rig, std::vector<ArmPart> parts,
                               std::function<std::vector<Rigid3>(const JointVector& q)> frames,
                               int num_joints)
    : frames_(std::move(frames)), parts_(std::move(parts)), things_(SurroundingsOf(rig)) {
  const int hand = num_joints + 1;
  const Rigid3 T_e_i = rig.T_e_c0 * rig.T_c0_i;
  parts_.push_back({"camera", hand, {rig.T_e_c0.t, rig.T_e_c0.t, kSensorRadius}});
  parts_.push_back({"IMU", hand, {T_e_i.t, T_e_i.t, kSensorRadius}});
  for (const KeepOutBox& box : rig.arm_limits.keep_out) {
    things_.push_back({box.name, {box.T_b_box, 0.5 * box.size_m}});
  }
}

Clearance ClearanceCheck::Least(const JointVector& q) const {
  const std::vector<Rigid3> frames = frames_(q);
  std::vector<Capsule> capsules;
  for (const ArmPart& part : parts_) capsules.push_back(InBase(frames, part));
  double least = std::numeric_limits<double>::infinity();
  const std::string* first = nullptr;
  const std::string* second = nullptr;
  const auto consider = [&](double distance_m, const std::string& a, const std::string& b) {
    if (!(distance_m < least)) return;
    least = distance_m;
    first = &a;
    second = &b;
  };
  for (size_t i = 0; i < parts_.size(); ++i) {
    for (const NamedBox& thing : things_) {
      if (parts_[i].link <= 1) continue;
      // Not nearer than the ball around the capsule.
      const Vector3d middle = 0.5 * (capsules[i].a + capsules[i].b);
      const double ball = 0.5 * (capsules[i].b - capsules[i].a).norm() + capsules[i].radius_m;
      if (Distance(Capsule{middle, middle, ball}, thing.box) > least) continue;
      consider(Distance(capsules[i], thing.box), parts_[i].name, thing.name);
    }
    constexpr int kNeighbours = 2;
    for (size_t j = i + 1; j < parts_.size(); ++j) {
      if (std::abs(parts_[j].link - parts_[i].link) <= kNeighbours) continue;
      consider(Distance(capsules[i], capsules[j]), parts_[i].name, parts_[j].name);
    }
  }
  return {least, *first + " to " + *second};
}

}  // namespace calibrato
