#include "calibrato/calibration/outliers.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "calibrato/calibration/plane_pose.h"
#include "calibrato/calibration/view_fit.h"

namespace calibrato {
namespace {

// Corners below the threshold, from one pose. NaN (does not project) is not below.
std::vector<bool> CornersBelow(const CameraModel& model, const BoardView& view, const Rigid3& T_c_g,
                               double threshold_px) {
  const Eigen::Matrix2Xd residuals = ReprojectionResiduals(model, view, T_c_g);
  std::vector<bool> below(static_cast<size_t>(view.num_corners()));
  for (size_t k = 0; k < below.size(); ++k) {
    below[k] = residuals.col(static_cast<Eigen::Index>(k)).norm() <= threshold_px;
  }
  return below;
}

// Robustly refined on the corners that project from the start.
Rigid3 RefinedOnVisible(const CameraModel& model, const BoardView& view, const Rigid3& start,
                        double loss_scale_px) {
  const ViewInliers visible{start, CornersBelow(model, view, start, 1e9), {}};
  return RefinedPose(model, InliersOf(view, visible), start, 20, loss_scale_px);
}

}  // namespace

double NoiseFromMedian(std::vector<double> squared_errors_px2) {
  if (squared_errors_px2.empty()) return 0.0;
  const auto middle = squared_errors_px2.begin() + squared_errors_px2.size() / 2;
  std::nth_element(squared_errors_px2.begin(), middle, squared_errors_px2.end());
  return std::sqrt(*middle / (2.0 * std::numbers::ln2));
}

double OutlierThreshold(std::vector<double> squared_errors_px2) {
  const double noise = NoiseFromMedian(squared_errors_px2);
  if (!(noise > 0.0)) return 1e-3;
  const auto num_errors = static_cast<double>(squared_errors_px2.size());
  // How long, in sigmas, the k-th longest error must be for all k to be outliers.
  const auto wanted = [num_errors](size_t k) {
    return std::sqrt(2.0 * std::log(num_errors / (kFalseDiscoveryRate * static_cast<double>(k))));
  };
  std::erase_if(squared_errors_px2, [noise](double squared) {
    return squared <= kOutlierSigmas * kOutlierSigmas * noise * noise;
  });
  std::sort(squared_errors_px2.begin(), squared_errors_px2.end());
  size_t num_outliers = squared_errors_px2.size();  // The shortest of them comes first.
  for (const double squared : squared_errors_px2) {
    if (std::sqrt(squared) >= wanted(num_outliers) * noise) break;
    --num_outliers;
  }
  const double limit = wanted(std::max<size_t>(1, num_outliers));
  return std::max(1e-3, noise * std::max(kOutlierSigmas, limit));
}

int ViewInliers::count() const {
  return static_cast<int>(std::count(corners.begin(), corners.end(), true));
}

BoardView InliersOf(const BoardView& view, const ViewInliers& inliers) {
  const int count = inliers.count();
  if (count == view.num_corners()) return view;
  BoardView kept{view.stamp, view.name, {}, Eigen::Matrix2Xd(2, count), Eigen::Matrix3Xd(3, count)};
  Eigen::Index n = 0;
  for (size_t k = 0; k < inliers.corners.size(); ++k) {
    if (!inliers.corners[k]) continue;
    if (!view.corner_ids.empty()) kept.corner_ids.push_back(view.corner_ids[k]);
    kept.pixels.col(n) = view.pixels.col(static_cast<Eigen::Index>(k));
    kept.points_g.col(n) = view.points_g.col(static_cast<Eigen::Index>(k));
    ++n;
  }
  return kept;
}

ViewInliers JudgedView(const CameraModel& model, const BoardView& view, const ViewInliers& before,
                       double threshold_px) {
  const int wanted = std::max(kMinCorners, static_cast<int>((view.num_corners() + 1) / 2));
  ViewInliers best = before;
  const bool had_pose = before.count() > 0;
  if (had_pose) {
    best.corners = CornersBelow(model, view, before.T_c_g, threshold_px);
    if (best.count() >= wanted) return best;
  }
  best.corners.assign(static_cast<size_t>(view.num_corners()), false);
  if (view.num_corners() < kMinCorners) {
    best.reason = ViewRejection::kTooFewCorners;
    return best;
  }
  std::vector<Rigid3> starts;
  if (had_pose) starts.push_back(before.T_c_g);
  if (const auto T_c_g = PoseFromView(model, view)) {
    starts.push_back(*T_c_g);
    starts.push_back(MirroredPose(*T_c_g, view.points_g.rowwise().mean()));
  }
  if (starts.empty()) {
    best.reason = ViewRejection::kNoPose;
    return best;
  }
  int most = -1;
  for (const Rigid3& start : starts) {
    const Rigid3 T_c_g = RefinedOnVisible(model, view, start, 0.5 * threshold_px);
    const std::vector<bool> corners = CornersBelow(model, view, T_c_g, threshold_px);
    const auto count = static_cast<int>(std::count(corners.begin(), corners.end(), true));
    if (count <= most) continue;
    most = count;
    best.T_c_g = T_c_g;
    best.corners = corners;
  }
  if (most < wanted) {
    best.corners.assign(best.corners.size(), false);
    best.reason = ViewRejection::kDoesNotFit;
  }
  return best;
}

}  // namespace calibrato
