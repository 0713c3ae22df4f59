#include "calibrato/calibration/projection_uncertainty.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <map>
#include <string>

#include "calibrato/calibration/pixel_derivatives.h"
#include "calibrato/geometry/so3.h"

namespace calibrato {
namespace {

using Matrix6d = Eigen::Matrix<double, 6, 6>;

// d(T_cn_c0) / d border: the chain's links up to camera n.
Eigen::MatrixXd ChainByBorder(int camera, const BundleAdjustmentState& state,
                              const BorderLayout& layout) {
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(6, layout.size);
  const Rigid3 T_cn_c0 = state.T_cn_c0(camera);
  for (int k = 1; k <= camera; ++k) {
    const Rigid3 T_ck_c0 = state.T_cn_c0(k);
    const Rigid3 T_ckm1_c0 = state.T_cn_c0(k - 1);
    const Rigid3 T_cn_ck = T_cn_c0 * T_ck_c0.Inverse();
    J.middleCols<6>(layout.chain[static_cast<size_t>(k)]) =
        JacobianProductSecond(T_cn_ck) *
        JacobianProductFirst(state.T_cn_cnm1[static_cast<size_t>(k - 1)], T_ckm1_c0);
  }
  return J;
}

// What a frame's pose perturbation [dtheta, dt] of T_cn_g does to points of the camera's frame:
// dtheta x (p - t) + dt = dtheta x p + (dt + t x dtheta).
Matrix6d MotionByPose(const Rigid3& T_cn_g) {
  Matrix6d K = Matrix6d::Identity();
  K.bottomLeftCorner<3, 3>() = Hat(T_cn_g.t);
  return K;
}

// By d pixel / d [parameters, dtheta, dt] of a point p_c; `shift` is 0 for one at infinity.
std::optional<Eigen::Matrix2d> Propagate(const HousedCamera& camera, const Eigen::Vector3d& p_c,
                                         double shift) {
  const auto derivatives = ProjectWithDerivatives(camera.model, p_c);
  if (!derivatives) return std::nullopt;
  Eigen::Matrix2Xd J(2, camera.covariance.cols());
  J << derivatives->by_parameters, -derivatives->by_point * Hat(p_c), shift * derivatives->by_point;
  return J * camera.covariance * J.transpose();
}

// Puts the views of a group's cameras together again. What is one frame's has one pose of the board
// to within rounding; a view with another pose of its own was separated from its frame.
class Frames {
 public:
  int Add(int number, const Rigid3& T_c0_g) {
    constexpr double kRounding = 1e-6;  // [rad], [m]
    const auto [begin, end] = by_number_.equal_range(number);
    for (auto known = begin; known != end; ++known) {
      const Rigid3& other = T_c0_g_[static_cast<size_t>(known->second)];
      if (T_c0_g.DifferenceTo(other).norm() < kRounding) return known->second;
    }
    const int frame = static_cast<int>(T_c0_g_.size());
    by_number_.emplace(number, frame);
    T_c0_g_.push_back(T_c0_g);
    return frame;
  }
  const std::vector<Rigid3>& T_c0_g() const { return T_c0_g_; }

 private:
  std::multimap<int, int> by_number_;
  std::vector<Rigid3> T_c0_g_;
};

// The rows of a covariance that belong to a border; empty where one is missing.
std::vector<Eigen::Index> RowsOf(const std::vector<std::string>& wanted,
                                 const std::vector<std::string>& names) {
  std::vector<Eigen::Index> rows;
  for (const std::string& name : wanted) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) return {};
    rows.push_back(found - names.begin());
  }
  return rows;
}

// BorderNames count cameras from 0: here from `first`.
std::vector<std::string> BorderNamesFrom(size_t first, const std::vector<CameraModel>& models,
                                         bool estimate_bending) {
  std::vector<std::string> names = BorderNames(models, estimate_bending);
  for (std::string& name : names) {
    if (!name.starts_with("cam")) continue;
    const size_t dot = name.find('.');
    name = "cam" + std::to_string(first + std::stoul(name.substr(3, dot - 3))) + name.substr(dot);
  }
  return names;
}

