#include "calibrato/calibration/bundle_adjustment.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <type_traits>
#include <utility>
#include <variant>

#include "calibrato/base/parallel.h"
#include "calibrato/calibration/view_fit.h"
#include "calibrato/geometry/so3.h"

namespace calibrato {
namespace {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

// Frames are worked on in chunks: below kFramesWorthThreads a parallel loop costs more than it
// saves. Neither number depends on the threads, so sums over chunks don't either.
constexpr size_t kFramesAChunk = 16;
constexpr size_t kFramesWorthThreads = 64;

constexpr double kLeastDamping = 1e-14;
constexpr double kFirstGrowth = 2.0;  // of the damping, when a step is refused; doubled each time

void ForEachChunk(size_t num_frames,
                  const std::function<void(size_t chunk, size_t begin, size_t end)>& body) {
  const size_t num_chunks = (num_frames + kFramesAChunk - 1) / kFramesAChunk;
  const auto run = [&](size_t chunk) {
    body(chunk, chunk * kFramesAChunk, std::min(num_frames, (chunk + 1) * kFramesAChunk));
  };
  if (num_frames < kFramesWorthThreads) {
    for (size_t chunk = 0; chunk < num_chunks; ++chunk) run(chunk);
  } else {
    ParallelFor(num_chunks, run);
  }
}

// J' J of a matrix with few columns: its lower triangle.
void Square(const Eigen::MatrixXd& J, Eigen::MatrixXd* product) {
  const Eigen::Index n = J.cols();
  product->resize(n, n);
  for (Eigen::Index j = 0; j < n; ++j) {
    for (Eigen::Index i = j; i < n; ++i) (*product)(i, j) = J.col(i).dot(J.col(j));
  }
}

// Eliminates the first unknowns of normal equations given by their lower triangle: leaves
// the first columns of the Cholesky factor, and below and right of them what the others are left
// with. False unless the eliminated block is positive definite.
bool EliminateLeading(Eigen::Index count, Eigen::MatrixXd* normal) {
  Eigen::MatrixXd& N = *normal;
  const Eigen::Index n = N.rows();
  const Eigen::VectorXd scale = N.diagonal().head(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    if (!(N(i, i) > 1e-15 * scale(i))) return false;
    N.col(i).tail(n - i) *= 1.0 / std::sqrt(N(i, i));
    for (Eigen::Index j = i + 1; j < n; ++j) {
      N.col(j).tail(n - j) -= N(j, i) * N.col(i).tail(n - j);
    }
  }
  return true;
}

// The other way: x holds the unknowns that were not eliminated, and gets those that were, such that
// the eliminated rows of [normal] x are zero.
void SubstituteLeading(Eigen::Index count, const Eigen::MatrixXd& factor, Eigen::VectorXd* x) {
  for (Eigen::Index i = count - 1; i >= 0; --i) {
    const Eigen::Index rest = factor.rows() - 1 - i;
    (*x)(i) = -factor.col(i).tail(rest).dot(x->tail(rest)) / factor(i, i);
  }
}

// Normal equations of every frame over [pose 6 | border | residual 1], at one state: their lower
// triangles. With the unknowns x = [pose step | border step | 1], the frame's cost is x' N x.
struct Linearisation {
  std::vector<Eigen::MatrixXd> normals;
  double cost_px2 = 0.0;
};

// The model with other parameters; nothing where no lens has such.
std::optional<CameraModel> WithParameters(const CameraModel& model,
                                          const Eigen::VectorXd& parameters) {
  const bool valid = std::visit(
      [&](const auto& m) { return AreValidParameters<std::decay_t<decltype(m)>>(parameters); },
      model.variant());
  if (!valid) return std::nullopt;
  return CameraModel(model.name(), parameters);
}

class Adjuster {
 public:
  Adjuster(const BundleAdjustmentState& state, const std::vector<BundleView>& views,
           const BundleAdjustmentOptions& options)
      : views_(views),
        options_(options),
        layout_(state.models, options.bending_shapes != nullptr),
        free_(Eigen::VectorXd::Ones(layout_.size)),
        factors_(state.T_c0_g.size()) {
    for (size_t v = 0; v < views.size(); ++v) {
      while (static_cast<int>(first_view_.size()) <= views[v].frame) first_view_.push_back(v);
    }
    first_view_.push_back(views.size());
    assert(first_view_.size() == state.T_c0_g.size() + 1);
    for (size_t c = 0; c < options.fixed_parameters.size(); ++c) {
      const std::vector<bool>& fixed = options.fixed_parameters[c];
      for (size_t i = 0; i < fixed.size(); ++i) {
        if (fixed[i]) free_(layout_.parameters[c] + static_cast<int>(i)) = 0.0;
      }
    }
  }

