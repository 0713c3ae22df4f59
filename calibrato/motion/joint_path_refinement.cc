#include "calibrato/motion/joint_path_refinement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>

namespace calibrato {
namespace {

constexpr int kNumInner = JointPath::kNumInner;
using LoopVector = std::array<double, kNumInner>;

double Cost(const JointPath& path, const JointPathCost& path_cost) {
  double cost = path_cost.Wall(path.start);
  for (size_t loop = 0; loop < path.loops.size(); ++loop) {
    for (const JointVector& q : path.loops[loop]) cost += path_cost.Wall(q);
    for (int i = 1; i <= kNumWayPoints; ++i) {
      cost += JointPathCost::Step(path.At(loop, i) - path.At(loop, i - 1));
    }
  }
  return cost;
}

JointPath NullDirections(const JointPath& path) {
  const auto direction = [](const JointVector& q) {
    JointJacobian J;
    (void)PandaPose(q, &J);
    return PandaNullDirection(J);
  };
  JointPath directions;
  directions.start = direction(path.start);
  for (const JointPath::Loop& loop : path.loops) {
    std::ranges::transform(loop, directions.loops.emplace_back().begin(), direction);
  }
  return directions;
}

// The quadratic model of the cost along the null directions.
struct LoopModel {
  LoopVector gradient;
  LoopVector diagonal;
  std::array<double, kNumInner - 1> off_diagonal;
  double first_with_start;  // Of the border: the loop's first way-point with the start ...
  double last_with_start;   // ... and its last.
};

struct Model {
  double start_gradient;
  double start_diagonal;
  std::vector<LoopModel> loops;
};

Model BuildModel(const JointPath& path, const JointPath& directions,
                 const JointPathCost& path_cost) {
  const auto dot = [](const JointVector& a, const JointVector& b) {
    return a.cwiseProduct(JointPathCost::StepWeights()).dot(b);
  };
  Model model;
  const JointVector& n0 = directions.start;
  const auto num_loops = static_cast<double>(path.loops.size());
  const JointPathCost::Derivatives start_wall = path_cost.WallAlong(path.start, n0);
  model.start_gradient = start_wall.first;
  model.start_diagonal = 2.0 * num_loops * dot(n0, n0) + start_wall.second;
  for (size_t loop = 0; loop < path.loops.size(); ++loop) {
    LoopModel& m = model.loops.emplace_back();
    for (int i = 0; i < kNumInner; ++i) {
      const JointVector& n = directions.loops[loop][i];
      const JointVector& q = path.loops[loop][i];
      const JointVector bend = 2.0 * q - path.At(loop, i) - path.At(loop, i + 2);
      const JointPathCost::Derivatives wall = path_cost.WallAlong(q, n);
      m.gradient[i] = dot(n, bend) + wall.first;
      m.diagonal[i] = 2.0 * dot(n, n) + wall.second;
      if (i > 0) m.off_diagonal[i - 1] = -dot(n, directions.loops[loop][i - 1]);
    }
    m.first_with_start = -dot(n0, directions.loops[loop].front());
    m.last_with_start = -dot(n0, directions.loops[loop].back());
    model.start_gradient +=
        dot(n0, 2.0 * path.start - path.loops[loop].front() - path.loops[loop].back());
  }
  return model;
}

// A tridiagonal, positive definite system, factored once for two right-hand sides.
class TridiagonalSolver {
 public:
  TridiagonalSolver(const LoopModel& model, double damping) : off_diagonal_(model.off_diagonal) {
    for (int i = 0; i < kNumInner; ++i) {
      pivot_[i] = model.diagonal[i] + damping;
      if (i > 0) pivot_[i] -= off_diagonal_[i - 1] * off_diagonal_[i - 1] / pivot_[i - 1];
    }
  }

  LoopVector Solve(LoopVector x) const {
    for (int i = 1; i < kNumInner; ++i) x[i] -= off_diagonal_[i - 1] / pivot_[i - 1] * x[i - 1];
    x[kNumInner - 1] /= pivot_[kNumInner - 1];
    for (int i = kNumInner - 2; i >= 0; --i) {
      x[i] = (x[i] - off_diagonal_[i] * x[i + 1]) / pivot_[i];
    }
    return x;
  }

