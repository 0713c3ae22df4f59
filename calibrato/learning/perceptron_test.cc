#include "calibrato/learning/perceptron.h"

#include <gtest/gtest.h>

namespace calibrato {
namespace {

Eigen::MatrixXd RandomMatrix(Eigen::Index rows, Eigen::Index columns, Rng& rng) {
  Eigen::MatrixXd matrix(rows, columns);
  for (double& x : matrix.reshaped()) x = rng.Normal();
  return matrix;
}

TEST(Perceptron, HasTheGradientsOfItsOutput) {
  Rng rng(1);
  Perceptron network(3, 5, 2, rng);
  const Eigen::MatrixXd input = RandomMatrix(3, 4, rng);
  const Eigen::MatrixXd weights = RandomMatrix(2, 4, rng);
  const auto loss = [&](const Eigen::MatrixXd& x) {
    return network.Forward(x).output.cwiseProduct(weights).sum();
  };
  const Eigen::MatrixXd by_input = network.Backward(network.Forward(input), weights);
  EXPECT_TRUE(by_input.isApprox(network.InputGradient(network.Forward(input), weights)));
  constexpr double kStep = 1e-6;
  for (Eigen::Index i = 0; i < input.size(); ++i) {
    Eigen::MatrixXd moved = input;
    moved.reshaped()[i] += kStep;
    const double above = loss(moved);
    moved.reshaped()[i] -= 2.0 * kStep;
    EXPECT_NEAR((above - loss(moved)) / (2.0 * kStep), by_input.reshaped()[i], 1e-7);
  }
  const Eigen::VectorXd gradient = network.gradient();
  for (Eigen::Index i = 0; i < gradient.size(); ++i) {
    const double before = network.weights()[i];
    network.mutable_weights()[i] = before + kStep;
    const double above = loss(input);
    network.mutable_weights()[i] = before - kStep;
    const double below = loss(input);
    network.mutable_weights()[i] = before;
    EXPECT_NEAR((above - below) / (2.0 * kStep), gradient[i], 1e-7);
  }
}

TEST(Perceptron, LearnsAProductAndComesBackFromItsBytes) {
  Rng rng(2);
  Perceptron network(2, 32, 1, rng);
  const Eigen::MatrixXd input = RandomMatrix(2, 50, rng);
  const Eigen::RowVectorXd wanted = input.row(0).cwiseProduct(input.row(1));
  double first = 0.0;
  double last = 0.0;
  for (int i = 0; i < 500; ++i) {
    const Perceptron::Pass pass = network.Forward(input);
    last = (pass.output - wanted).squaredNorm() / 50.0;
    if (i == 0) first = last;
    (void)network.Backward(pass, (pass.output - wanted) / 25.0);
    network.Step(1e-2);
  }
  EXPECT_LT(last, 0.02 * first);

  ByteWriter writer;
  network.Write(writer);
  Rng other(3);
  Perceptron copy(2, 32, 1, other);
  ByteReader reader(writer.bytes(), "bytes");
  EXPECT_TRUE(copy.Read(reader));
  EXPECT_EQ(copy.Forward(input).output, network.Forward(input).output);
  Perceptron small(2, 16, 1, other);
  ByteReader again(writer.bytes(), "bytes");
  EXPECT_FALSE(small.Read(again));
}

}  // namespace
}  // namespace calibrato
