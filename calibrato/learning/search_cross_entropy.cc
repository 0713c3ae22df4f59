#include <algorithm>
#include <cmath>

#include "calibrato/learning/search.h"
#include "calibrato/learning/search_progress.h"

namespace calibrato {
namespace {

constexpr int kPopulation = 100;
constexpr double kEliteShare = 0.1;
// How much of the old mean and spread stays.
constexpr double kMomentum = 0.1;
constexpr double kLeastSpread = 1e-3;  // Of the first one.
// iCEM
constexpr double kShrink = 1.25;
constexpr double kKeptShare = 0.3;

struct Distribution {
  Eigen::VectorXd mean;
  Eigen::VectorXd stddev;
};

Eigen::MatrixXd Draw(const Distribution& distribution, Eigen::Index count, Rng& rng) {
  Eigen::MatrixXd positions(distribution.mean.size(), count);
  for (Eigen::Index i = 0; i < count; ++i) {
    for (Eigen::Index k = 0; k < positions.rows(); ++k) {
      positions(k, i) = rng.Normal(distribution.mean[k], distribution.stddev[k]);
    }
  }
  return positions;
}

// Mean and standard deviation of the elites, one column each.
void Refit(const Eigen::MatrixXd& elites, const Eigen::VectorXd& least,
           Distribution* distribution) {
  const Eigen::VectorXd mean = elites.rowwise().mean();
  const Eigen::VectorXd variance =
      (elites.colwise() - mean).rowwise().squaredNorm() / static_cast<double>(elites.cols());
  distribution->mean = kMomentum * distribution->mean + (1.0 - kMomentum) * mean;
  distribution->stddev =
      (kMomentum * distribution->stddev + (1.0 - kMomentum) * variance.cwiseSqrt()).cwiseMax(least);
}

// The columns of a ranking's beginning.
Eigen::MatrixXd Best(const Eigen::MatrixXd& positions, const Eigen::VectorXd& values,
                     Eigen::Index count) {
  std::vector<Eigen::Index> order = Ranking(values);
  order.resize(static_cast<size_t>(std::min<Eigen::Index>(count, positions.cols())));
  return positions(Eigen::all, order);
}

Distribution FirstDistribution(SearchProgress& progress, int dimension) {
  // A uniform distribution's standard deviation.
  return {progress.FirstMean(dimension), progress.Spread(dimension) / std::sqrt(3.0)};
}

}  // namespace

SearchResult SearchByCem(const SearchObjective& objective, int dimension,
                         const SearchOptions& options, Rng& rng) {
  SearchProgress progress(objective, options);
  Distribution distribution = FirstDistribution(progress, dimension);
  const Eigen::VectorXd least = kLeastSpread * distribution.stddev;
  const auto num_elites = static_cast<Eigen::Index>(kEliteShare * kPopulation);
  while (!progress.done()) {
    const Eigen::MatrixXd positions =
        progress.Clipped(Draw(distribution, progress.Allowed(kPopulation), rng));
    const Eigen::VectorXd values = progress.Evaluate(positions);
    if (positions.cols() >= num_elites) {
      Refit(Best(positions, values, num_elites), least, &distribution);
    }
  }
  return progress.result();
}

SearchResult SearchByIcem(const SearchObjective& objective, int dimension,
                          const SearchOptions& options, Rng& rng) {
  SearchProgress progress(objective, options);
  Distribution distribution = FirstDistribution(progress, dimension);
  const Eigen::VectorXd least = kLeastSpread * distribution.stddev;
  const auto num_elites = static_cast<Eigen::Index>(kEliteShare * kPopulation);
  const auto num_kept = static_cast<Eigen::Index>(std::ceil(kKeptShare * num_elites));
  Eigen::MatrixXd kept(dimension, 0);
  double population = kPopulation;
  while (!progress.done()) {
    // Kept ones are drawn again with the others: their value may depend on noise.
    const int wanted = std::max(static_cast<int>(population), static_cast<int>(2 * num_elites));
    const int allowed = progress.Allowed(wanted);
    Eigen::MatrixXd positions = progress.Clipped(Draw(distribution, allowed, rng));
    const Eigen::Index again = std::min<Eigen::Index>(kept.cols(), allowed);
    positions.leftCols(again) = kept.leftCols(again);
    if (allowed > again) positions.col(allowed - 1) = progress.Clipped(distribution.mean);
    const Eigen::VectorXd values = progress.Evaluate(positions);
    kept = Best(positions, values, num_kept);
    if (positions.cols() >= num_elites) {
      Refit(Best(positions, values, num_elites), least, &distribution);
    }
    population /= kShrink;
  }
  return progress.result();
}

}  // namespace calibrato
