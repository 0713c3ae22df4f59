#pragma once

#include "calibrato/learning/search.h"

namespace calibrato {

/// The course of a search: evaluates, counts, and remembers the best. What every method of search.h
/// is built around.
class SearchProgress {
 public:
  SearchProgress(const SearchObjective& objective, const SearchOptions& options);

  bool done() const { return result_.num_evaluations >= options_.num_evaluations; }
  /// How many of so many positions the budget still allows.
  int Allowed(int wanted) const;

  /// Values at positions within the box, minus infinity for what is not a number. @pre no more
  /// columns than allowed
  Eigen::VectorXd Evaluate(const Eigen::MatrixXd& positions);

  Eigen::MatrixXd Clipped(const Eigen::MatrixXd& positions) const;
  /// Spread of each coordinate.
  Eigen::VectorXd Spread(int dimension) const;
  /// The given start, clipped, then uniform draws of that spread: `count` columns.
  Eigen::MatrixXd Start(int dimension, int count, Rng& rng) const;

  /// Where distributions begin: the best of the given start, which is evaluated; else the middle.
  Eigen::VectorXd FirstMean(int dimension);

  const SearchResult& result() const { return result_; }

 private:
  const SearchObjective& objective_;
  const SearchOptions& options_;
  SearchResult result_;
};

/// Indices by value, the highest first; equal ones in their order.
[[nodiscard]] std::vector<Eigen::Index> Ranking(const Eigen::VectorXd& values);

}  // namespace calibrato
