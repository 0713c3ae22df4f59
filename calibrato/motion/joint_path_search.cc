#include "calibrato/motion/joint_path_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

namespace calibrato {
namespace {

constexpr double kUnreached = std::numeric_limits<double>::infinity();

constexpr int kGridSize = 36;

double LeastExcess(const std::vector<JointVector>& choices, const JointRange& range) {
  double least = std::numeric_limits<double>::infinity();
  for (const JointVector& q : choices) least = std::min(least, JointLimitExcess(q, range));
  return least;
}

std::vector<JointVector> ChoicesAt(const Rigid3& T_b_e, int grid_size, const JointRange& range) {
  constexpr double kMaxExcess = 0.3;  // [rad]; what refinement may still mend
  const double lower = range.lower[6];
  const double upper = range.upper[6];
  std::vector<JointVector> choices;
  for (int i = 0; i < grid_size; ++i) {
    const double q7 = lower + (upper - lower) * (i + 0.5) / grid_size;
    const std::vector<JointVector> solutions = PandaInverse(T_b_e, q7);
    choices.insert(choices.end(), solutions.begin(), solutions.end());
  }
  const double max_excess = std::max(kMaxExcess, LeastExcess(choices, range));
  std::erase_if(choices,
                [&](const JointVector& q) { return JointLimitExcess(q, range) > max_excess; });
  return choices;
}

// From choice `from` of a way-point to choice `to` of the next.
struct Step {
  int from;
  int to;
  double cost;  // with the wall's at its end
};

std::vector<Step> StepsBetween(const std::vector<JointVector>& before,
                               const std::vector<JointVector>& after,
                               const JointPathCost& path_cost) {
  std::vector<Step> steps;
  for (size_t to = 0; to < after.size(); ++to) {
    const double wall_after = path_cost.Wall(after[to]);
    for (size_t from = 0; from < before.size(); ++from) {
      if (std::abs(after[to][6] - before[from][6]) > kMaxJointStep) continue;
      const JointVector step = after[to] - before[from];
      if (step.cwiseAbs().maxCoeff() > kMaxJointStep) continue;
      steps.push_back(
          {static_cast<int>(from), static_cast<int>(to), JointPathCost::Step(step) + wall_after});
    }
  }
  return steps;
}

using LoopSteps = std::vector<std::vector<Step>>;  // by way-point, 1 to 62

// The least costs to all choices of the next way-point, and through which choice before it.
struct Reached {
  std::vector<double> cost;
  std::vector<int> from;
};

Reached Advance(const std::vector<double>& cost, const std::vector<Step>& steps, size_t size) {
  Reached next{std::vector<double>(size, kUnreached), std::vector<int>(size, -1)};
  for (const Step& step : steps) {
    const double through = cost[step.from] + step.cost;
    if (through < next.cost[step.to]) {
      next.cost[step.to] = through;
      next.from[step.to] = step.from;
    }
  }
  return next;
}

class Search {
 public:
  Search(const JointChoices& choices, const JointPathCost& path_cost) : choices_(choices) {
    for (size_t loop = 0; loop < choices.loops.size(); ++loop) {
      LoopSteps& steps = steps_.emplace_back();
      for (int way_point = 1; way_point <= kNumWayPoints; ++way_point) {
        steps.push_back(
            StepsBetween(choices.At(loop, way_point - 1), choices.At(loop, way_point), path_cost));
      }
    }
  }

  double Cost(int start) const {
    double cost = 0.0;
    for (size_t loop = 0; loop < steps_.size() && cost < kUnreached; ++loop) {
      cost += Trace(loop, start).back().cost[start];
    }
    return cost;
  }

  // @pre Cost(start) is finite
  JointPath Path(int start) const {
    JointPath path;
    path.start = choices_.start[start];
    for (size_t loop = 0; loop < steps_.size(); ++loop) {
      const std::vector<Reached> reached = Trace(loop, start);
      JointPath::Loop& joints = path.loops.emplace_back();
      int choice = start;
      for (int way_point = kNumWayPoints; way_point > 1; --way_point) {
        choice = reached[way_point - 1].from[choice];
        joints[way_point - 2] = choices_.At(loop, way_point - 1)[choice];
      }
    }
    return path;
  }

