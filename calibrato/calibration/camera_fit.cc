#include "calibrato/calibration/camera_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "calibrato/base/parallel.h"
#include "calibrato/calibration/bundle_adjustment.h"
#include "calibrato/calibration/information.h"
#include "calibrato/calibration/start_values.h"
#include "calibrato/calibration/view_fit.h"

namespace calibrato {
namespace {

constexpr int kMaxRounds = 10;

// Squared errors of all corners, with or without outliers, of the views that take part.
std::vector<double> SquaredErrors(const CameraModel& model, const std::vector<BoardView>& views,
                                  const std::vector<ViewInliers>& inliers) {
  std::vector<double> errors;
  for (size_t v = 0; v < views.size(); ++v) {
    if (inliers[v].count() == 0) continue;
    const Eigen::Matrix2Xd residuals = ReprojectionResiduals(model, views[v], inliers[v].T_c_g);
    for (Eigen::Index k = 0; k < residuals.cols(); ++k) {
      const double error = residuals.col(k).squaredNorm();
      errors.push_back(std::isnan(error) ? std::numeric_limits<double>::infinity() : error);
    }
  }
  return errors;
}

std::vector<ViewInliers> Judged(const CameraModel& model, const std::vector<BoardView>& views,
                                const std::vector<ViewInliers>& inliers, double threshold_px) {
  return ParallelMap<ViewInliers>(views.size(), [&](size_t v) {
    return JudgedView(model, views[v], inliers[v], threshold_px);
  });
}

bool SameCorners(const std::vector<ViewInliers>& a, const std::vector<ViewInliers>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), [](const ViewInliers& x, const ViewInliers& y) {
    return x.corners == y.corners;
  });
}

int NumUsed(const std::vector<ViewInliers>& views) {
  return static_cast<int>(std::count_if(views.begin(), views.end(),
                                        [](const ViewInliers& view) { return view.count() > 0; }));
}

// Too few views fit: no camera, but what became of each view.
CameraFit Failed(std::vector<ViewInliers> views) {
  return {Termination::kNoStart, std::nullopt, std::move(views), 0.0, std::nullopt};
}

// Adjusts the camera to the corners that take part.
void Adjust(const CameraProblem& problem, int max_iterations, double loss_scale_px,
            CameraFit* fit) {
  std::vector<BoardView> used;
  std::vector<size_t> indices;
  BundleAdjustmentState start{{*fit->model}, {}, {}, {}};
  for (size_t v = 0; v < problem.views.size(); ++v) {
    if (fit->views[v].count() == 0) continue;
    used.push_back(InliersOf(problem.views[v], fit->views[v]));
    indices.push_back(v);
    start.T_c0_g.push_back(fit->views[v].T_c_g);
  }
  BundleAdjustmentOptions options;
  options.max_iterations = max_iterations;
  options.fixed_parameters = {problem.fixed};
  options.loss_scale_px = loss_scale_px;
  if (loss_scale_px > 0.0) options.cost_tolerance = 1e-6;
  options.initial_damping = 1e-8;
  const BundleAdjustmentResult result = AdjustBundle(start, ViewsOfOneCamera(used), options);
  fit->termination = result.termination;
  fit->model = result.state.models.front();
  fit->squared_error_px2 = result.cost_px2;
  for (size_t i = 0; i < indices.size(); ++i) {
    fit->views[indices[i]].T_c_g = result.state.T_c0_g[i];
  }
}

// What is to be known of a fit in which nothing is held at its estimate.
FreeFit DescribedFreeFit(const CameraProblem& problem, const CameraFit& fit) {
  FreeFit described{fit.termination, {}};
  std::vector<BoardView> used;
  std::vector<Rigid3> T_c_g;
  double num_coordinates = 0.0;
  for (size_t v = 0; v < problem.views.size(); ++v) {
    if (fit.views[v].count() == 0) continue;
    used.push_back(InliersOf(problem.views[v], fit.views[v]));
    T_c_g.push_back(fit.views[v].T_c_g);
    num_coordinates += 2.0 * fit.views[v].count();
  }
  const auto num_unknowns =
      static_cast<double>(std::count(problem.fixed.begin(), problem.fixed.end(), false) +
                          6 * static_cast<std::ptrdiff_t>(used.size()));
  if (!(num_coordinates > num_unknowns)) return described;
  const auto covariance = CovarianceFromInformation(
      CameraInformation(*fit.model, T_c_g, used, problem.fixed), problem.fixed);
  if (!covariance) return described;
  const double variance_px2 = fit.squared_error_px2 / (num_coordinates - num_unknowns);
  described.sigmas = (variance_px2 * covariance->diagonal()).cwiseSqrt();
  return described;
}

// Once with these parameters free, then with them held at what came of it.
CameraFit FitHeldAtEstimate(CameraProblem problem, const std::vector<bool>& at_estimate,
                            int max_iterations) {
  const std::vector<bool> fixed = problem.fixed;
  for (size_t i = 0; i < fixed.size(); ++i) {
    if (at_estimate[i]) problem.fixed[i] = false;
  }
  const CameraFit free = FitCamera(problem, max_iterations);
  if (!free.model) return free;
  const FreeFit free_fit = DescribedFreeFit(problem, free);
  const Eigen::VectorXd parameters = free.model->parameters();
  for (size_t i = 0; i < fixed.size(); ++i) {
    const auto index = static_cast<Eigen::Index>(i);
    if (at_estimate[i]) problem.known(index) = parameters(index);
  }
  problem.fixed = fixed;
  CameraFit held = FitCamera(problem, max_iterations);
  held.free_fit = free_fit;
  return held;
}

