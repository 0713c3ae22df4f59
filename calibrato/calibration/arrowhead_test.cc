#include "calibrato/calibration/arrowhead.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <array>

#include "calibrato/base/rng.h"

namespace calibrato {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

struct Problem {
  ArrowheadSystem system;
  MatrixXd J;  // the same measurements as dense rows, with the residual as the last column
};

Problem RandomProblem(int num_blocks, int block_size, int border_size, uint64_t seed) {
  Rng rng(seed);
  Problem problem{ArrowheadSystem(num_blocks, block_size, border_size), {}};
  const int size = problem.system.local_size();
  const int rows = 3 * size;
  const int n = problem.system.num_unknowns();
  problem.J = MatrixXd::Zero((num_blocks - 1) * rows + border_size, n + 1);
  for (int c = 0; c + 1 < num_blocks; ++c) {
    MatrixXd local(rows, size);
    for (double& entry : local.reshaped()) entry = rng.Normal();
    problem.system.Add(c, local.transpose() * local);
    auto dense = problem.J.middleRows(c * rows, rows);
    dense.middleCols(c * block_size, 2 * block_size) = local.leftCols(2 * block_size);
    dense.rightCols(border_size + 1) = local.rightCols(border_size + 1);
  }
  MatrixXd prior(border_size, border_size + 1);
  for (double& entry : prior.reshaped()) entry = rng.Normal();
  problem.system.AddToBorder(prior.transpose() * prior);
  problem.J.bottomRightCorner(border_size, border_size + 1) = prior;
  return problem;
}

TEST(Arrowhead, HoldsTheNormalEquationsOfItsRows) {
  const Problem problem = RandomProblem(5, 4, 3, 1);
  const MatrixXd full = problem.J.transpose() * problem.J;
  const auto n = full.rows() - 1;
  EXPECT_LT((problem.system.Dense() - full.topLeftCorner(n, n)).norm(), 1e-10);
  EXPECT_LT((problem.system.Gradient() - full.col(n).head(n)).norm(), 1e-10);
  EXPECT_LT((problem.system.Diagonal() - full.diagonal().head(n)).norm(), 1e-10);
  EXPECT_NEAR(problem.system.squared_error(), full(n, n), 1e-10);
}

TEST(Arrowhead, AgreesWithADenseSolver) {
  for (const auto& [num_blocks, block_size, border_size] :
       {std::array{2, 1, 1}, std::array{7, 5, 4}, std::array{12, 36, 17}, std::array{3, 40, 0}}) {
    const Problem problem = RandomProblem(num_blocks, block_size, border_size, 2);
    for (const double damping : {0.0, 0.1}) {
      MatrixXd H = problem.system.Dense();
      H.diagonal() *= 1.0 + damping;
      const auto factor = ArrowheadCholesky::Factor(problem.system, damping);
      ASSERT_TRUE(factor.has_value());
      const VectorXd expected = -H.ldlt().solve(problem.system.Gradient());
      EXPECT_LT((factor->Step() - expected).norm(), 1e-9 * expected.norm());
      Rng rng(4);
      MatrixXd right_sides(H.rows(), 3);
      for (double& entry : right_sides.reshaped()) entry = rng.Normal();
      const MatrixXd solved = H.ldlt().solve(right_sides);
      EXPECT_LT((factor->Solve(right_sides) - solved).norm(), 1e-9 * solved.norm());
      const MatrixXd marginal = H.inverse().bottomRightCorner(border_size, border_size);
      const MatrixXd identity = factor->BorderInformation() * marginal;
      EXPECT_LT((identity - MatrixXd::Identity(border_size, border_size)).norm(), 1e-9);
      EXPECT_NEAR(factor->LogDeterminant(),
                  2.0 * H.llt().matrixLLT().diagonal().array().log().sum(), 1e-9);
    }
  }
}

TEST(Arrowhead, RefusesWhatIsNotPositiveDefinite) {
  ArrowheadSystem system(3, 4, 2);
  EXPECT_FALSE(ArrowheadCholesky::Factor(system, 0.0).has_value());
  // A border unknown that nothing sees.
  ArrowheadSystem unseen(3, 4, 2);
  Rng rng(4);
  for (int c = 0; c < 2; ++c) {
    MatrixXd local(40, 11);
    for (double& entry : local.reshaped()) entry = rng.Normal();
    local.col(9).setZero();
    unseen.Add(c, local.transpose() * local);
  }
  EXPECT_FALSE(ArrowheadCholesky::Factor(unseen, 0.0).has_value());
}

TEST(Arrowhead, SetZeroForgetsEverything) {
  Problem problem = RandomProblem(3, 4, 2, 5);
  problem.system.SetZero();
  EXPECT_EQ(problem.system.squared_error(), 0.0);
  EXPECT_EQ(problem.system.Dense().norm(), 0.0);
}

}  // namespace
}  // namespace calibrato
