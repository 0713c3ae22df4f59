#include "calibrato/calibration/rig_adjustment.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "calibrato/calibration/bundle_adjustment.h"
#include "calibrato/calibration/information.h"
#include "calibrato/calibration/view_fit.h"

namespace calibrato {
namespace {

constexpr int kMaxRounds = 5;
// A perfect fit must not weigh infinitely much.
constexpr double kLeastNoisePx = 1e-6;

// What the group's cameras saw, frame by frame, without outliers.
struct Observations {
  struct Source {
    size_t camera;  // its place in the group
    size_t view;    // its place in the camera's problem
  };
  std::vector<Source> sources;
  std::vector<BoardView> views;
  std::vector<BundleView> bundle;
};

class RigAdjuster {
 public:
  RigAdjuster(const CameraRigProblem& problem, const CameraGroup& group,
              std::vector<CameraFit>* fits)
      : problem_(problem), group_(group), frames_(problem.frame_of_view) {
    std::vector<const BoardView*> all_views;
    for (const int c : group.cameras) {
      const auto camera = static_cast<size_t>(c);
      fits_.push_back(&(*fits)[camera]);
      problems_.push_back(&problem.cameras[camera]);
      options_.fixed_parameters.push_back(problem.cameras[camera].fixed);
      if (!frames_[camera].empty()) next_frame_ = std::max(next_frame_, frames_[camera].back() + 1);
      for (const BoardView& view : problem.cameras[camera].views) all_views.push_back(&view);
    }
    if (!problem.estimate_bending) return;
    shapes_.emplace(all_views);
    options_.bending_shapes = &*shapes_;
  }

  RigAdjuster(const RigAdjuster&) = delete;
  RigAdjuster& operator=(const RigAdjuster&) = delete;

  RigAdjustment Run(int max_iterations) {
    Termination termination = Termination::kConverged;
    for (const CameraFit* fit : fits_) {
      if (fit->termination != Termination::kConverged) termination = fit->termination;
    }
    if (fits_.size() > 1 || problem_.estimate_bending) {
      if (fits_.size() > 1) {
        options_.noise_stddev_px = RmsOfCoordinates();
        // Frames that are not simultaneous must not draw the cameras apart.
        (void)Adjust(30, 3.0 * *std::max_element(options_.noise_stddev_px.begin(),
                                                 options_.noise_stddev_px.end()));
        (void)Judge();
      }
      // The last round's judgement would not be adjusted to.
      do {
        termination = Adjust(max_iterations, 0.0);
      } while (++num_rounds_ < kMaxRounds && Judge());
    }
    RigAdjustment result;
    result.termination = termination;
    result.group = group_;
    result.bending = bending_;
    result.num_separated_views = num_separated_;
    result.num_rounds = num_rounds_;
    AddCovariance(&result);
    return result;
  }

 private:
  Observations Collect() const {
    std::map<int, std::vector<Observations::Source>> by_frame;
    for (size_t k = 0; k < fits_.size(); ++k) {
      for (size_t v = 0; v < fits_[k]->views.size(); ++v) {
        if (fits_[k]->views[v].count() == 0) continue;
        by_frame[FrameOf(k, v)].push_back({k, v});
      }
    }
    Observations seen;
    int frame = 0;
    for (const auto& [number, sources] : by_frame) {
      for (const Observations::Source& source : sources) {
        seen.sources.push_back(source);
        seen.bundle.push_back({static_cast<int>(source.camera), frame, nullptr});
      }
      ++frame;
    }
    for (const auto& [k, v] : seen.sources) {
      seen.views.push_back(InliersOf(problems_[k]->views[v], fits_[k]->views[v]));
    }
    for (size_t i = 0; i < seen.bundle.size(); ++i) seen.bundle[i].view = &seen.views[i];
    return seen;
  }

  // Where a frame was seen by several cameras, the view with most corners places the board.
  BundleAdjustmentState State(const Observations& seen) const {
    BundleAdjustmentState state{{}, group_.T_cn_cnm1, {}, bending_};
    for (const CameraFit* fit : fits_) state.models.push_back(*fit->model);
    int most = 0;
    for (size_t i = 0; i < seen.sources.size(); ++i) {
      const auto& [k, v] = seen.sources[i];
      if (i == 0 || seen.bundle[i].frame != seen.bundle[i - 1].frame) {
        state.T_c0_g.emplace_back();
        most = 0;
      }
      if (fits_[k]->views[v].count() <= most) continue;
      most = fits_[k]->views[v].count();
      state.T_c0_g.back() = state.T_cn_c0(static_cast<int>(k)).Inverse() * fits_[k]->views[v].T_c_g;
    }
    return state;
  }