  size_t num_frames() const { return factors_.size(); }
  const BorderLayout& layout() const { return layout_; }

  // False where a corner does not project.
  bool Linearise(const BundleAdjustmentState& state, Linearisation* at) const {
    at->normals.resize(num_frames());
    std::vector<Rigid3> T_cn_c0;
    for (size_t c = 0; c < state.models.size(); ++c) {
      T_cn_c0.push_back(state.T_cn_c0(static_cast<int>(c)));
    }
    std::vector<double> costs((num_frames() + kFramesAChunk - 1) / kFramesAChunk, 0.0);
    std::vector<char> projects(costs.size(), 1);
    ForEachChunk(num_frames(), [&](size_t chunk, size_t begin, size_t end) {
      ViewRows rows;
      for (size_t f = begin; f < end && projects[chunk] != 0; ++f) {
        if (!LineariseFrame(state, T_cn_c0, f, &rows, &at->normals[f], &costs[chunk])) {
          projects[chunk] = 0;
        }
      }
    });
    at->cost_px2 = 0.0;
    for (const double cost : costs) at->cost_px2 += cost;
    return std::find(projects.begin(), projects.end(), 0) == projects.end();
  }

  struct Step {
    Eigen::VectorXd border;  // and a 1 behind it
    std::vector<Vector6d> poses;
    double promised_decrease = 0.0;
  };

  // The damped step; nothing where the reduced system is not positive definite.
  std::optional<Step> Solve(const Linearisation& at, double damping) {
    const Eigen::Index n = layout_.size;
    auto reduced = Reduced(at, damping);
    if (!reduced) return std::nullopt;
    // Fixed parameters become equations of their own: 1 * step = 0.
    for (Eigen::Index i = 0; i < n; ++i) {
      if (free_(i) != 0.0) continue;
      reduced->row(i).setZero();
      reduced->col(i).setZero();
      (*reduced)(i, i) = 1.0;
    }
    if (!EliminateLeading(n, &*reduced)) return std::nullopt;
    Step step{Eigen::VectorXd::Ones(n + 1), std::vector<Vector6d>(num_frames()), 0.0};
    SubstituteLeading(n, *reduced, &step.border);
    if (!step.border.allFinite()) return std::nullopt;
    // With (H + damping D) x = -g, the linearised problem falls by -g x + damping x' D x.
    std::vector<double> decreases((num_frames() + kFramesAChunk - 1) / kFramesAChunk, 0.0);
    ForEachChunk(num_frames(), [&](size_t chunk, size_t begin, size_t end) {
      Eigen::VectorXd x(6 + n + 1);
      for (size_t f = begin; f < end; ++f) {
        const Eigen::MatrixXd& normal = at.normals[f];
        x.tail(n + 1) = step.border;
        SubstituteLeading(6, factors_[f], &x);
        step.poses[f] = x.head<6>();
        for (Eigen::Index i = 0; i < 6 + n; ++i) {
          decreases[chunk] += x(i) * (damping * normal(i, i) * x(i) - normal(6 + n, i));
        }
      }
    });
    for (const double decrease : decreases) step.promised_decrease += decrease;
    return step;
  }

  // The undamped information about the border.
  Eigen::MatrixXd Information(const Linearisation& at) {
    const Eigen::Index n = layout_.size;
    const auto reduced = Reduced(at, 0.0);
    Eigen::MatrixXd information = Eigen::MatrixXd::Zero(n, n);
    if (!reduced) return information;
    for (Eigen::Index j = 0; j < n; ++j) {
      for (Eigen::Index i = j; i < n; ++i) {
        information(i, j) = information(j, i) = free_(i) * free_(j) * (*reduced)(i, j);
      }
    }
    return information;
  }

