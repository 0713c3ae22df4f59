#include "calibrato/mdp/motion_information.h"

#include <Eigen/Geometry>
#include <cassert>
#include <cmath>

#include "calibrato/calibration/expected_extrinsics.h"
#include "calibrato/calibration/information.h"
#include "calibrato/calibration/planned_frame.h"
#include "calibrato/motion/carrier.h"
#include "calibrato/simulation/fast_simulation.h"

namespace calibrato {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Vector6d = Eigen::Matrix<double, 6, 1>;

constexpr double kIntrinsicMarginPx = 8.0;
constexpr double kExtrinsicMarginPx = 0.0;
constexpr double kImuRateHz = 50.0;
// Less than this, and a frame is not worth its Jacobian.
constexpr double kLeastWeight = 1e-6;

// An instant of a motion.
struct Instant {
  size_t loop = 0;
  double s = 0.0;  // Of the loop's duration.
  double t_s = 0.0;
  PoseVectorJet jet;
  FrameKinematics kinematics;
};

// @param num_per_loop  In the middles of as many equal parts.
std::vector<Instant> InstantsOf(const Motion& motion, size_t loop, double start_s,
                                int num_per_loop) {
  std::vector<Instant> instants;
  const Loop& it = motion.loops[loop];
  for (int k = 0; k < num_per_loop; ++k) {
    const double s = (k + 0.5) / num_per_loop;
    const PoseVectorJet jet = LoopJetAt(motion.base_pose, it.coefficients, s, it.duration_s);
    instants.push_back({loop, s, start_s + s * it.duration_s, jet, KinematicsOf(jet)});
  }
  return instants;
}

// How likely a frame counts, and how that depends on its pose.
class Visibility {
 public:
  Visibility(const Camera& camera, BoardView points, double margin_px, double softness_px)
      : camera_(camera), points_(std::move(points)), margin_(margin_px), softness_(softness_px) {}

  double At(const Rigid3& T_c_g) const {
    const double inside =
        MarginInImage(camera_.model, camera_.resolution, points_, T_c_g) - margin_;
    return 1.0 / (1.0 + std::exp(-inside / softness_));
  }
  Vector6d Gradient(const Rigid3& T_c_g) const {
    return GradientByPose([&](const Rigid3& T) -> std::optional<double> { return At(T); }, T_c_g);
  }
  const BoardView& points() const { return points_; }

 private:
  const Camera& camera_;
  BoardView points_;
  double margin_;
  double softness_;
};

// From a number's derivatives by T_c_g [dtheta, dt] to those by the controlled frame.
void AddPoseGradient(const Vector6d& by_T_c_g, const Rigid3& T_c_e, const Rigid3& T_b_g,
                     const FrameKinematics& kinematics, FrameKinematicsGradient* gradient) {
  // T_c_g = T_c_e T_b_e^-1 T_b_g: turning e by eps turns the board by -R_c_e eps.
  const Vector3d turn = T_c_e.R.transpose() * by_T_c_g.head<3>();
  const Vector3d push = T_c_e.R.transpose() * by_T_c_g.tail<3>();
  const Vector3d board_e = kinematics.R_b_e.transpose() * (T_b_g.t - kinematics.position_b);
  gradient->rotation -= turn + board_e.cross(push);
  gradient->position_b -= kinematics.R_b_e * push;
}

void AddTo(const Instant& instant, double duration_s, const FrameKinematicsGradient& gradient,
           LoopGradient* loop) {
  AddToLoopGradient(instant.jet, GradientByJet(instant.jet, gradient), instant.s, duration_s, loop);
}

std::vector<double> StartsOf(const Motion& motion) {
  std::vector<double> starts;
  double start = 0.0;
  for (const Loop& loop : motion.loops) {
    starts.push_back(start);
    start += loop.duration_s;
  }
  starts.push_back(start);
  return starts;
}

Rigid3 PoseOf(const FrameKinematics& kinematics) {
  return {kinematics.R_b_e, kinematics.position_b};
}

}  // namespace

