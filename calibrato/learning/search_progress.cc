#include "calibrato/learning/search_progress.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>

namespace calibrato {

SearchProgress::SearchProgress(const SearchObjective& objective, const SearchOptions& options)
    : objective_(objective), options_(options) {
  assert(options.limit > 0.0 && options.num_evaluations >= 1);
  result_.best_value = -std::numeric_limits<double>::infinity();
}

int SearchProgress::Allowed(int wanted) const {
  return std::min(wanted, options_.num_evaluations - result_.num_evaluations);
}

Eigen::VectorXd SearchProgress::Evaluate(const Eigen::MatrixXd& positions) {
  assert(positions.cols() <= Allowed(static_cast<int>(positions.cols())));
  Eigen::VectorXd values = objective_(positions, /*want_gradients=*/false).values;
  result_.num_evaluations += static_cast<int>(positions.cols());
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    if (std::isnan(values[i])) values[i] = -std::numeric_limits<double>::infinity();
    if (result_.best_position.size() > 0 && !(values[i] > result_.best_value)) continue;
    result_.best_value = values[i];
    result_.best_position = positions.col(i);
  }
  result_.best_so_far.push_back(result_.best_value);
  return values;
}

Eigen::MatrixXd SearchProgress::Clipped(const Eigen::MatrixXd& positions) const {
  return positions.cwiseMax(-options_.limit).cwiseMin(options_.limit);
}

Eigen::VectorXd SearchProgress::Spread(int dimension) const {
  if (options_.relative_spread.size() == 0) {
    return Eigen::VectorXd::Constant(dimension, options_.limit);
  }
  assert(options_.relative_spread.size() == dimension);
  return options_.limit * options_.relative_spread;
}

Eigen::MatrixXd SearchProgress::Start(int dimension, int count, Rng& rng) const {
  const Eigen::VectorXd spread = Spread(dimension);
  const Eigen::Index num_given = std::min<Eigen::Index>(options_.start.cols(), count);
  Eigen::MatrixXd positions(dimension, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    if (i < num_given) {
      positions.col(i) = Clipped(options_.start.col(i));
      continue;
    }
    for (Eigen::Index k = 0; k < dimension; ++k) {
      positions(k, i) = rng.Uniform(-spread[k], spread[k]);
    }
  }
  return positions;
}

Eigen::VectorXd SearchProgress::FirstMean(int dimension) {
  const int num_given = Allowed(static_cast<int>(options_.start.cols()));
  if (num_given == 0) return Eigen::VectorXd::Zero(dimension);
  const Eigen::MatrixXd given = Clipped(options_.start.leftCols(num_given));
  return given.col(Ranking(Evaluate(given)).front());
}

std::vector<Eigen::Index> Ranking(const Eigen::VectorXd& values) {
  std::vector<Eigen::Index> order(static_cast<size_t>(values.size()));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](Eigen::Index a, Eigen::Index b) { return values[a] > values[b]; });
  return order;
}

}  // namespace calibrato
