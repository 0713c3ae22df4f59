#include "calibrato/calibration/bundle_adjustment.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>

#include "calibrato/base/parallel.h"
#include "calibrato/geometry/so3.h"

namespace calibrato {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// The normal equations of one view for the columns [pose (6), parameters (n), residual (1)]: one
// symmetric matrix of which every block that the elimination needs is a part. Where the camera is
// held, n is 0.
template <int kParameters>
using ViewNormal = Eigen::Matrix<double, 7 + kParameters, 7 + kParameters>;

// Nothing where a corner does not project: the step that led there is refused.
template <int kParameters, typename Model>
std::optional<ViewNormal<kParameters>> NormalEquations(const Model& model, const BoardView& view,
                                                       const Rigid3& T_c_g) {
  static_assert(kParameters == 0 || kParameters == Model::kNumParameters);
  ViewNormal<kParameters> normal = ViewNormal<kParameters>::Zero();
  Eigen::Vector2d pixel;
  typename Model::JacobianPoint J_point;
  typename Model::JacobianParameters J_parameters;
  Eigen::Matrix<double, 2, 7 + kParameters> rows;
  for (Eigen::Index k = 0; k < view.num_corners(); ++k) {
    const Eigen::Vector3d turned = T_c_g.R * view.points_g.col(k);
    if (!model.Project(turned + T_c_g.t, &pixel, &J_point,
                       kParameters == 0 ? nullptr : &J_parameters)) {
      return std::nullopt;
    }
    rows.template leftCols<3>().noalias() = -J_point * Hat(turned);
    rows.template middleCols<3>(3) = J_point;
    if constexpr (kParameters != 0) rows.template middleCols<kParameters>(6) = J_parameters;
    rows.col(6 + kParameters) = pixel - view.pixels.col(k);
    normal.noalias() += rows.transpose() * rows;
  }
  return normal;
}

template <typename Model>
double SquaredError(const Model& model, const BoardView& view, const Rigid3& T_c_g) {
  double sum = 0.0;
  Eigen::Vector2d pixel;
  for (Eigen::Index k = 0; k < view.num_corners(); ++k) {
    if (!model.Project(T_c_g * view.points_g.col(k), &pixel, nullptr, nullptr)) return kInfinity;
    sum += (pixel - view.pixels.col(k)).squaredNorm();
  }
  return sum;
}

// Below this many views a parallel loop costs more than it saves. It depends on the problem, not on
// the threads.
constexpr size_t kViewsWorthAThread = 64;

void ForEachView(size_t num_views, const std::function<void(size_t)>& body) {
  if (num_views < kViewsWorthAThread) {
    for (size_t v = 0; v < num_views; ++v) body(v);
    return;
  }
  const size_t num_chunks = (num_views + kViewsWorthAThread / 4 - 1) / (kViewsWorthAThread / 4);
  ParallelFor(num_chunks, [&](size_t chunk) {
    const size_t begin = chunk * (kViewsWorthAThread / 4);
    const size_t end = std::min(num_views, begin + kViewsWorthAThread / 4);
    for (size_t v = begin; v < end; ++v) body(v);
  });
}

template <typename Model>
class Adjuster {
 public:
  static constexpr int kParameters = Model::kNumParameters;
  using Parameters = Eigen::Matrix<double, kParameters, 1>;
  using ParameterMatrix = Eigen::Matrix<double, kParameters, kParameters>;
  using Vector6d = Eigen::Matrix<double, 6, 1>;
  using Matrix6d = Eigen::Matrix<double, 6, 6>;
  using Coupling = Eigen::Matrix<double, 6, kParameters>;

  Adjuster(const std::vector<BoardView>& views, const std::vector<bool>& fixed)
      : views_(views), normals_(views.size()), reduced_(views.size()) {
    free_.setOnes();
    for (size_t i = 0; i < fixed.size(); ++i) free_(static_cast<Eigen::Index>(i)) = !fixed[i];
  }

  // Fills the normal equations; false where a corner does not project.
  bool Linearise(const Model& model, const std::vector<Rigid3>& T_c_g) {
    std::vector<char> projects(views_.size(), 1);
    ForEachView(views_.size(), [&](size_t v) {
      if (auto normal = NormalEquations<kParameters>(model, views_[v], T_c_g[v])) {
        normals_[v] = *normal;
      } else {
        projects[v] = 0;
      }
    });
    return std::find(projects.begin(), projects.end(), 0) == projects.end();
  }

  double squared_error() const {
    double sum = 0.0;
    for (const auto& normal : normals_) sum += normal(6 + kParameters, 6 + kParameters);
    return sum;
  }