std::optional<MotionInformation> ExpectIntrinsicInformation(
    const Rig& rig, const Motion& motion, const MotionInformationOptions& options) {
  assert(!rig.cameras.empty() && !motion.loops.empty());
  const Camera& camera = rig.cameras.front();
  const CameraModel& model = camera.model;
  const Rigid3 T_c_e = rig.T_e_c0.Inverse();
  const Rigid3 T_b_g = ArmBaseInWorld().Inverse() * rig.T_w_g;
  const Visibility visibility(camera, PlannedView(rig.board),
                              kIntrinsicMarginPx + options.extra_margin_px,
                              options.visibility_softness_px);
  const double variance = rig.corner_noise.stddev_px * rig.corner_noise.stddev_px;
  const auto information_at = [&](const Rigid3& T_c_g) {
    return CameraInformationOfFrame(model, visibility.points(), T_c_g);
  };

  struct Frame {
    Instant instant;
    Rigid3 T_c_g;
    double visible;
    double per_second;  // d weight / d duration, of a frame that is visible.
    MatrixXd information;
  };
  std::vector<Frame> frames;
  MotionInformation result;
  const int num_parameters = model.num_parameters();
  MatrixXd sum = MatrixXd::Zero(num_parameters, num_parameters);
  for (size_t loop = 0; loop < motion.loops.size(); ++loop) {
    const double per_second = rig.camera_rate_hz / options.frames_per_loop;
    for (Instant& instant : InstantsOf(motion, loop, 0.0, options.frames_per_loop)) {
      const Rigid3 T_c_g = T_c_e * PoseOf(instant.kinematics).Inverse() * T_b_g;
      const double visible = visibility.At(T_c_g);
      if (visible < kLeastWeight) continue;
      auto information = information_at(T_c_g);
      if (!information) continue;
      *information /= variance;
      const double weight = visible * per_second * motion.loops[loop].duration_s;
      sum += weight * *information;
      result.num_frames += weight;
      if (options.want_gradient) {
        frames.push_back({std::move(instant), T_c_g, visible, per_second, std::move(*information)});
      }
    }
  }
  const auto covariance = CovarianceFromInformation(sum, {});
  if (!covariance) return std::nullopt;
  result.covariance = *covariance;
  const int focal = CameraModel::FocalIndex(model.name());
  const CriterionValue value = EvaluateCriterion(
      options.criterion, covariance->block(focal, focal, 4, 4), Eigen::Vector4d::Ones());
  result.criterion = value.value;
  if (!options.want_gradient) return result;

  const MatrixXd X = covariance->middleCols(focal, 4) * value.root;
  const MatrixXd XX = X * X.transpose();
  result.gradient.resize(motion.loops.size());
  for (const Frame& frame : frames) {
    const double duration = motion.loops[frame.instant.loop].duration_s;
    LoopGradient& loop = result.gradient[frame.instant.loop];
    const double gain = -XX.cwiseProduct(frame.information).sum();
    loop.duration_s += gain * frame.visible * frame.per_second;
    const double weight = frame.visible * frame.per_second * duration;
    const Vector6d by_pose = gain * frame.per_second * duration * visibility.Gradient(frame.T_c_g) -
                             weight * GradientByPose(
                                          [&](const Rigid3& T) -> std::optional<double> {
                                            const auto information = information_at(T);
                                            if (!information) return std::nullopt;
                                            return XX.cwiseProduct(*information).sum() / variance;
                                          },
                                          frame.T_c_g);
    FrameKinematicsGradient gradient;
    AddPoseGradient(by_pose, T_c_e, T_b_g, frame.instant.kinematics, &gradient);
    AddTo(frame.instant, duration, gradient, &loop);
  }
  return result;
}

