#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace calibrato {

/// How much a calibration knows, by the three criteria of optimal design (paper, section 3.1), of
/// the normalised covariance D^-1 Sigma D^-1 of a block of parameters. Smaller is better.
///
/// D is fixed: 1 px for intrinsics, 1e-3 rad, 1e-3 m, 1e-4 s. Sigma is the marginal covariance of
/// the block, with everything else unknown, not the inverse of the information's sub-block.
struct Information {
  double a_optimality = 0.0;    ///< Trace.
  double d_optimality = 0.0;    ///< Determinant.
  double e_optimality = 0.0;    ///< Largest eigenvalue.
  Eigen::VectorXd eigenvalues;  ///< Ascending.
};

/// @param covariance  Marginal covariance of the block, symmetric.
/// @param unit        The diagonal of D, all > 0.
[[nodiscard]] Information InformationOf(const Eigen::MatrixXd& covariance,
                                        const Eigen::VectorXd& unit);

/// The inverse of an information matrix, with zero rows and columns for the parameters that are
/// held. Nothing if the rest is singular: the smallest eigenvalue, scaled to a unit diagonal, is at
/// most 1e-13.
[[nodiscard]] std::optional<Eigen::MatrixXd> CovarianceFromInformation(
    const Eigen::MatrixXd& information, const std::vector<bool>& fixed_parameters);

}  // namespace calibrato