  struct Step {
    Parameters parameters;
    std::vector<Vector6d> poses;
    double promised_decrease = 0.0;
  };

  // The damped step; nothing where the reduced system is not positive definite.
  std::optional<Step> Solve(double damping) {
    ForEachView(views_.size(), [&](size_t v) { Eliminate(v, damping); });
    ParameterMatrix S = ParameterMatrix::Zero();
    Parameters gradient = Parameters::Zero();
    for (const Reduced& reduced : reduced_) {
      S += reduced.S;
      gradient += reduced.gradient;
    }
    HoldFixed(&S, &gradient);
    const Eigen::LLT<ParameterMatrix> cholesky(S);
    if (cholesky.info() != Eigen::Success) return std::nullopt;
    Step step{-cholesky.solve(gradient), std::vector<Vector6d>(views_.size()), 0.0};
    if (!step.parameters.allFinite()) return std::nullopt;
    ForEachView(views_.size(), [&](size_t v) {
      step.poses[v] = -(reduced_[v].pose_step + reduced_[v].solved_coupling * step.parameters);
    });
    step.promised_decrease = PromisedDecrease(step);
    return step;
  }

  // The undamped information about the parameters.
  ParameterMatrix Information() {
    ForEachView(views_.size(), [&](size_t v) { Eliminate(v, 0.0); });
    ParameterMatrix S = ParameterMatrix::Zero();
    for (const Reduced& reduced : reduced_) S += reduced.S;
    return free_.asDiagonal() * S * free_.asDiagonal();
  }

 private:
  // What is left of a view once its pose is eliminated.
  struct Reduced {
    ParameterMatrix S;
    Parameters gradient;
    Coupling solved_coupling;  // A^-1 B
    Vector6d pose_step;        // A^-1 g
  };

  void Eliminate(size_t v, double damping) {
    const auto& normal = normals_[v];
    Matrix6d A = normal.template topLeftCorner<6, 6>();
    A.diagonal() *= 1.0 + damping;
    const Coupling B = normal.template block<6, kParameters>(0, 6) * free_.asDiagonal();
    const Vector6d g = normal.template block<6, 1>(0, 6 + kParameters);
    const Eigen::LDLT<Matrix6d> ldlt(A);
    Reduced& reduced = reduced_[v];
    reduced.solved_coupling = ldlt.solve(B);
    reduced.pose_step = ldlt.solve(g);
    reduced.S = normal.template block<kParameters, kParameters>(6, 6);
    reduced.S.diagonal() *= 1.0 + damping;
    reduced.S.noalias() -= B.transpose() * reduced.solved_coupling;
    reduced.gradient = normal.template block<kParameters, 1>(6, 6 + kParameters);
    reduced.gradient.noalias() -= B.transpose() * reduced.pose_step;
  }

  // Fixed parameters become equations of their own: 1 * step = 0.
  void HoldFixed(ParameterMatrix* S, Parameters* gradient) const {
    *S = free_.asDiagonal() * (*S) * free_.asDiagonal();
    for (int i = 0; i < kParameters; ++i) {
      if (free_(i) == 0.0) (*S)(i, i) = 1.0;
    }
    *gradient = gradient->cwiseProduct(free_);
  }

  // By how much the linearised problem says that the squared error falls.
  double PromisedDecrease(const Step& step) const {
    double decrease = 0.0;
    Eigen::Matrix<double, 6 + kParameters, 1> x;
    x.template tail<kParameters>() = step.parameters;
    for (size_t v = 0; v < views_.size(); ++v) {
      x.template head<6>() = step.poses[v];
      const auto& H = normals_[v].template topLeftCorner<6 + kParameters, 6 + kParameters>();
      const auto& g = normals_[v].template topRightCorner<6 + kParameters, 1>();
      decrease -= 2.0 * g.dot(x) + x.dot(H * x);
    }
    return decrease;
  }

