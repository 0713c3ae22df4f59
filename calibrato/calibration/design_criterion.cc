#include "calibrato/calibration/design_criterion.h"

#include <Eigen/Eigenvalues>

namespace calibrato {

CriterionValue EvaluateCriterion(DesignCriterion criterion, const Eigen::MatrixXd& covariance,
                                 const Eigen::VectorXd& unit) {
  const Eigen::VectorXd scale = unit.cwiseInverse();
  const Eigen::MatrixXd normalised = scale.asDiagonal() * covariance * scale.asDiagonal();
  if (criterion == DesignCriterion::kA) {
    return {normalised.trace(), scale.asDiagonal()};
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(normalised);
  const Eigen::VectorXd& eigenvalues = solver.eigenvalues();
  if (criterion == DesignCriterion::kE) {
    const Eigen::Index last = eigenvalues.size() - 1;
    return {eigenvalues(last), scale.asDiagonal() * solver.eigenvectors().col(last)};
  }
  // d log det C_n = tr(C_n^-1 dC_n), and V diag(lambda)^-1/2 is a root of C_n^-1.
  return {eigenvalues.array().log().sum(), scale.asDiagonal() * solver.eigenvectors() *
                                               eigenvalues.cwiseSqrt().cwiseInverse().asDiagonal()};
}

}  // namespace calibrato
