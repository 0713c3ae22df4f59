#pragma once

#include <Eigen/Core>

namespace calibrato {

/// What optimal design makes small: a number made of the covariance C of the wanted parameters,
/// normalised by their units D as Information is, C_n = D^-1 C D^-1.
enum class DesignCriterion {
  kA,  ///< Trace of C_n.
  kD,  ///< log det C_n: the logarithm, so that its scale does not depend on how many there are.
  kE,  ///< Largest eigenvalue of C_n.
};

/// A criterion and its derivative, as needed by chains of derivatives: for any small change,
///
///     d value = tr(root root' dC),
///
/// so that with C the block e of H^-1,  d value = -tr(X' dH X),  X = (H^-1)_{:,e} root.
struct CriterionValue {
  double value = 0.0;
  Eigen::MatrixXd root;  ///< As many rows as C.
};

/// @param covariance  C, symmetric positive definite.
/// @param unit        The diagonal of D, all > 0.
/// Where the largest eigenvalue is a double one, kE has no derivative: one of its one-sided ones is
/// given.
[[nodiscard]] CriterionValue EvaluateCriterion(DesignCriterion criterion,
                                               const Eigen::MatrixXd& covariance,
                                               const Eigen::VectorXd& unit);

}  // namespace calibrato
