#include "calibrato/calibration/start_values.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "calibrato/calibration/homography.h"

namespace calibrato {
namespace {

// Enough views to tell focal lengths apart; the best one is then used for all.
constexpr size_t kMaxTrialViews = 12;

// Each view gives two equations a w + b = 0 in w = 1 / f^2 (orthogonal, equally long axes of the
// board); their least-squares solution. Nothing where the views are too frontal to tell.
std::optional<double> ClosedFormFocalLength(const std::vector<Eigen::Matrix3d>& homographies,
                                            const Eigen::Vector2d& principal_point) {
  double ab = 0.0;
  double aa = 0.0;
  Eigen::Matrix3d shift = Eigen::Matrix3d::Identity();
  shift.topRightCorner<2, 1>() = -principal_point;
  for (const Eigen::Matrix3d& H : homographies) {
    const Eigen::Matrix3d G = shift * H;
    const Eigen::Vector3d h1 = G.col(0);
    const Eigen::Vector3d h2 = G.col(1);
    // Scaled alike, so that no view outweighs the others.
    const double scale = 1.0 / (h1.head<2>().norm() * h2.head<2>().norm());
    const double a1 = scale * h1.head<2>().dot(h2.head<2>());
    const double b1 = scale * h1.z() * h2.z();
    const double a2 = 0.5 * scale * (h1.head<2>().squaredNorm() - h2.head<2>().squaredNorm());
    const double b2 = 0.5 * scale * (h1.z() * h1.z() - h2.z() * h2.z());
    aa += a1 * a1 + a2 * a2;
    ab += a1 * b1 + a2 * b2;
  }
  const double w = -ab / aa;
  if (!(w > 0.0) || !std::isfinite(w)) return std::nullopt;
  return 1.0 / std::sqrt(w);
}

std::optional<Rigid3> StartPose(const CameraModel& model, const BoardView& view,
                                const Eigen::Matrix3d& H) {
  const Eigen::Vector4d k = model.intrinsics();
  Eigen::Matrix3d K;
  K << k(0), 0.0, k(2), 0.0, k(1), k(3), 0.0, 0.0, 1.0;
  const auto T_c_g = PoseFromHomography(K.inverse() * H);
  if (!T_c_g || !ReprojectionResiduals(model, view, *T_c_g).allFinite()) return std::nullopt;
  return T_c_g;
}

}  // namespace

std::optional<StartValues> FindStartValues(const std::string& model_name, Resolution resolution,
                                           const std::vector<BoardView>& views,
                                           const Eigen::VectorXd& known) {
  std::vector<size_t> usable;
  std::vector<Eigen::Matrix3d> homographies;
  for (size_t v = 0; v < views.size(); ++v) {
    if (auto H = EstimateHomography(views[v].points_g.topRows<2>(), views[v].pixels)) {
      usable.push_back(v);
      homographies.push_back(*H);
    }
  }
  if (usable.empty()) return std::nullopt;

  Eigen::VectorXd parameters = Eigen::VectorXd::Zero(CameraModel::NumParameters(model_name));
  parameters(2) = 0.5 * (resolution.width - 1);
  parameters(3) = 0.5 * (resolution.height - 1);
  const auto with_focal_length = [&](double f) {
    parameters(0) = parameters(1) = f;
    for (Eigen::Index i = 0; i < known.size(); ++i) {
      if (!std::isnan(known(i))) parameters(i) = known(i);
    }
    return CameraModel(model_name, parameters);
  };

  std::vector<double> candidates;
  if (const auto f = ClosedFormFocalLength(homographies, parameters.segment<2>(2))) {
    candidates.push_back(*f);
  }
  // Horizontal fields of view from 127 down to 9 degrees.
  for (double f = 0.25 * resolution.width; f < 6.5 * resolution.width; f *= 1.35) {
    candidates.push_back(f);
  }

  const size_t stride = (usable.size() + kMaxTrialViews - 1) / kMaxTrialViews;
  double best_error = std::numeric_limits<double>::infinity();
  std::optional<CameraModel> best;
  for (const double f : candidates) {
    if (!(f > 0.05 * resolution.width && f < 100.0 * resolution.width)) continue;
    const CameraModel model = with_focal_length(f);
    double error = 0.0;
    for (size_t k = 0; k < usable.size(); k += stride) {
      const BoardView& view = views[usable[k]];
      const auto start = StartPose(model, view, homographies[k]);
      if (!start) {
        // A view that can't be started must cost more than any that can.
        error += static_cast<double>(view.num_corners()) * resolution.width * resolution.width;
        continue;
      }
      error +=
          ReprojectionResiduals(model, view, RefinedPose(model, view, *start, 5)).squaredNorm();
    }
    if (error < best_error) {
      best_error = error;
      best = model;
    }
  }
  if (!best) return std::nullopt;

  StartValues start{{*best, {}}, {}};
  for (size_t k = 0; k < usable.size(); ++k) {
    const BoardView& view = views[usable[k]];
    if (const auto T_c_g = StartPose(*best, view, homographies[k])) {
      start.state.T_c_g.push_back(RefinedPose(*best, view, *T_c_g, 5));
      start.used_views.push_back(usable[k]);
    }
  }
  if (start.used_views.empty()) return std::nullopt;
  return start;
}

}  // namespace calibrato