  const std::vector<BoardView>& views_;
  Parameters free_;  // 1 for free parameters, 0 for fixed ones
  std::vector<ViewNormal<kParameters>> normals_;
  std::vector<Reduced> reduced_;
};

template <typename Model>
BundleAdjustmentResult Adjust(const Model& start_model, const BundleAdjustmentState& start,
                              const std::vector<BoardView>& views,
                              const BundleAdjustmentOptions& options) {
  Adjuster<Model> adjuster(views, options.fixed_parameters);
  Model model = start_model;
  std::vector<Rigid3> T_c_g = start.T_c_g;
  [[maybe_unused]] const bool projects = adjuster.Linearise(model, T_c_g);
  assert(projects);
  double error = adjuster.squared_error();
  double damping = 1e-4;
  BundleAdjustmentResult result{start, Termination::kIterationLimit, 0, error};
  while (result.num_iterations < options.max_iterations) {
    ++result.num_iterations;
    const auto step = adjuster.Solve(damping);
    // Where rounding is all that is left, no step can lower the error any further.
    if (step && !(step->promised_decrease > options.cost_tolerance * error)) {
      result.termination = Termination::kConverged;
      break;
    }
    bool accepted = false;
    if (step && model.parameters()(0) + step->parameters(0) > 0.0 &&
        model.parameters()(1) + step->parameters(1) > 0.0) {
      const Model next(model.parameters() + step->parameters);
      std::vector<Rigid3> next_T_c_g(views.size());
      std::vector<double> errors(views.size());
      ForEachView(views.size(), [&](size_t v) {
        next_T_c_g[v] = T_c_g[v].Perturbed(step->poses[v]);
        errors[v] = SquaredError(next, views[v], next_T_c_g[v]);
      });
      double next_error = 0.0;
      for (const double e : errors) next_error += e;
      if (next_error < error) {
        accepted = true;
        // Nielsen's rule: trust the model as far as it was right.
        const double gain = (error - next_error) / step->promised_decrease;
        damping = std::max(1e-14, damping * std::max(0.1, 1.0 - std::pow(2.0 * gain - 1.0, 3)));
        model = next;
        T_c_g = std::move(next_T_c_g);
        adjuster.Linearise(model, T_c_g);
        error = adjuster.squared_error();
      }
    }
    if (!accepted) {
      damping *= 8.0;
      if (damping > 1e12) {
        // Not even a tiny step along the gradient helps: this is the minimum to within rounding.
        result.termination = Termination::kConverged;
        break;
      }
    }
  }
  // A rotation that was multiplied a hundred times is a rotation no more.
  for (Rigid3& T : T_c_g) T.R = NearestRotation(T.R);
  result.state = {CameraModel(start.model.name(), model.parameters()), std::move(T_c_g)};
  result.squared_error_px2 = error;
  return result;
}

}  // namespace

BundleAdjustmentResult AdjustBundle(const BundleAdjustmentState& start,
                                    const std::vector<BoardView>& views,
                                    const BundleAdjustmentOptions& options) {
  assert(start.T_c_g.size() == views.size());
  return std::visit([&](const auto& model) { return Adjust(model, start, views, options); },
                    start.model.variant());
}

Eigen::MatrixXd CameraInformation(const BundleAdjustmentState& state,
                                  const std::vector<BoardView>& views,
                                  const std::vector<bool>& fixed_parameters) {
  return std::visit(
      [&](const auto& model) -> Eigen::MatrixXd {
        Adjuster<std::decay_t<decltype(model)>> adjuster(views, fixed_parameters);
        [[maybe_unused]] const bool projects = adjuster.Linearise(model, state.T_c_g);
        assert(projects);
        return adjuster.Information();
      },
      state.model.variant());
}

Rigid3 RefinedPose(const CameraModel& model, const BoardView& view, const Rigid3& T_c_g_start,
                   int max_iterations) {
  return std::visit(
      [&](const auto& m) {
        Rigid3 T_c_g = T_c_g_start;
        double damping = 1e-4;
        auto normal = NormalEquations<0>(m, view, T_c_g);
        for (int i = 0; i < max_iterations && normal; ++i) {
          Eigen::Matrix<double, 6, 6> A = normal->template topLeftCorner<6, 6>();
          A.diagonal() *= 1.0 + damping;
          const Eigen::Matrix<double, 6, 1> step =
              -A.ldlt().solve(normal->template topRightCorner<6, 1>());
          const double error = (*normal)(6, 6);
          const Rigid3 next = T_c_g.Perturbed(step);
          const auto next_normal = NormalEquations<0>(m, view, next);
          if (next_normal && (*next_normal)(6, 6) < error) {
            const bool done = (*next_normal)(6, 6) > (1.0 - 1e-9) * error;
            T_c_g = next;
            normal = next_normal;
            damping *= 0.1;
            if (done) break;
          } else {
            damping *= 10.0;
            if (damping > 1e8) break;
          }
        }
        return T_c_g;
      },
      model.variant());
}

Eigen::Matrix2Xd ReprojectionResiduals(const CameraModel& model, const BoardView& view,
                                       const Rigid3& T_c_g) {
  Eigen::Matrix2Xd residuals(2, view.num_corners());
  for (Eigen::Index k = 0; k < view.num_corners(); ++k) {
    const auto pixel = model.Project(T_c_g * view.points_g.col(k));
    residuals.col(k) = pixel ? Eigen::Vector2d(*pixel - view.pixels.col(k))
                             : Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
  }
  return residuals;
}

}  // namespace calibrato