  std::vector<FramePose> Poses(const Linearisation& at) {
    const Eigen::Index n = layout_.size;
    std::vector<FramePose> poses(num_frames());
    [[maybe_unused]] const auto reduced = Reduced(at, 0.0);
    assert(reduced);
    for (size_t f = 0; f < num_frames(); ++f) {
      const Matrix6d L = factors_[f].topLeftCorner<6, 6>();
      const Matrix6d L_inverse = L.triangularView<Eigen::Lower>().solve(Matrix6d::Identity());
      poses[f].conditional_covariance = L_inverse.transpose().lazyProduct(L_inverse);
      poses[f].by_border.setZero(6, n);
      for (Eigen::Index i = 0; i < n; ++i) {
        if (free_(i) == 0.0) continue;
        Eigen::VectorXd x = Eigen::VectorXd::Unit(6 + n + 1, 6 + i);
        SubstituteLeading(6, factors_[f], &x);
        poses[f].by_border.col(i) = x.head<6>();
      }
    }
    return poses;
  }

  // The state that a step leads to; nothing where no lens has such parameters.
  std::optional<BundleAdjustmentState> Stepped(const BundleAdjustmentState& state,
                                               const Step& step) const {
    BundleAdjustmentState next = state;
    for (size_t c = 0; c < state.models.size(); ++c) {
      const CameraModel& model = state.models[c];
      const Eigen::VectorXd parameters =
          model.parameters() + step.border.segment(layout_.parameters[c], model.num_parameters());
      auto stepped = WithParameters(model, parameters);
      if (!stepped) return std::nullopt;
      next.models[c] = std::move(*stepped);
      if (c > 0) {
        next.T_cn_cnm1[c - 1] =
            state.T_cn_cnm1[c - 1].Perturbed(step.border.segment<6>(layout_.chain[c]));
      }
    }
    for (size_t f = 0; f < num_frames(); ++f) {
      next.T_c0_g[f] = state.T_c0_g[f].Perturbed(step.poses[f]);
    }
    if (layout_.bending >= 0) {
      next.bending.coefficients += step.border.segment<3>(layout_.bending);
    }
    return next;
  }

 private:
  bool LineariseFrame(const BundleAdjustmentState& state, const std::vector<Rigid3>& T_cn_c0,
                      size_t frame, ViewRows* rows, Eigen::MatrixXd* normal, double* cost) const {
    ViewRowsOptions options;
    options.shapes = options_.bending_shapes;
    options.bending = state.bending;
    options.loss_scale_px = options_.loss_scale_px;
    // One camera's rows have the columns that the frame has.
    const bool alone = state.models.size() == 1;
    const Eigen::Index size = 6 + layout_.size + 1;
    if (!alone) normal->setZero(size, size);
    Eigen::MatrixXd frame_rows;
    Eigen::MatrixXd view_normal;
    for (size_t v = first_view_[frame]; v < first_view_[frame + 1]; ++v) {
      const auto camera = static_cast<size_t>(views_[v].camera);
      const Rigid3 T_cn_g = T_cn_c0[camera] * state.T_c0_g[frame];
      if (!LineariseView(state.models[camera], *views_[v].view, T_cn_g, options, rows)) {
        return false;
      }
      if (!options_.noise_stddev_px.empty()) {
        const double weight = 1.0 / options_.noise_stddev_px[camera];
        rows->rows *= weight;
        rows->cost_px2 *= weight * weight;
      }
      *cost += rows->cost_px2;
      if (alone) {
        Square(rows->rows, normal);
      } else {
        FrameRows(state, T_cn_c0, frame, camera, rows->rows, &frame_rows);
        Square(frame_rows, &view_normal);
        *normal += view_normal;
      }
    }
    return true;
  }