  // A view in which a corner does not project from the frame's pose becomes a frame of its own.
  bool SeparateInvisible(const Observations& seen, const BundleAdjustmentState& state) {
    bool separated = false;
    for (size_t i = 0; i < seen.sources.size(); ++i) {
      const Rigid3 T_cn_g = state.T_cn_c0(seen.bundle[i].camera) *
                            state.T_c0_g[static_cast<size_t>(seen.bundle[i].frame)];
      const CameraModel& model = state.models[static_cast<size_t>(seen.bundle[i].camera)];
      if (ReprojectionResiduals(model, seen.views[i], T_cn_g).allFinite()) continue;
      Separate(seen.sources[i]);
      separated = true;
    }
    return separated;
  }

  void Separate(const Observations::Source& source) {
    frames_[static_cast<size_t>(group_.cameras[source.camera])][source.view] = next_frame_++;
    ++num_separated_;
  }

  // The models, relations, bending and poses that fit best.
  Termination Adjust(int max_iterations, double loss_scale_px) {
    Observations seen = Collect();
    BundleAdjustmentState start = State(seen);
    if (fits_.size() > 1 && SeparateInvisible(seen, start)) {
      seen = Collect();
      start = State(seen);
    }
    BundleAdjustmentOptions options = options_;
    options.max_iterations = max_iterations;
    options.loss_scale_px = loss_scale_px;
    if (loss_scale_px > 0.0) options.cost_tolerance = 1e-6;
    options.initial_damping = 1e-8;
    const BundleAdjustmentResult adjusted = AdjustBundle(start, seen.bundle, options);
    group_.T_cn_cnm1 = adjusted.state.T_cn_cnm1;
    bending_ = adjusted.state.bending;
    for (size_t k = 0; k < fits_.size(); ++k) fits_[k]->model = adjusted.state.models[k];
    T_c0_g_.clear();
    for (size_t i = 0; i < seen.sources.size(); ++i) {
      const auto& [k, v] = seen.sources[i];
      const Rigid3& T_c0_g = adjusted.state.T_c0_g[static_cast<size_t>(seen.bundle[i].frame)];
      fits_[k]->views[v].T_c_g = adjusted.state.T_cn_c0(static_cast<int>(k)) * T_c0_g;
      T_c0_g_[FrameOf(k, v)] = T_c0_g;
    }
    return adjusted.termination;
  }

  BoardView Bent(size_t k, size_t v) const {
    const BoardView& view = problems_[k]->views[v];
    return shapes_ ? shapes_->Bent(view, bending_) : view;
  }

  int FrameOf(size_t k, size_t v) const {
    return frames_[static_cast<size_t>(group_.cameras[k])][v];
  }

  double Threshold(size_t k) const {
    std::vector<double> errors;
    for (size_t v = 0; v < fits_[k]->views.size(); ++v) {
      if (fits_[k]->views[v].count() == 0) continue;
      const Eigen::Matrix2Xd residuals =
          ReprojectionResiduals(*fits_[k]->model, Bent(k, v), fits_[k]->views[v].T_c_g);
      for (Eigen::Index i = 0; i < residuals.cols(); ++i) {
        const double error = residuals.col(i).squaredNorm();
        errors.push_back(std::isnan(error) ? HUGE_VAL : error);
      }
    }
    return OutlierThreshold(std::move(errors));
  }

  // A view to be judged: as it is, or, where it was left out though it has a pose, at that of its
  // frame.
  ViewInliers AtItsFrame(size_t k, size_t v) const {
    ViewInliers view = fits_[k]->views[v];
    if (view.count() > 0 || view.reason != ViewRejection::kDoesNotFit) return view;
    const auto T_c0_g = T_c0_g_.find(FrameOf(k, v));
    if (T_c0_g == T_c0_g_.end()) return view;
    view.T_c_g = group_.T_to_from(k, 0) * T_c0_g->second;
    view.corners.assign(view.corners.size(), true);
    return view;
  }