// Cameras first, .., end - 1, each related to the one before it.
void HouseGroup(size_t first, size_t end, const CameraRigProblem& problem,
                const CameraRigCalibration& calibration,
                std::vector<std::optional<HousedCamera>>* housed) {
  BundleAdjustmentState state;
  BundleAdjustmentOptions options;
  std::vector<const BoardView*> board_views;
  for (size_t c = first; c < end; ++c) {
    const CameraCalibration& camera = calibration.cameras[c];
    if (!camera.model || camera.covariance.size() == 0) return;
    state.models.push_back(*camera.model);
    if (c > first) state.T_cn_cnm1.push_back(*calibration.T_cn_cnm1[c - 1]);
    options.fixed_parameters.push_back(problem.cameras[c].fixed);
    options.noise_stddev_px.push_back(camera.noise_stddev_px);
    for (const BoardView& view : camera.used_views) board_views.push_back(&view);
  }
  const BendingShapes shapes(board_views);
  if (calibration.bending) options.bending_shapes = &shapes;

  Frames frames;
  std::vector<BundleView> views;
  for (size_t c = first; c < end; ++c) {
    const CameraCalibration& camera = calibration.cameras[c];
    const auto place = static_cast<int>(c - first);
    const Rigid3 T_c0_cn = state.T_cn_c0(place).Inverse();
    for (size_t v = 0; v < camera.used_views.size(); ++v) {
      const int number = problem.frame_of_view[c][camera.used_view_indices[v]];
      const int frame = frames.Add(number, T_c0_cn * camera.T_c_g[v]);
      views.push_back({place, frame, &camera.used_views[v]});
    }
  }
  state.T_c0_g = frames.T_c0_g();
  std::stable_sort(views.begin(), views.end(),
                   [](const BundleView& a, const BundleView& b) { return a.frame < b.frame; });
  const std::vector<Eigen::Index> rows =
      RowsOf(BorderNamesFrom(first, state.models, calibration.bending.has_value()),
             calibration.covariance_names);
  if (rows.empty()) return;
  const Eigen::MatrixXd border_covariance = calibration.covariance(rows, rows);
  for (size_t c = first; c < end; ++c) {
    (*housed)[c] =
        HouseCamera(static_cast<int>(c - first), state, views, options, border_covariance);
  }
}

}  // namespace

HousedCamera HouseCamera(int camera, const BundleAdjustmentState& state,
                         const std::vector<BundleView>& views,
                         const BundleAdjustmentOptions& options,
                         const Eigen::MatrixXd& border_covariance) {
  const BorderLayout layout(state.models, options.bending_shapes != nullptr);
  const std::vector<FramePose> frames = FramePoses(state, views, options);
  const Rigid3 T_cn_c0 = state.T_cn_c0(camera);
  const Eigen::MatrixXd chain = ChainByBorder(camera, state, layout);
  Eigen::MatrixXd motion_by_border = Eigen::MatrixXd::Zero(6, layout.size);
  Matrix6d motion_given_border = Matrix6d::Zero();
  double num_frames = 0.0;
  for (const BundleView& view : views) {
    if (view.camera != camera) continue;
    num_frames += 1.0;
    const FramePose& frame = frames[static_cast<size_t>(view.frame)];
    const Rigid3& T_c0_g = state.T_c0_g[static_cast<size_t>(view.frame)];
    const Matrix6d K = MotionByPose(T_cn_c0 * T_c0_g);
    const Matrix6d motion_by_frame = K * JacobianProductSecond(T_cn_c0);
    motion_by_border += motion_by_frame * frame.by_border;
    motion_by_border += K * JacobianProductFirst(T_cn_c0, T_c0_g) * chain;
    motion_given_border +=
        motion_by_frame * frame.conditional_covariance * motion_by_frame.transpose();
  }
  assert(num_frames > 0);
  motion_by_border /= num_frames;
  motion_given_border /= num_frames * num_frames;

  const CameraModel& model = state.models[static_cast<size_t>(camera)];
  const Eigen::Index n = model.num_parameters();
  Eigen::MatrixXd by_border(n + 6, layout.size);
  by_border.topRows(n).setZero();
  by_border.block(0, layout.parameters[static_cast<size_t>(camera)], n, n).setIdentity();
  by_border.bottomRows<6>() = motion_by_border;
  HousedCamera housed{model, by_border * border_covariance * by_border.transpose()};
  housed.covariance.bottomRightCorner<6, 6>() += motion_given_border;
  return housed;
}

std::vector<std::optional<HousedCamera>> HouseCameras(const CameraRigProblem& problem,
                                                      const CameraRigCalibration& calibration) {
  std::vector<std::optional<HousedCamera>> housed(calibration.cameras.size());
  for (size_t first = 0; first < housed.size();) {
    size_t end = first + 1;
    while (end < housed.size() && calibration.T_cn_cnm1[end - 1]) ++end;
    HouseGroup(first, end, problem, calibration, &housed);
    first = end;
  }
  return housed;
}

std::optional<Eigen::Matrix2d> PixelCovariance(const HousedCamera& camera,
                                               const Eigen::Vector3d& p_c) {
  return Propagate(camera, p_c, 1.0);
}

std::optional<Eigen::Matrix2d> PixelCovarianceAtInfinity(const HousedCamera& camera,
                                                         const Eigen::Vector3d& ray_c) {
  return Propagate(camera, ray_c, 0.0);
}

ImageMap ProjectionUncertainty(const HousedCamera& camera, Resolution resolution,
                               double distance_m) {
  assert(distance_m > 0.0);
  return MapOverImage(resolution, [&](const Eigen::Vector2d& pixel) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    const auto ray = camera.model.Unproject(pixel);
    if (!ray) return kNone;
    const Eigen::Vector3d direction = ray->normalized();
    const auto covariance = std::isinf(distance_m)
                                ? PixelCovarianceAtInfinity(camera, direction)
                                : PixelCovariance(camera, distance_m * direction);
    if (!covariance) return kNone;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(*covariance,
                                                                Eigen::EigenvaluesOnly);
    return std::sqrt(solver.eigenvalues()(1));
  });
}

}  // namespace calibrato