  // A view's rows, of columns [pose of its camera | parameters | bending | residual], as they
  // depend on the frame's [pose of camera 0 | border | residual].
  void FrameRows(const BundleAdjustmentState& state, const std::vector<Rigid3>& T_cn_c0,
                 size_t frame, size_t camera, const Eigen::MatrixXd& view_rows,
                 Eigen::MatrixXd* rows) const {
    const int num_parameters = state.models[camera].num_parameters();
    const Eigen::Index last = 6 + layout_.size;
    const auto pose = view_rows.leftCols<6>();
    rows->setZero(view_rows.rows(), last + 1);
    rows->leftCols<6>() = pose.lazyProduct(JacobianProductSecond(T_cn_c0[camera]));
    for (size_t link = 1; link <= camera; ++link) {
      // T_cn_g = T_cn_ck * T_ck_ckm1 * T_ckm1_g
      const Rigid3 T_cn_ck = T_cn_c0[camera] * T_cn_c0[link].Inverse();
      const Rigid3 T_ckm1_g = T_cn_c0[link - 1] * state.T_c0_g[frame];
      const Matrix6d by_link = JacobianProductSecond(T_cn_ck).lazyProduct(
          JacobianProductFirst(state.T_cn_cnm1[link - 1], T_ckm1_g));
      rows->middleCols<6>(6 + layout_.chain[link]) = pose.lazyProduct(by_link);
    }
    rows->middleCols(6 + layout_.parameters[camera], num_parameters) =
        view_rows.middleCols(6, num_parameters);
    if (layout_.bending >= 0) {
      rows->middleCols<3>(6 + layout_.bending) = view_rows.middleCols<3>(6 + num_parameters);
    }
    rows->col(last) = view_rows.col(view_rows.cols() - 1);
  }

  // The normal equations of [border | residual 1], once all poses are eliminated: their lower
  // triangle. Nothing if a pose is undetermined.
  std::optional<Eigen::MatrixXd> Reduced(const Linearisation& at, double damping) {
    const Eigen::Index n = layout_.size;
    const size_t num_chunks = (num_frames() + kFramesAChunk - 1) / kFramesAChunk;
    std::vector<Eigen::MatrixXd> sums(num_chunks);
    std::vector<char> determined(num_chunks, 1);
    ForEachChunk(num_frames(), [&](size_t chunk, size_t begin, size_t end) {
      sums[chunk].setZero(n + 1, n + 1);
      for (size_t f = begin; f < end; ++f) {
        Eigen::MatrixXd& factor = factors_[f];
        factor = at.normals[f];
        factor.diagonal().head(6 + n) *= 1.0 + damping;
        if (!EliminateLeading(6, &factor)) determined[chunk] = 0;
        sums[chunk] += factor.bottomRightCorner(n + 1, n + 1);
      }
    });
    if (std::find(determined.begin(), determined.end(), 0) != determined.end()) {
      return std::nullopt;
    }
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(n + 1, n + 1);
    for (const Eigen::MatrixXd& part : sums) sum += part;
    return sum;
  }

