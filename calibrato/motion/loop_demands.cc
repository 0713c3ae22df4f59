#include "calibrato/motion/loop_demands.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "calibrato/motion/way_point.h"

namespace calibrato {
namespace {

using Eigen::Vector3d;

constexpr int kNumInstants = 125;
constexpr double kSharpness = 50.0;
constexpr double kTiny = 1e-12;
// What stands for the place of a board that the lens can't see at all.
constexpr double kFarOutOfView = 3.0;

struct Instant {
  double s = 0.0;
  PoseVectorJet jet;
  FrameKinematics kinematics;
};

// A share of a limit at one instant.
struct Share {
  const Instant* instant = nullptr;
  double value = 0.0;
  FrameKinematicsGradient gradient;
};

LoopDemand SmoothMaximum(const std::vector<Share>& shares, double duration_s) {
  double largest = 0.0;
  for (const Share& share : shares) largest = std::max(largest, share.value);
  double sum = 0.0;
  for (const Share& share : shares) sum += std::exp(kSharpness * (share.value - largest));
  LoopDemand demand;
  demand.largest = largest;
  demand.value = largest + std::log(sum) / kSharpness;
  for (const Share& share : shares) {
    const double weight = std::exp(kSharpness * (share.value - largest)) / sum;
    if (weight < kTiny) continue;
    FrameKinematicsGradient gradient = share.gradient;
    for (Vector3d* part : {&gradient.rotation, &gradient.position_b, &gradient.velocity_b,
                           &gradient.acceleration_b, &gradient.omega_e, &gradient.alpha_e}) {
      *part *= weight;
    }
    AddToLoopGradient(share.instant->jet, GradientByJet(share.instant->jet, gradient),
                      share.instant->s, duration_s, &demand.gradient);
  }
  return demand;
}

// |v| / limit as a share, whose derivative by v goes into `part` of its gradient.
Share NormShare(const Instant& instant, const Vector3d& v, double limit,
                Vector3d FrameKinematicsGradient::*part) {
  Share share{&instant, v.norm() / limit, {}};
  share.gradient.*part = v / (limit * std::max(v.norm(), kTiny));
  return share;
}

// How far the board's centre is from the image's middle along u and v, of half the image.
using ImagePlace = std::array<double, 2>;
ImagePlace PlaceOf(const Camera& camera, const Vector3d& p_c) {
  const std::optional<Eigen::Vector2d> pixel = camera.model.Project(p_c);
  if (!pixel) return {kFarOutOfView, kFarOutOfView};
  const Eigen::Array2d size(camera.resolution.width, camera.resolution.height);
  const Eigen::Array2d place = (pixel->array() - 0.5 * (size - 1.0)).abs() / (0.5 * size);
  return {place.x(), place.y()};
}

void AddViewShares(const Instant& instant, const Rig& rig, std::vector<Share>* shares) {
  const Camera& camera = rig.cameras.front();
  const FrameKinematics& e = instant.kinematics;
  const Rigid3 T_c_e = rig.T_e_c0.Inverse();
  const Vector3d centre_b = ArmBaseInWorld().Inverse() * (rig.T_w_g * BoardCentre(rig.board));
  const Vector3d centre_e = e.R_b_e.transpose() * (centre_b - e.position_b);
  const Vector3d centre_c = T_c_e * centre_e;
  const ImagePlace place = PlaceOf(camera, centre_c);
  std::array<Vector3d, 2> by_centre_c;
  constexpr double kStep = 1e-6;
  for (int k = 0; k < 3; ++k) {
    const Vector3d step = kStep * Vector3d::Unit(k);
    const ImagePlace high = PlaceOf(camera, centre_c + step);
    const ImagePlace low = PlaceOf(camera, centre_c - step);
    for (size_t axis = 0; axis < 2; ++axis) {
      by_centre_c[axis](k) = (high[axis] - low[axis]) / (2.0 * kStep);
    }
  }
  for (size_t axis = 0; axis < 2; ++axis) {
    Share share{&instant, place[axis], {}};
    const Vector3d by_centre_e = T_c_e.R.transpose() * by_centre_c[axis];
    share.gradient.rotation = by_centre_e.cross(centre_e);
    share.gradient.position_b = -e.R_b_e * by_centre_e;
    shares->push_back(share);
  }
}

}  // namespace

LoopDemands DemandsOf(const BasePose& base, const Loop& loop, const Rig& rig,
                      const FreeCarrierLimits& limits) {
  std::vector<Instant> instants;
  for (int k = 0; k <= kNumInstants; ++k) {
    const double s = static_cast<double>(k) / kNumInstants;
    const PoseVectorJet jet = LoopJetAt(base, loop.coefficients, s, loop.duration_s);
    instants.push_back({s, jet, KinematicsOf(jet)});
  }
  std::vector<Share> speed;
  std::vector<Share> acceleration;
  std::vector<Share> angular_speed;
  std::vector<Share> angular_acceleration;
  std::vector<Share> reach;
  std::vector<Share> depth;
  std::vector<Share> view;
  using Gradient = FrameKinematicsGradient;
  for (const Instant& instant : instants) {
    const FrameKinematics& e = instant.kinematics;
    speed.push_back(NormShare(instant, e.velocity_b, limits.speed, &Gradient::velocity_b));
    acceleration.push_back(
        NormShare(instant, e.acceleration_b, limits.acceleration, &Gradient::acceleration_b));
    angular_speed.push_back(
        NormShare(instant, e.omega_e, limits.angular_speed, &Gradient::omega_e));
    angular_acceleration.push_back(
        NormShare(instant, e.alpha_e, limits.angular_acceleration, &Gradient::alpha_e));
    reach.push_back(NormShare(instant, e.position_b - FreeCarrierShoulder(), limits.reach,
                              &Gradient::position_b));
    Share height{&instant, 1.0 + limits.min_height - e.position_b.z(), {}};
    height.gradient.position_b = -Vector3d::UnitZ();
    depth.push_back(height);
    AddViewShares(instant, rig, &view);
  }
  const auto demand = [&](const std::vector<Share>& shares) {
    return SmoothMaximum(shares, loop.duration_s);
  };
  return {demand(speed), demand(acceleration), demand(angular_speed), demand(angular_acceleration),
          demand(reach), demand(depth),        demand(view)};
}

LoopDemand PathLengthWithGradient(const LoopCoefficients& coefficients) {
  constexpr double kRounding = 1e-6;  // [m]
  LoopDemand length;
  // Weights of the pose vector at each way-point, then back to the coefficients.
  std::array<PoseVector, kNumWayPoints + 1> offsets;
  std::array<PoseVector, kNumWayPoints + 1> by_offset;
  offsets[0].setZero();
  by_offset.fill(PoseVector::Zero());
  for (int k = 1; k <= kNumWayPoints; ++k) {
    const auto i = static_cast<size_t>(k);
    offsets[i] = LoopOffsetAt(coefficients, WayPointPhase(k)).value;
    const PoseVector step = offsets[i] - offsets[i - 1];
    for (const int first : {0, 3}) {
      const Vector3d part = step.segment<3>(first);
      const double norm = std::sqrt(part.squaredNorm() + kRounding * kRounding);
      length.value += norm;
      by_offset[i].segment<3>(first) += part / norm;
      by_offset[i - 1].segment<3>(first) -= part / norm;
    }
  }
  for (int k = 1; k <= kNumWayPoints; ++k) {
    AddOffsetGradient(by_offset[static_cast<size_t>(k)], WayPointPhase(k),
                      &length.gradient.coefficients);
  }
  return length;
}

}  // namespace calibrato
