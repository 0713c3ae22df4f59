#include "calibrato/mdp/one_look.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "calibrato/calibration/plane_pose.h"
#include "calibrato/calibration/view_fit.h"
#include "calibrato/motion/carrier.h"

namespace calibrato {
namespace {

constexpr int kMaxIterations = 30;

// Infinity where a corner does not project.
double SumOfSquares(const CameraModel& model, const BoardView& view, const Rigid3& T_c_g) {
  const double sum = ReprojectionResiduals(model, view, T_c_g).squaredNorm();
  return std::isfinite(sum) ? sum : std::numeric_limits<double>::infinity();
}

}  // namespace

std::optional<OneLook> LookAtBoard(const CameraModel& model, const BoardView& view) {
  const std::optional<Rigid3> start = PoseFromView(model, view);
  if (!start) return std::nullopt;
  const Eigen::Vector3d middle_g = view.points_g.rowwise().mean();
  OneLook look;
  double least = std::numeric_limits<double>::infinity();
  const Rigid3 first = RefinedPose(model, view, *start, kMaxIterations);
  for (const Rigid3& from : {first, MirroredPose(first, middle_g)}) {
    const Rigid3 pose = RefinedPose(model, view, from, kMaxIterations);
    const double sum = SumOfSquares(model, view, pose);
    if (!(sum < least)) continue;
    least = sum;
    look.T_c0_g = pose;
  }
  ViewRowsOptions pose_alone;
  pose_alone.parameters = false;
  ViewRows rows;
  if (!std::isfinite(least) || !LineariseView(model, view, look.T_c0_g, pose_alone, &rows)) {
    return std::nullopt;
  }
  look.num_corners = static_cast<int>(view.num_corners());
  look.reprojection_rms_px = std::sqrt(least / look.num_corners);
  const auto J = rows.rows.leftCols<6>();
  const Eigen::LLT<Eigen::Matrix<double, 6, 6>> information(J.transpose() * J);
  if (information.info() != Eigen::Success) return std::nullopt;
  const int num_residuals = 2 * look.num_corners;
  const double noise_px = std::sqrt(least / std::max(1, num_residuals - 6));
  const Eigen::Matrix<double, 6, 6> covariance =
      information.solve(Eigen::Matrix<double, 6, 6>::Identity());
  look.rotation_sigma_rad = noise_px * std::sqrt(covariance.diagonal().head<3>().sum());
  look.translation_sigma_m = noise_px * std::sqrt(covariance.diagonal().tail<3>().sum());
  return look;
}

Rig WithBoardAsSeen(Rig rig, const Rigid3& T_b_e, const Rigid3& T_c0_g) {
  rig.T_w_g = ArmBaseInWorld() * T_b_e * rig.T_e_c0 * T_c0_g;
  return rig;
}

}  // namespace calibrato