 private:
  std::array<double, kNumInner - 1> off_diagonal_;
  LoopVector pivot_;
};

// How far to go along each null direction.
LoopedPath<double> SolveStep(const Model& model, double damping) {
  // Loops are eliminated first: x_l = T_l^-1 (-g_l - c_l x_0), then the start alone is left.
  std::vector<LoopVector> without_start;
  std::vector<LoopVector> per_start;
  double diagonal = model.start_diagonal + damping;
  double right = -model.start_gradient;
  for (const LoopModel& m : model.loops) {
    const TridiagonalSolver solver(m, damping);
    LoopVector minus_gradient;
    std::ranges::transform(m.gradient, minus_gradient.begin(), std::negate<>());
    LoopVector border{};
    border.front() = m.first_with_start;
    border.back() = m.last_with_start;
    const LoopVector& x = without_start.emplace_back(solver.Solve(minus_gradient));
    const LoopVector& y = per_start.emplace_back(solver.Solve(border));
    diagonal -= m.first_with_start * y.front() + m.last_with_start * y.back();
    right -= m.first_with_start * x.front() + m.last_with_start * x.back();
  }
  LoopedPath<double> step;
  step.start = right / diagonal;
  for (size_t loop = 0; loop < model.loops.size(); ++loop) {
    LoopVector& x = step.loops.emplace_back();
    for (int i = 0; i < kNumInner; ++i) {
      x[i] = without_start[loop][i] - per_start[loop][i] * step.start;
    }
  }
  return step;
}

// The null directions are good for so far [rad]: longer steps are cut.
constexpr double kMaxStep = 0.2;

std::optional<JointVector> Moved(const Rigid3& T_b_e, const JointVector& q, const JointVector& n,
                                 double step) {
  return PandaInverseNear(T_b_e, q + std::clamp(step, -kMaxStep, kMaxStep) * n);
}

std::optional<JointPath> MovedPath(const PosePath& poses, const JointPath& path,
                                   const JointPath& directions, const LoopedPath<double>& step) {
  JointPath moved;
  const auto start = Moved(poses.start, path.start, directions.start, step.start);
  if (!start) return std::nullopt;
  moved.start = *start;
  for (size_t loop = 0; loop < path.loops.size(); ++loop) {
    JointPath::Loop& joints = moved.loops.emplace_back();
    for (int i = 0; i < kNumInner; ++i) {
      const auto q = Moved(poses.loops[loop][i], path.loops[loop][i], directions.loops[loop][i],
                           step.loops[loop][i]);
      if (!q) return std::nullopt;
      joints[i] = *q;
    }
  }
  return moved;
}

}  // namespace

JointPath RefineJointPath(const PosePath& poses, const JointPath& path,
                          const JointPathCost& path_cost) {
  constexpr int kMaxIterations = 40;
  constexpr double kSmallDecrease = 1e-3;  // of the cost
  constexpr double kMaxDamping = 1e4;
  JointPath best = path;
  double cost = Cost(best, path_cost);
  double damping = 1e-3;
  for (int i = 0; i < kMaxIterations && damping < kMaxDamping; ++i) {
    const JointPath directions = NullDirections(best);
    const Model model = BuildModel(best, directions, path_cost);
    bool improved = false;
    while (!improved && damping < kMaxDamping) {
      std::optional<JointPath> moved =
          MovedPath(poses, best, directions, SolveStep(model, damping));
      const double new_cost = moved ? Cost(*moved, path_cost) : cost;
      if (!(new_cost < cost)) {
        damping = std::max(10.0 * damping, 1e-2);
        continue;
      }
      const bool converged = cost - new_cost < kSmallDecrease * cost;
      best = std::move(*moved);
      cost = new_cost;
      damping *= 0.2;
      improved = true;
      if (converged) return best;
    }
  }
  return best;
}

}  // namespace calibrato
