#include "calibrato/learning/mpc.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "calibrato/learning/search.h"

namespace calibrato {
namespace {

constexpr int kActionSize = LoopCoefficients::RowsAtCompileTime;

// What a search found, whichever it was.
struct Found {
  Eigen::MatrixXd positions;  // The best first.
  Eigen::VectorXd values;
  std::vector<double> best_so_far;
};

// Keeps the best of all positions that pass by.
class Archive {
 public:
  explicit Archive(size_t capacity) : capacity_(capacity) {}

  void Add(const Eigen::MatrixXd& positions, const Eigen::VectorXd& values) {
    for (Eigen::Index i = 0; i < values.size(); ++i) {
      const double value = values[i];
      // NaN is not kept.
      const auto place = std::find_if(best_.begin(), best_.end(),
                                      [value](const auto& kept) { return value > kept.second; });
      const bool is_wanted = place != best_.end() || (best_.size() < capacity_ && value == value);
      const bool is_known = std::any_of(best_.begin(), best_.end(), [&](const auto& kept) {
        return kept.second == value && kept.first == positions.col(i);
      });
      if (!is_wanted || is_known) continue;
      best_.insert(place, {positions.col(i), value});
      if (best_.size() > capacity_) best_.pop_back();
    }
  }

  Found Content(const SearchResult& result) const {
    Found found;
    found.best_so_far = result.best_so_far;
    if (best_.empty()) {
      found.positions = result.best_position;
      found.values = Eigen::VectorXd::Constant(1, result.best_value);
      return found;
    }
    found.positions.resize(best_.front().first.size(), static_cast<Eigen::Index>(best_.size()));
    found.values.resize(found.positions.cols());
    for (size_t i = 0; i < best_.size(); ++i) {
      found.positions.col(static_cast<Eigen::Index>(i)) = best_[i].first;
      found.values[static_cast<Eigen::Index>(i)] = best_[i].second;
    }
    return found;
  }

 private:
  size_t capacity_;
  std::vector<std::pair<Eigen::VectorXd, double>> best_;
};

Found FindBySwarm(const SearchObjective& objective, int dimension,
                  const Eigen::MatrixXd& remembered, const PlanningOptions& options, Rng& rng) {
  SwarmResult swarm = MaximiseBySwarm(objective, dimension, remembered, options.swarm, rng);
  return {std::move(swarm.positions), std::move(swarm.values), std::move(swarm.best_so_far)};
}

Found FindBySearch(const SearchObjective& objective, int dimension,
                   const Eigen::MatrixXd& remembered, const PlanningOptions& options, Rng& rng) {
  Archive archive(
      static_cast<size_t>(std::max({options.num_candidates, options.swarm.num_remembered, 1})));
  const SearchObjective watched = [&](const Eigen::MatrixXd& positions, bool want_gradients) {
    SearchValues values = objective(positions, want_gradients);
    archive.Add(positions, values.values);
    return values;
  };
  SearchOptions search;
  search.limit = options.swarm.limit;
  search.num_evaluations = NumEvaluations(options);
  search.start = remembered;
  return archive.Content(SearchFromName(options.planner)(watched, dimension, search, rng));
}

}  // namespace

int NumEvaluations(const PlanningOptions& options) {
  return options.swarm.num_particles * (options.swarm.num_iterations + 1);
}

std::vector<std::string> ModelPlannerNames() {
  std::vector<std::string> names = SearchNames();
  names.insert(names.begin(), kPaperPlanner);
  return names;
}

Plan PlanAction(const HistoryModel& model, const History& history, int num_steps,
                const Eigen::MatrixXd& remembered, const PlanningOptions& options,
                Exploration exploration, Rng& rng) {
  assert(num_steps >= 1);
  assert(options.num_candidates >= 1 && options.num_candidates <= options.swarm.num_particles);
  // The history is the same for all sequences.
  const EncodedHistory encoded = model.Encode(history);
  const SearchObjective predicted_return = [&](const Eigen::MatrixXd& actions,
                                               bool want_gradients) {
    PredictedReturns predicted = model.PredictReturns(encoded, actions, want_gradients);
    return SearchValues{std::move(predicted.values), std::move(predicted.gradients)};
  };
  const auto find = options.planner == kPaperPlanner ? FindBySwarm : FindBySearch;
  const Found found = find(predicted_return, kActionSize * num_steps, remembered, options, rng);
  const Eigen::Index num_found = found.positions.cols();
  const Eigen::Index num_candidates = std::min<Eigen::Index>(options.num_candidates, num_found);
  const Eigen::Index chosen =
      exploration == Exploration::kTesting
          ? 0
          : static_cast<Eigen::Index>(rng.UniformIndex(static_cast<uint64_t>(num_candidates)));
  return {found.positions.col(chosen).head<kActionSize>(), found.values[chosen],
          found.positions.leftCols(std::min<Eigen::Index>(options.swarm.num_remembered, num_found)),
          found.best_so_far};
}

}  // namespace calibrato
