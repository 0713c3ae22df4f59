#include "calibrato/calibration/start_values.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calibrato/base/parallel.h"
#include "calibrato/calibration/bundle_adjustment.h"
#include "calibrato/calibration/lens_twin.h"
#include "calibrato/calibration/outliers.h"
#include "calibrato/calibration/plane_pose.h"
#include "calibrato/calibration/view_fit.h"

namespace calibrato {
namespace {

// Enough views to tell lenses apart, and to estimate all parameters roughly.
constexpr size_t kMaxTrialViews = 12;
// Enough to rank lenses that are a third apart.
constexpr size_t kMaxRankingViews = 6;

// The undistorted lenses of a model, but for their size: what stands before fu, or (pinhole-fov)
// the distortion; and how much longer fu is than the focal length in the middle of the image.
struct LensShape {
  std::vector<double> parameters;
  double focal_over_central = 1.0;
};

std::vector<LensShape> ShapesOf(const std::string& model_name) {
  if (model_name.starts_with("omni-")) {
    return {{{0.5}, 1.5}, {{0.8}, 1.8}, {{1.1}, 2.1}, {{1.5}, 2.5}, {{2.0}, 3.0}};
  }
  if (model_name.starts_with("ds-")) {
    // Not xi = 0, where a small change of xi does what one of alpha and f does.
    return {{{-0.3, 0.6}, 0.7},
            {{-0.2, 0.5}, 0.8},
            {{-0.2, 0.3}, 0.8},
            {{0.3, 0.5}, 1.3},
            {{0.3, 0.65}, 1.3}};
  }
  if (model_name.starts_with("eucm-")) {
    return {{{0.25, 1.0}, 1.0}, {{0.5, 1.0}, 1.0}, {{0.64, 1.0}, 1.0}};
  }
  if (model_name == "pinhole-fov") return {{{0.3}}, {{0.9}}, {{1.5}}};
  return {{{}}};
}

// Whether a calibration with this model can have minima far apart (lens_twin.h).
bool HasTwins(const std::string& model_name) {
  return model_name == "ds-none" || model_name == "omni-radtan";
}

// The lens of one shape with a focal length in the middle of the image [px].
CameraModel LensOfShape(const std::string& model_name, Resolution resolution,
                        const LensShape& shape, double central_focal_length,
                        const Eigen::VectorXd& known) {
  const int focal = CameraModel::FocalIndex(model_name);
  Eigen::VectorXd parameters = Eigen::VectorXd::Zero(CameraModel::NumParameters(model_name));
  const int start = model_name == "pinhole-fov" ? focal + 4 : 0;
  for (size_t i = 0; i < shape.parameters.size(); ++i) {
    parameters(start + static_cast<int>(i)) = shape.parameters[i];
  }
  const double f = central_focal_length * shape.focal_over_central;
  parameters.segment<4>(focal) << f, f, 0.5 * (resolution.width - 1), 0.5 * (resolution.height - 1);
  for (Eigen::Index i = 0; i < known.size(); ++i) {
    if (!std::isnan(known(i))) parameters(i) = known(i);
  }
  return {model_name, parameters};
}

// From a focal length that squeezes 200 degrees of an equidistant lens into half the image's width,
// to a field of view of 4 degrees.
std::vector<CameraModel> LensesOfShape(const std::string& model_name, Resolution resolution,
                                       const LensShape& shape, const Eigen::VectorXd& known) {
  const int size = std::max(resolution.width, resolution.height);
  std::vector<CameraModel> lenses;
  for (double f = 0.145 * size; f < 15.0 * size; f *= 1.3) {
    lenses.push_back(LensOfShape(model_name, resolution, shape, f, known));
  }
  return lenses;
}

std::vector<const BoardView*> EvenlyChosen(const std::vector<BoardView>& views, size_t most) {
  std::vector<const BoardView*> chosen;
  const size_t count = std::min(views.size(), most);
  for (size_t k = 0; k < count; ++k) chosen.push_back(&views[k * views.size() / count]);
  return chosen;
}

// How badly a lens explains a view: the root mean square of its errors, at most `worst_px`, as
// which a corner that does not project counts too.
double ViewError(const CameraModel& lens, const BoardView& view, const ViewInliers& start,
                 double worst_px) {
  if (start.count() == 0) return worst_px;
  const Eigen::Matrix2Xd residuals = ReprojectionResiduals(lens, view, start.T_c_g);
  double sum = 0.0;
  for (Eigen::Index k = 0; k < residuals.cols(); ++k) {
    const double error = residuals.col(k).squaredNorm();
    sum += error < worst_px * worst_px ? error : worst_px * worst_px;
  }
  return std::sqrt(sum / static_cast<double>(view.num_corners()));
}

// The sum over views, each of which costs so little that wrong ones don't decide.
double TrialError(const CameraModel& lens, const std::vector<const BoardView*>& views,
                  double worst_px) {
  double sum = 0.0;
  for (const BoardView* view : views) {
    sum += ViewError(lens, *view, StartView(lens, *view, 2), worst_px);
  }
  return sum;
}

// What a lens is adjusted to: views, without the corners that do not project, and their poses.
struct StartedViews {
  std::vector<BoardView> views;
  std::vector<Rigid3> T_c_g;
};

double Adjust(const StartedViews& started, double loss_scale_px, int max_iterations,
              double cost_tolerance, const std::vector<bool>& fixed, BundleAdjustmentState* state) {
  state->T_c0_g = started.T_c_g;
  BundleAdjustmentOptions options;
  options.max_iterations = max_iterations;
  options.cost_tolerance = cost_tolerance;
  options.loss_scale_px = loss_scale_px;
  options.fixed_parameters = {fixed};
  BundleAdjustmentResult result = AdjustBundle(*state, ViewsOfOneCamera(started.views), options);
  *state = std::move(result.state);
  return result.cost_px2;
}

// A lens with what it leaves of the views that it was adjusted to.
struct Candidate {
  CameraModel lens;
  double error = 0.0;
};

Candidate AdjustedToTrial(const CameraModel& lens, const std::vector<const BoardView*>& views,
                          double worst_px, const std::vector<bool>& fixed) {
  std::vector<ViewInliers> starts;
  std::vector<double> errors;
  for (const BoardView* view : views) {
    starts.push_back(StartView(lens, *view));
    errors.push_back(ViewError(lens, *view, starts.back(), worst_px));
  }
  std::vector<double> sorted = errors;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  // Views without a pose, or with one far worse than the others', are left out.
  StartedViews started;
  for (size_t v = 0; v < views.size(); ++v) {
    if (starts[v].count() == 0 || !(errors[v] <= 3.0 * *middle + 1.0)) continue;
    started.views.push_back(InliersOf(*views[v], starts[v]));
    started.T_c_g.push_back(starts[v].T_c_g);
  }
  Candidate adjusted{lens, 0.0};
  if (started.views.size() >= 2) {
    BundleAdjustmentState state{{lens}, {}, {}, {}};
    (void)Adjust(started, std::max(1.0, 2.0 * *middle), 40, 1e-5, fixed, &state);
    adjusted.lens = state.models.front();
  }
  adjusted.error = TrialError(adjusted.lens, views, worst_px);
  return adjusted;
}

// The best lens of all shapes of the model, adjusted to the trial views.
Candidate BestCandidate(const std::string& model_name, Resolution resolution,
                        const std::vector<BoardView>& views, const Eigen::VectorXd& known,
                        const std::vector<bool>& fixed) {
  const std::vector<const BoardView*> trial = EvenlyChosen(views, kMaxTrialViews);
  const std::vector<const BoardView*> ranking = EvenlyChosen(views, kMaxRankingViews);
  const double worst_px = 0.1 * std::max(resolution.width, resolution.height);
  std::optional<Candidate> best;
  for (const LensShape& shape : ShapesOf(model_name)) {
    const std::vector<CameraModel> lenses = LensesOfShape(model_name, resolution, shape, known);
    const std::vector<double> errors = ParallelMap<double>(
        lenses.size(), [&](size_t i) { return TrialError(lenses[i], ranking, worst_px); });
    const auto least = std::min_element(errors.begin(), errors.end()) - errors.begin();
    const Candidate candidate =
        AdjustedToTrial(lenses[static_cast<size_t>(least)], trial, worst_px, fixed);
    if (!best || candidate.error < best->error) best = candidate;
  }
  return *best;
}

StartValues WithPoses(const CameraModel& lens, const std::vector<BoardView>& views) {
  return {lens, ParallelMap<ViewInliers>(views.size(),
                                         [&](size_t v) { return StartView(lens, views[v]); })};
}

int NumCorners(const StartValues& start) {
  int count = 0;
  for (const ViewInliers& view : start.views) count += view.count();
  return count;
}

// Adjusts to all that projects. Returns what is left of it, and of the rest [px^2].
double AdjustToAll(const std::vector<BoardView>& views, double loss_scale_px,
                   const std::vector<bool>& fixed, StartValues* start) {
  int num_corners = 0;
  for (const BoardView& view : views) num_corners += static_cast<int>(view.num_corners());
  double cost = 0.0;
  // Where the lens grows by it, more projects: a second time.
  for (int round = 0; round < 3; ++round) {
    StartedViews started;
    std::vector<size_t> indices;
    for (size_t v = 0; v < views.size(); ++v) {
      if (start->views[v].count() == 0) continue;
      indices.push_back(v);
      started.views.push_back(InliersOf(views[v], start->views[v]));
      started.T_c_g.push_back(start->views[v].T_c_g);
    }
    BundleAdjustmentState state{{start->model}, {}, {}, {}};
    cost = Adjust(started, loss_scale_px, 50, 1e-8, fixed, &state);
    start->model = state.models.front();
    for (size_t i = 0; i < indices.size(); ++i) {
      start->views[indices[i]].T_c_g = state.T_c0_g[i];
    }
    const int before = NumCorners(*start);
    if (before == num_corners) break;
    StartValues again = WithPoses(start->model, views);
    if (NumCorners(again) <= before) break;
    *start = std::move(again);
  }
  // What does not project is as bad as an error twice the loss's scale.
  return cost + 4.0 * loss_scale_px * loss_scale_px * (num_corners - NumCorners(*start));
}

// A model with twins (lens_twin.h), adjusted to all views.
struct Minimum {
  StartValues values;
  double cost_px2 = 0.0;
};

// The lowest. Twins of double spheres that fit as well but for noise (a cost of 9 sigma^2 more is
// one of 3 sigma) are not told apart by the data: of these, the one with the least |xi|, which is
// nearest to a lens without it. Not of omni-radtan, whose k1 and k2 do what xi does all the way
// from one minimum to the next.
const Minimum& BestMinimum(const std::vector<Minimum>& minima) {
  const auto lowest =
      std::min_element(minima.begin(), minima.end(),
                       [](const Minimum& a, const Minimum& b) { return a.cost_px2 < b.cost_px2; });
  if (lowest->values.model.name() != "ds-none") return *lowest;
  const double variance_px2 = lowest->cost_px2 / std::max(1, 2 * NumCorners(lowest->values));
  const Minimum* best = &*lowest;
  for (const Minimum& minimum : minima) {
    if (minimum.cost_px2 <= lowest->cost_px2 + 9.0 * variance_px2 &&
        std::abs(minimum.values.model.parameters()(0)) <
            std::abs(best->values.model.parameters()(0))) {
      best = &minimum;
    }
  }
  return *best;
}

}  // namespace

ViewInliers StartView(const CameraModel& model, const BoardView& view, int max_iterations) {
  ViewInliers start{{},
                    std::vector<bool>(static_cast<size_t>(view.num_corners()), false),
                    ViewRejection::kNoPose};
  if (view.num_corners() < kMinCorners) {
    start.reason = ViewRejection::kTooFewCorners;
    return start;
  }
  const auto T_c_g = PoseFromView(model, view);
  if (!T_c_g) return start;
  start.T_c_g = *T_c_g;
  const auto find_projected = [&] {
    const Eigen::Matrix2Xd residuals = ReprojectionResiduals(model, view, start.T_c_g);
    for (size_t k = 0; k < start.corners.size(); ++k) {
      start.corners[k] = residuals.col(static_cast<Eigen::Index>(k)).allFinite();
    }
    return 2 * start.count() >= view.num_corners() && start.count() >= kMinCorners;
  };
  if (find_projected()) {
    start.T_c_g = RefinedPose(model, InliersOf(view, start), start.T_c_g, max_iterations);
    if (find_projected()) return start;
  }
  start.corners.assign(start.corners.size(), false);
  return start;
}

std::optional<StartValues> FindStartValues(const std::string& model_name, Resolution resolution,
                                           const std::vector<BoardView>& views,
                                           const Eigen::VectorXd& known,
                                           const std::vector<bool>& fixed) {
  if (views.empty()) return std::nullopt;
  const Candidate candidate = BestCandidate(model_name, resolution, views, known, fixed);
  StartValues best = WithPoses(candidate.lens, views);
  if (HasTwins(model_name) && NumCorners(best) > 0) {
    const auto num_trial = static_cast<double>(std::min(views.size(), kMaxTrialViews));
    const double loss_scale_px = std::max(1.0, 2.0 * candidate.error / num_trial);
    std::vector<Minimum> minima = {{best, 0.0}};
    minima[0].cost_px2 = AdjustToAll(views, loss_scale_px, fixed, &minima[0].values);
    const CameraModel lens = minima[0].values.model;
    for (const LensShape& shape : ShapesOf(model_name)) {
      const auto twin = FindLensTwin(
          lens, resolution,
          LensOfShape(model_name, resolution, shape, CentralFocalLength(lens), known), fixed);
      if (!twin) continue;
      Minimum other{WithPoses(*twin, views), 0.0};
      if (NumCorners(other.values) == 0) continue;
      other.cost_px2 = AdjustToAll(views, loss_scale_px, fixed, &other.values);
      minima.push_back(std::move(other));
    }
    best = BestMinimum(minima).values;
  }
  if (NumCorners(best) == 0) return std::nullopt;
  return best;
}

}  // namespace calibrato