  const std::vector<BundleView>& views_;
  const BundleAdjustmentOptions& options_;
  BorderLayout layout_;
  Eigen::VectorXd free_;                  // 1 for free parameters, 0 for fixed ones
  std::vector<size_t> first_view_;        // of each frame, and one past the last
  std::vector<Eigen::MatrixXd> factors_;  // of each frame, its pose eliminated
};

Linearisation LinearisationAt(const Adjuster& adjuster, const BundleAdjustmentState& state) {
  Linearisation at;
  [[maybe_unused]] const bool projects = adjuster.Linearise(state, &at);
  assert(projects);
  return at;
}

}  // namespace

std::vector<BundleView> ViewsOfOneCamera(const std::vector<BoardView>& views) {
  std::vector<BundleView> result;
  for (size_t v = 0; v < views.size(); ++v) result.push_back({0, static_cast<int>(v), &views[v]});
  return result;
}

Rigid3 BundleAdjustmentState::T_cn_c0(int camera) const {
  Rigid3 T;
  for (int n = 0; n < camera; ++n) T = T_cn_cnm1[static_cast<size_t>(n)] * T;
  return T;
}

BorderLayout::BorderLayout(const std::vector<CameraModel>& models, bool estimate_bending) {
  for (size_t c = 0; c < models.size(); ++c) {
    parameters.push_back(size);
    size += models[c].num_parameters();
    chain.push_back(c == 0 ? -1 : size);
    if (c > 0) size += 6;
  }
  if (estimate_bending) {
    bending = size;
    size += 3;
  }
}

std::vector<std::string> BorderNames(const std::vector<CameraModel>& models,
                                     bool estimate_bending) {
  std::vector<std::string> names;
  for (size_t c = 0; c < models.size(); ++c) {
    const std::string camera = "cam" + std::to_string(c) + ".";
    for (const std::string& name : CameraModel::ParameterNames(models[c].name())) {
      names.push_back(camera + name);
    }
    if (c == 0) continue;
    for (const char* name : {"rot_x", "rot_y", "rot_z", "pos_x", "pos_y", "pos_z"}) {
      names.push_back(camera + name);
    }
  }
  if (estimate_bending) {
    for (const char* name : {"xx", "xy", "yy"})
      names.push_back("board.bending_" + std::string(name));
  }
  return names;
}

BundleAdjustmentResult AdjustBundle(const BundleAdjustmentState& start,
                                    const std::vector<BundleView>& views,
                                    const BundleAdjustmentOptions& options) {
  Adjuster adjuster(start, views, options);
  BundleAdjustmentResult result{start, Termination::kIterationLimit, 0, 0.0};
  BundleAdjustmentState& state = result.state;
  Linearisation at = LinearisationAt(adjuster, state);
  Linearisation next_at;
  double damping = options.initial_damping;
  double growth = kFirstGrowth;
  while (result.num_iterations < options.max_iterations) {
    ++result.num_iterations;
    const auto step = adjuster.Solve(at, damping);
    if (step && !(step->promised_decrease > options.cost_tolerance * at.cost_px2)) {
      // In a long flat valley it may be the damping that keeps the promise small.
      if (growth == kFirstGrowth && damping > kLeastDamping) {
        damping = std::max(kLeastDamping, 1e-4 * damping);
        continue;
      }
      result.termination = Termination::kConverged;
      break;
    }
    std::optional<BundleAdjustmentState> next;
    if (step) next = adjuster.Stepped(state, *step);
    if (next && adjuster.Linearise(*next, &next_at) && next_at.cost_px2 < at.cost_px2) {
      // Nielsen's rule: trust the model as far as it was right.
      const double gain = (at.cost_px2 - next_at.cost_px2) / step->promised_decrease;
      damping =
          std::max(kLeastDamping, damping * std::max(0.1, 1.0 - std::pow(2.0 * gain - 1.0, 3)));
      growth = kFirstGrowth;
      state = std::move(*next);
      std::swap(at, next_at);
    } else {
      damping *= growth;
      growth *= 2.0;
      if (damping > 1e12) {
        // Not even a tiny step along the gradient helps: this is the minimum to within rounding.
        result.termination = Termination::kConverged;
        break;
      }
    }
  }
  // A rotation that was multiplied a hundred times is a rotation no more.
  for (Rigid3& T : state.T_c0_g) T.R = NearestRotation(T.R);
  for (Rigid3& T : state.T_cn_cnm1) T.R = NearestRotation(T.R);
  result.cost_px2 = at.cost_px2;
  return result;
}

Eigen::MatrixXd BorderInformation(const BundleAdjustmentState& state,
                                  const std::vector<BundleView>& views,
                                  const BundleAdjustmentOptions& options) {
  BundleAdjustmentOptions plain = options;
  plain.loss_scale_px = 0.0;
  Adjuster adjuster(state, views, plain);
  return adjuster.Information(LinearisationAt(adjuster, state));
}

Eigen::MatrixXd CameraInformation(const CameraModel& model, const std::vector<Rigid3>& T_c_g,
                                  const std::vector<BoardView>& views,
                                  const std::vector<bool>& fixed_parameters) {
  BundleAdjustmentOptions options;
  options.fixed_parameters = {fixed_parameters};
  return BorderInformation({{model}, {}, T_c_g, {}}, ViewsOfOneCamera(views), options);
}

std::vector<FramePose> FramePoses(const BundleAdjustmentState& state,
                                  const std::vector<BundleView>& views,
                                  const BundleAdjustmentOptions& options) {
  BundleAdjustmentOptions plain = options;
  plain.loss_scale_px = 0.0;
  Adjuster adjuster(state, views, plain);
  return adjuster.Poses(LinearisationAt(adjuster, state));
}

}  // namespace calibrato