void AddViewsThatDidNotFit(const CameraProblem& problem, const CameraFit& fit,
                           CameraCalibration* result) {
  for (size_t v = 0; v < fit.views.size(); ++v) {
    if (fit.views[v].count() > 0) continue;
    const BoardView& view = problem.views[v];
    result->rejected_views.push_back({view.name, fit.views[v].reason,
                                      static_cast<int>(view.num_corners()),
                                      std::numeric_limits<double>::quiet_NaN()});
  }
}

}  // namespace

int CameraFit::num_used_views() const { return NumUsed(views); }

CameraFit FitCamera(const CameraProblem& problem, int max_iterations) {
  const std::vector<bool> at_estimate = HeldAtTheirEstimate(problem);
  if (std::find(at_estimate.begin(), at_estimate.end(), true) != at_estimate.end()) {
    return FitHeldAtEstimate(problem, at_estimate, max_iterations);
  }
  CameraFit fit;
  const std::vector<BoardView>& views = problem.views;
  if (views.size() < static_cast<size_t>(kMinViews)) return fit;
  const auto start =
      FindStartValues(problem.model, problem.resolution, views, problem.known, problem.fixed);
  if (!start) return fit;
  if (NumUsed(start->views) < kMinViews) return Failed(start->views);
  fit.views = start->views;
  fit.model = start->model;

  if (problem.reject_outliers) {
    const std::vector<double> errors = SquaredErrors(*fit.model, views, fit.views);
    const double noise = NoiseFromMedian(errors);
    // Start values are rough: what is this far off is no matter of theirs, and would draw the fit
    // after it.
    const double gross = 20.0 * noise + 5.0;
    if (*std::max_element(errors.begin(), errors.end()) > gross * gross) {
      Adjust(problem, 30, 3.0 * noise, &fit);
      fit.views = Judged(*fit.model, views, fit.views, gross);
      if (fit.num_used_views() < kMinViews) return Failed(fit.views);
    }
  }
  for (int round = 1;; ++round) {
    Adjust(problem, max_iterations, 0.0, &fit);
    // The last round's judgement would not be adjusted to.
    if (!problem.reject_outliers || round == kMaxRounds) return fit;
    const double threshold = OutlierThreshold(SquaredErrors(*fit.model, views, fit.views));
    std::vector<ViewInliers> judged = Judged(*fit.model, views, fit.views, threshold);
    if (SameCorners(judged, fit.views)) return fit;
    if (NumUsed(judged) < kMinViews) return Failed(std::move(judged));
    fit.views = std::move(judged);
  }
}

CameraCalibration DescribedFit(const CameraProblem& problem, const CameraFit& fit) {
  CameraCalibration result;
  result.termination = fit.termination;
  if (!fit.model) {
    AddViewsThatDidNotFit(problem, fit, &result);
    return result;
  }
  result.model = fit.model;
  result.free_fit = fit.free_fit;
  double inlier_sum = 0.0;
  double all_sum = 0.0;
  int num_all = 0;
  for (size_t v = 0; v < problem.views.size(); ++v) {
    const BoardView& view = problem.views[v];
    const ViewInliers& inliers = fit.views[v];
    const bool used = inliers.count() > 0;
    const bool has_pose = used || inliers.reason == ViewRejection::kDoesNotFit;
    double view_sum = 0.0;
    int num_projected = 0;
    if (has_pose) {
      const Eigen::Matrix2Xd residuals = ReprojectionResiduals(*fit.model, view, inliers.T_c_g);
      Eigen::Matrix2Xd kept(2, inliers.count());
      Eigen::Index n = 0;
      for (Eigen::Index k = 0; k < residuals.cols(); ++k) {
        const Eigen::Vector2d residual = residuals.col(k);
        if (residual.allFinite()) {
          view_sum += residual.squaredNorm();
          ++num_projected;
        }
        if (inliers.corners[static_cast<size_t>(k)]) {
          kept.col(n++) = residual;
        } else if (used) {
          const int id = view.corner_ids.empty() ? static_cast<int>(k)
                                                 : view.corner_ids[static_cast<size_t>(k)];
          result.rejected_corners.push_back({view.name, id, view.pixels.col(k), residual});
        }
      }
      if (used) {
        inlier_sum += kept.squaredNorm();
        result.num_corners += static_cast<int>(kept.cols());
        result.used_views.push_back(InliersOf(view, inliers));
        result.used_view_indices.push_back(v);
        result.T_c_g.push_back(inliers.T_c_g);
        result.residuals.push_back(std::move(kept));
      }
      all_sum += view_sum;
      num_all += num_projected;
    }
    if (!used) {
      result.rejected_views.push_back({view.name, inliers.reason,
                                       static_cast<int>(view.num_corners()),
                                       std::sqrt(view_sum / num_projected)});
    }
  }
  result.coverage = CoverageOf(result.used_views, problem.resolution);
  result.reprojection_rms_px = std::sqrt(inlier_sum / result.num_corners);
  result.reprojection_rms_all_px = std::sqrt(all_sum / num_all);
  return result;
}

}  // namespace calibrato