  // The first way-point that no path from any start gets to or, if none stops all, the return to
  // the start.
  Refusal FirstGap() const {
    Refusal refusal;
    refusal.limit = "largest joint step between way-points";
    refusal.bound = kMaxJointStep;
    refusal.unit = "rad";
    refusal.num_bad_way_points = 1;
    for (size_t loop = 0; loop < steps_.size(); ++loop) {
      std::vector<double> cost(choices_.start.size(), 0.0);
      for (int way_point = 1; way_point <= kNumWayPoints; ++way_point) {
        const std::vector<JointVector>& after = choices_.At(loop, way_point);
        Reached reached = Advance(cost, steps_[loop][way_point - 1], after.size());
        const bool closes = way_point < kNumWayPoints || ClosesFromSomeStart(loop);
        if (closes && std::ranges::any_of(reached.cost, [](double c) { return c < kUnreached; })) {
          cost = std::move(reached.cost);
          continue;
        }
        refusal.loop = static_cast<int>(loop);
        refusal.way_point = way_point;
        refusal.value = SmallestStep(cost, choices_.At(loop, way_point - 1), after);
        return refusal;
      }
    }
    // Each loop closes, but from different starts: the last one can't join the others.
    refusal.loop = static_cast<int>(steps_.size()) - 1;
    refusal.way_point = kNumWayPoints;
    refusal.limit = "one start configuration for all loops";
    refusal.value = static_cast<double>(steps_.size());
    refusal.bound = refusal.value - 1.0;
    refusal.unit = "loops";
    return refusal;
  }

 private:
  std::vector<Reached> Trace(size_t loop, int start) const {
    std::vector<double> cost(choices_.start.size(), kUnreached);
    cost[start] = 0.0;
    std::vector<Reached> trace;
    trace.reserve(kNumWayPoints);
    for (int way_point = 1; way_point <= kNumWayPoints; ++way_point) {
      trace.push_back(Advance(way_point == 1 ? cost : trace.back().cost,
                              steps_[loop][way_point - 1], choices_.At(loop, way_point).size()));
    }
    return trace;
  }

  bool ClosesFromSomeStart(size_t loop) const {
    for (size_t start = 0; start < choices_.start.size(); ++start) {
      const int s = static_cast<int>(start);
      if (Trace(loop, s).back().cost[s] < kUnreached) return true;
    }
    return false;
  }

  static double SmallestStep(const std::vector<double>& cost_before,
                             const std::vector<JointVector>& before,
                             const std::vector<JointVector>& after) {
    double smallest = kUnreached;
    for (size_t from = 0; from < before.size(); ++from) {
      if (!(cost_before[from] < kUnreached)) continue;
      for (const JointVector& to : after) {
        smallest = std::min(smallest, (to - before[from]).cwiseAbs().maxCoeff());
      }
    }
    return smallest;
  }

  const JointChoices& choices_;
  std::vector<LoopSteps> steps_;
};

}  // namespace

JointChoices JointChoicesAlong(const PosePath& poses, const JointRange& range) {
  const auto choices_at = [&](const Rigid3& T_b_e) { return ChoicesAt(T_b_e, kGridSize, range); };
  JointChoices choices;
  choices.start = choices_at(poses.start);
  for (const PosePath::Loop& loop : poses.loops) {
    std::ranges::transform(loop, choices.loops.emplace_back().begin(), choices_at);
  }
  return choices;
}

JointChoices FinerWhereTight(const PosePath& poses, const JointChoices& choices,
                             const JointRange& range) {
  constexpr double kTight = -0.1;  // [rad]
  const auto finer = [&](const Rigid3& T_b_e, const std::vector<JointVector>& coarse) {
    return LeastExcess(coarse, range) > kTight ? ChoicesAt(T_b_e, 4 * kGridSize, range) : coarse;
  };
  JointChoices fine;
  fine.start = finer(poses.start, choices.start);
  for (size_t loop = 0; loop < poses.loops.size(); ++loop) {
    std::ranges::transform(poses.loops[loop], choices.loops[loop],
                           fine.loops.emplace_back().begin(), finer);
  }
  return fine;
}

std::variant<std::vector<JointPath>, Refusal> SearchJointPaths(const JointChoices& choices,
                                                               const JointPathCost& path_cost) {
  constexpr size_t kMaxPaths = 4;
  constexpr double kMuch = 1.2;  // [rad]
  const Search search(choices, path_cost);
  std::vector<double> cost(choices.start.size());
  for (size_t i = 0; i < cost.size(); ++i) cost[i] = search.Cost(static_cast<int>(i));
  std::vector<int> order(cost.size());
  std::iota(order.begin(), order.end(), 0);
  std::erase_if(order, [&](int start) { return !(cost[start] < kUnreached); });
  if (order.empty()) return search.FirstGap();
  std::ranges::stable_sort(order, [&](int a, int b) { return cost[a] < cost[b]; });

  std::vector<JointPath> paths;
  for (const int start : order) {
    if (paths.size() == kMaxPaths) break;
    // The shoulder has two sides that differ in joints 1 to 3 alone and serve as well.
    const bool differs = std::ranges::all_of(paths, [&](const JointPath& path) {
      return (choices.start[start] - path.start).tail<4>().cwiseAbs().maxCoeff() > kMuch;
    });
    if (differs) paths.push_back(search.Path(start));
  }
  return paths;
}

}  // namespace calibrato
