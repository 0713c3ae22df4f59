#pragma once

#include <Eigen/Core>
#include <vector>

namespace calibrato {

/// Which of many possible measurements to take, and how often: the optimum of a convex problem.
struct WeightDesign {
  std::vector<double> weights;  ///< One a candidate, >= 0, of sum 1.
  double value = 0.0;  ///< Trace of the normalised covariance of the block, per measurement.
  /// No weights can be better than this: value^2 / max sensitivity, by the equivalence theorem
  /// (Kiefer and Wolfowitz 1960; for A-optimality Fedorov 1972). Equal to the value at the optimum.
  double lower_bound = 0.0;
  int num_iterations = 0;
};

/// Minimises tr(D^-1 (sum of w_k M_k)^-1_bb D^-1) over the weights, by multiplicative steps
/// w_k <- w_k sqrt(d_k), renormalised, with the sensitivities d_k = tr(X' M_k X), X = M^-1_{:,b}
/// D^-1. Monotone (Torsney 1983); sum of w_k d_k = value at every step.
/// @param information  Of each candidate, of one size, positive semidefinite; their sum is regular.
/// @param block        Indices of the parameters that count.
/// @param unit         D, one number a parameter of the block.
/// @param tolerance    Ends when value / lower_bound <= 1 + tolerance, or after max_iterations.
[[nodiscard]] WeightDesign OptimalWeights(const std::vector<Eigen::MatrixXd>& information,
                                          const std::vector<Eigen::Index>& block,
                                          const Eigen::VectorXd& unit, double tolerance = 1e-3,
                                          int max_iterations = 20000);

}  // namespace calibrato