  // Leaves out what does not fit, takes back what does, and separates views that fit from another
  // pose than that of their frame's others. Whether any of this was needed.
  bool Judge() {
    std::map<int, int> num_used;
    for (size_t k = 0; k < fits_.size(); ++k) {
      for (size_t v = 0; v < fits_[k]->views.size(); ++v) {
        if (fits_[k]->views[v].count() > 0) ++num_used[FrameOf(k, v)];
      }
    }
    bool changed = false;
    for (size_t k = 0; k < fits_.size(); ++k) {
      if (!problems_[k]->reject_outliers) continue;
      const double threshold = Threshold(k);
      for (size_t v = 0; v < fits_[k]->views.size(); ++v) {
        ViewInliers& view = fits_[k]->views[v];
        const ViewInliers before = AtItsFrame(k, v);
        ViewInliers judged = JudgedView(*fits_[k]->model, Bent(k, v), before, threshold);
        const bool moved = judged.count() > 0 && judged.T_c_g.t != before.T_c_g.t;
        changed = changed || moved || judged.corners != view.corners;
        int& num_in_frame = num_used[FrameOf(k, v)];
        if (view.count() > 0) --num_in_frame;
        view = std::move(judged);
        if (moved && num_in_frame > 0) {
          Separate({k, v});
        } else if (view.count() > 0) {
          ++num_in_frame;
        }
      }
    }
    return changed;
  }

  // The root mean square of each camera's coordinates' errors [px].
  std::vector<double> RmsOfCoordinates() const {
    std::vector<double> rms;
    for (size_t k = 0; k < fits_.size(); ++k) {
      double sum = 0.0;
      double count = 0.0;
      for (size_t v = 0; v < fits_[k]->views.size(); ++v) {
        const ViewInliers& view = fits_[k]->views[v];
        if (view.count() == 0) continue;
        sum += ReprojectionResiduals(*fits_[k]->model, InliersOf(Bent(k, v), view), view.T_c_g)
                   .squaredNorm();
        count += 2.0 * view.count();
      }
      rms.push_back(std::max(kLeastNoisePx, std::sqrt(sum / count)));
    }
    return rms;
  }

  void AddCovariance(RigAdjustment* result) {
    const Observations seen = Collect();
    const BundleAdjustmentState state = State(seen);
    BundleAdjustmentOptions options = options_;
    options.noise_stddev_px = RmsOfCoordinates();
    const BorderLayout layout(state.models, options.bending_shapes != nullptr);
    std::vector<bool> fixed(static_cast<size_t>(layout.size), false);
    double num_coordinates = 0.0;
    for (const BoardView& view : seen.views) {
      num_coordinates += 2.0 * static_cast<double>(view.num_corners());
    }
    int num_unknowns = layout.size + 6 * static_cast<int>(state.T_c0_g.size());
    for (size_t k = 0; k < options.fixed_parameters.size(); ++k) {
      for (size_t i = 0; i < options.fixed_parameters[k].size(); ++i) {
        if (!options.fixed_parameters[k][i]) continue;
        fixed[static_cast<size_t>(layout.parameters[k]) + i] = true;
        --num_unknowns;
      }
    }
    if (!(num_coordinates > num_unknowns)) {
      result->termination = Termination::kRankDeficient;
      return;
    }
    // Errors shrink by the unknowns that were fitted to them; all cameras' by the same share.
    const double shrinkage = num_coordinates / (num_coordinates - num_unknowns);
    for (const double rms : options.noise_stddev_px) {
      result->noise_stddev_px.push_back(rms * std::sqrt(shrinkage));
    }
    const auto covariance =
        CovarianceFromInformation(BorderInformation(state, seen.bundle, options), fixed);
    if (covariance) {
      result->covariance = shrinkage * *covariance;
    } else {
      result->termination = Termination::kRankDeficient;
    }
  }

  const CameraRigProblem& problem_;
  CameraGroup group_;
  std::vector<std::vector<int>> frames_;  // [camera of the problem][view]
  int next_frame_ = 0;
  int num_separated_ = 0;
  int num_rounds_ = 0;
  std::map<int, Rigid3> T_c0_g_;                // By the number of the frame, as last adjusted.
  std::vector<CameraFit*> fits_;                // of the group
  std::vector<const CameraProblem*> problems_;  // of the group
  std::optional<BendingShapes> shapes_;
  BundleAdjustmentOptions options_;
  BoardBending bending_;
};

}  // namespace

RigAdjustment AdjustRig(const CameraRigProblem& problem, const CameraGroup& group,
                        int max_iterations, std::vector<CameraFit>* fits) {
  return RigAdjuster(problem, group, fits).Run(max_iterations);
}

}  // namespace calibrato
