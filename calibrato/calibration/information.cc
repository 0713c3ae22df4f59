#include "calibrato/calibration/information.h"

#include <Eigen/Eigenvalues>

namespace calibrato {

Information InformationOf(const Eigen::MatrixXd& covariance, const Eigen::VectorXd& unit) {
  const Eigen::VectorXd scale = unit.cwiseInverse();
  const Eigen::MatrixXd normalised = scale.asDiagonal() * covariance * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(normalised, Eigen::EigenvaluesOnly);
  Information information;
  information.eigenvalues = solver.eigenvalues();
  information.a_optimality = normalised.trace();
  information.d_optimality = information.eigenvalues.prod();
  information.e_optimality = information.eigenvalues(information.eigenvalues.size() - 1);
  return information;
}

std::optional<Eigen::MatrixXd> CovarianceFromInformation(
    const Eigen::MatrixXd& information, const std::vector<bool>& fixed_parameters) {
  std::vector<Eigen::Index> free;
  for (Eigen::Index i = 0; i < information.rows(); ++i) {
    const bool fixed = !fixed_parameters.empty() && fixed_parameters[static_cast<size_t>(i)];
    if (!fixed) free.push_back(i);
  }
  const Eigen::MatrixXd H = information(free, free);
  // Unit diagonal: parameters of different units become comparable, and rounding is judged fairly.
  if (!(H.diagonal().array() > 0.0).all()) return std::nullopt;
  const Eigen::VectorXd scale = H.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * H * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(scaled);
  if (!(solver.eigenvalues()(0) > 1e-13)) return std::nullopt;
  const Eigen::MatrixXd inverse = solver.eigenvectors() *
                                  solver.eigenvalues().cwiseInverse().asDiagonal() *
                                  solver.eigenvectors().transpose();
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(information.rows(), information.cols());
  covariance(free, free) = scale.asDiagonal() * inverse * scale.asDiagonal();
  return covariance;
}

}  // namespace calibrato