std::optional<MotionInformation> ExpectExtrinsicInformation(
    const Rig& rig, const Motion& motion, const MotionInformationOptions& options) {
  assert(!rig.cameras.empty() && !motion.loops.empty());
  const Camera& camera = rig.cameras.front();
  const Rigid3 T_c_e = rig.T_e_c0.Inverse();
  const Rigid3 T_e_i = rig.T_e_c0 * rig.T_c0_i;
  const Rigid3 T_b_g = ArmBaseInWorld().Inverse() * rig.T_w_g;
  const Matrix3d R_g_b = T_b_g.R.transpose();
  const Matrix3d R_i_e = T_e_i.R.transpose();
  const Vector3d& lever = T_e_i.t;
  const Vector3d gravity_b = ArmBaseInWorld().R.transpose() * Vector3d(0, 0, -kStandardGravity);
  const Visibility visibility(camera, PlannedView(rig.board),
                              kExtrinsicMarginPx + options.extra_margin_px,
                              options.visibility_softness_px);
  const std::vector<double> starts = StartsOf(motion);

  PlannedMotion planned;
  planned.duration_s = starts.back();
  std::vector<Instant> imu_instants;
  std::vector<Instant> frame_instants;
  MotionInformation result;
  for (size_t loop = 0; loop < motion.loops.size(); ++loop) {
    const double duration = motion.loops[loop].duration_s;
    const int num_imu = static_cast<int>(std::ceil(kImuRateHz * 5.0));
    for (Instant& instant : InstantsOf(motion, loop, starts[loop], num_imu)) {
      const FrameKinematics& e = instant.kinematics;
      const Vector3d force_e = e.R_b_e.transpose() * (e.acceleration_b - gravity_b) +
                               e.alpha_e.cross(lever) + e.omega_e.cross(e.omega_e.cross(lever));
      planned.imu.push_back({instant.t_s, duration / num_imu, R_g_b * e.R_b_e * T_e_i.R,
                             R_i_e * e.omega_e, R_i_e * force_e});
      imu_instants.push_back(std::move(instant));
    }
    for (Instant& instant : InstantsOf(motion, loop, starts[loop], options.frames_per_loop)) {
      const FrameKinematics& e = instant.kinematics;
      const Rigid3 T_c_g = T_c_e * PoseOf(e).Inverse() * T_b_g;
      const double visible = visibility.At(T_c_g);
      const double weight = visible < kLeastWeight
                                ? 0.0
                                : visible * rig.camera_rate_hz * duration / options.frames_per_loop;
      result.num_frames += weight;
      planned.frames.push_back({instant.t_s, weight, T_c_g, R_i_e * e.omega_e,
                                R_g_b * (e.velocity_b + e.R_b_e * e.omega_e.cross(lever))});
      frame_instants.push_back(std::move(instant));
    }
  }
  const PlannedRig planned_rig{camera.model, visibility.points(), rig.corner_noise.stddev_px,
                               rig.T_c0_i,   rig.imu_noise,       R_g_b * gravity_b};
  const auto expected =
      ExpectExtrinsics(planned_rig, planned, options.criterion, options.want_gradient);
  if (!expected) return std::nullopt;
  result.criterion = expected->criterion;
  result.covariance = expected->covariance;
  if (!options.want_gradient) return result;

  result.gradient.resize(motion.loops.size());
  // What lies behind an instant moves with its loop's duration; so do all later loops.
  const auto add_time = [&](const Instant& instant, double by_time) {
    for (size_t loop = 0; loop < instant.loop; ++loop) result.gradient[loop].duration_s += by_time;
    result.gradient[instant.loop].duration_s += instant.s * by_time;
  };
  for (size_t k = 0; k < imu_instants.size(); ++k) {
    const Instant& instant = imu_instants[k];
    const FrameKinematics& e = instant.kinematics;
    const PlannedMotionGradient::Imu& by = expected->gradient.imu[k];
    const double duration = motion.loops[instant.loop].duration_s;
    const Vector3d force = T_e_i.R * by.force_i;
    FrameKinematicsGradient gradient;
    gradient.rotation =
        T_e_i.R * by.R_g_i + force.cross(e.R_b_e.transpose() * (e.acceleration_b - gravity_b));
    gradient.acceleration_b = e.R_b_e * force;
    gradient.alpha_e = lever.cross(force);
    // d (w x (w x l)) = dw x (w x l) + w x (dw x l)
    gradient.omega_e = T_e_i.R * by.omega_i + e.omega_e.cross(lever).cross(force) +
                       lever.cross(force.cross(e.omega_e));
    add_time(instant, by.t_s);
    LoopGradient& loop = result.gradient[instant.loop];
    loop.duration_s += by.duration_s * planned.imu[k].duration_s / duration;
    AddTo(instant, duration, gradient, &loop);
  }
  for (size_t k = 0; k < frame_instants.size(); ++k) {
    const PlannedFrame& frame = planned.frames[k];
    if (!(frame.weight > 0.0)) continue;
    const Instant& instant = frame_instants[k];
    const FrameKinematics& e = instant.kinematics;
    const PlannedMotionGradient::Frame& by = expected->gradient.frames[k];
    const double duration = motion.loops[instant.loop].duration_s;
    const double seen = rig.camera_rate_hz * duration / options.frames_per_loop;
    FrameKinematicsGradient gradient;
    AddPoseGradient(by.T_c_g + by.weight * seen * visibility.Gradient(frame.T_c_g), T_c_e, T_b_g, e,
                    &gradient);
    const Vector3d velocity_b = R_g_b.transpose() * by.velocity_g;
    const Vector3d velocity_e = e.R_b_e.transpose() * velocity_b;
    gradient.velocity_b = velocity_b;
    gradient.omega_e = T_e_i.R * by.omega_i + lever.cross(velocity_e);
    gradient.rotation += e.omega_e.cross(lever).cross(velocity_e);
    add_time(instant, by.t_s);
    LoopGradient& loop = result.gradient[instant.loop];
    loop.duration_s += by.weight * frame.weight / duration;
    AddTo(instant, duration, gradient, &loop);
  }
  return result;
}

}  // namespace calibrato
