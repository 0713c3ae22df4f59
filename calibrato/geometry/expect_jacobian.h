#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <functional>

namespace calibrato {

/// Expects J = df/dx at x by central differences with Richardson extrapolation: the one numeric
/// check behind every analytic Jacobian. The tolerance is relative to the larger of 1 and the
/// largest entry of J; a step of 1e-4 leaves about 1e-10 of error for functions with derivatives
/// near one.
inline void ExpectJacobian(const std::function<Eigen::VectorXd(const Eigen::VectorXd&)>& f,
                           const Eigen::VectorXd& x, const Eigen::MatrixXd& J,
                           double tolerance = 1e-7, double step = 1e-4) {
  const Eigen::Index rows = f(x).size();
  ASSERT_EQ(J.rows(), rows);
  ASSERT_EQ(J.cols(), x.size());
  ASSERT_TRUE(J.allFinite()) << J;
  Eigen::MatrixXd numeric(rows, x.size());
  for (Eigen::Index k = 0; k < x.size(); ++k) {
    const auto central = [&](double h) -> Eigen::VectorXd {
      Eigen::VectorXd high = x;
      Eigen::VectorXd low = x;
      high(k) += h;
      low(k) -= h;
      return (f(high) - f(low)) / (2.0 * h);
    };
    numeric.col(k) = (4.0 * central(0.5 * step) - central(step)) / 3.0;
  }
  const double scale = std::max(1.0, J.cwiseAbs().maxCoeff());
  const double worst = (numeric - J).cwiseAbs().maxCoeff();
  EXPECT_TRUE(worst <= tolerance * scale) << "largest difference " << worst << "\nanalytic\n"
                                          << J << "\nnumeric\n"
                                          << numeric;
}

}  // namespace calibrato
