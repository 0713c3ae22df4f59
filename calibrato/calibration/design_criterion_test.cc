#include "calibrato/calibration/design_criterion.h"

#include <gtest/gtest.h>

#include <cmath>

#include "calibrato/base/rng.h"
#include "calibrato/calibration/information.h"

namespace calibrato {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd RandomMatrix(Rng& rng, int rows, int cols) {
  MatrixXd matrix(rows, cols);
  for (double& entry : matrix.reshaped()) entry = rng.Normal();
  return matrix;
}

TEST(DesignCriterion, IsThatOfInformation) {
  Rng rng(1);
  const MatrixXd root = RandomMatrix(rng, 4, 6);
  const MatrixXd C = root * root.transpose();
  const VectorXd unit = Eigen::Vector4d(1.0, 0.1, 2.0, 0.5);
  const Information information = InformationOf(C, unit);
  const auto value = [&](DesignCriterion criterion) {
    return EvaluateCriterion(criterion, C, unit).value;
  };
  EXPECT_NEAR(value(DesignCriterion::kA), information.a_optimality, 1e-9);
  EXPECT_NEAR(value(DesignCriterion::kD), std::log(information.d_optimality), 1e-9);
  EXPECT_NEAR(value(DesignCriterion::kE), information.e_optimality, 1e-9);
}

TEST(DesignCriterion, ItsRootGivesTheDerivativeByTheCovariance) {
  Rng rng(2);
  const MatrixXd spread = RandomMatrix(rng, 5, 9);
  const MatrixXd C = spread * spread.transpose();
  const MatrixXd skewed = RandomMatrix(rng, 5, 5);
  const MatrixXd direction = skewed + skewed.transpose();
  const VectorXd unit = VectorXd::LinSpaced(5, 0.5, 2.0);
  for (const auto criterion : {DesignCriterion::kA, DesignCriterion::kD, DesignCriterion::kE}) {
    const CriterionValue value = EvaluateCriterion(criterion, C, unit);
    const double analytic = (value.root.transpose() * direction * value.root).trace();
    constexpr double kStep = 1e-5;
    const double numeric = (EvaluateCriterion(criterion, C + kStep * direction, unit).value -
                            EvaluateCriterion(criterion, C - kStep * direction, unit).value) /
                           (2.0 * kStep);
    EXPECT_NEAR(analytic, numeric, 1e-6 * std::abs(numeric)) << static_cast<int>(criterion);
  }
}

}  // namespace
}  // namespace calibrato
