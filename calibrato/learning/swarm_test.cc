#include "calibrato/learning/swarm.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace calibrato {
namespace {

// -|x - centre|^2, whose gradient is -2 (x - centre).
SearchObjective Bowl(const Eigen::VectorXd& centre) {
  return [centre](const Eigen::MatrixXd& x, bool want_gradients) {
    const Eigen::MatrixXd away = x.colwise() - centre;
    SearchValues values{-away.colwise().squaredNorm().transpose(), {}};
    if (want_gradients) values.gradients = -2.0 * away;
    return values;
  };
}

SwarmOptions Options() {
  SwarmOptions options;
  options.limit = 1.0;
  return options;
}

const Eigen::MatrixXd kNoStart(2, 0);

TEST(Swarm, MovesByEquationsSevenAndEight) {
  SwarmOptions options = Options();
  options.num_particles = 2;
  options.num_iterations = 2;
  options.inertia_weight = 0.5;
  options.social_weight = 0.1;
  options.gradient_weight = 0.01;
  Eigen::MatrixXd start(1, 2);
  start << 0.2, -0.4;
  Rng rng(1);
  const SwarmResult result =
      MaximiseBySwarm(Bowl(Eigen::VectorXd::Zero(1)), 1, start, options, rng);
  // Second particle by hand: G_best is the first one's place.
  //   v1 = 0.1 (0.2 + 0.4) + 0.01 * 0.8 = 0.068,                           P1 = -0.332
  // The first: v1 = 0.01 * -0.4 = -0.004, P1 = 0.196, the new G_best.
  //   v2 = 0.5 * 0.068 + 0.1 (0.196 + 0.332) + 0.01 * 0.664 = 0.09344,     P2 = -0.23856
  //   the first: v2 = 0.5 * -0.004 + 0.01 * -0.392 = -0.00592,             P2 = 0.19008
  EXPECT_NEAR(result.positions(0, 0), 0.19008, 1e-12);
  EXPECT_NEAR(result.positions(0, 1), -0.23856, 1e-12);
  EXPECT_NEAR(result.values[0], -0.19008 * 0.19008, 1e-12);
  EXPECT_NEAR(result.best_position[0], 0.19008, 1e-12);
}

TEST(Swarm, ClimbsAConcaveFunctionToItsTop) {
  SwarmOptions options = Options();
  options.num_iterations = 200;
  options.gradient_weight = 0.1;
  const Eigen::VectorXd top = Eigen::Vector2d(0.3, -0.7);
  Rng rng(2);
  const SwarmResult result = MaximiseBySwarm(Bowl(top), 2, kNoStart, options, rng);
  for (Eigen::Index i = 0; i < result.positions.cols(); ++i) {
    EXPECT_LT((result.positions.col(i) - top).norm(), 1e-4);
  }
}

TEST(Swarm, SocialTermAlonePullsAllToTheBestPosition) {
  SwarmOptions options = Options();
  options.num_iterations = 100;
  options.gradient_weight = 0.0;
  options.social_weight = 0.2;
  options.inertia_weight = 0.0;
  Rng rng(3);
  const SwarmResult result =
      MaximiseBySwarm(Bowl(Eigen::Vector2d(0.3, -0.7)), 2, kNoStart, options, rng);
  for (Eigen::Index i = 0; i < result.positions.cols(); ++i) {
    EXPECT_LT((result.positions.col(i) - result.best_position).norm(), 1e-6);
  }
}

TEST(Swarm, StaysWithinTheLimit) {
  SwarmOptions options = Options();
  options.num_iterations = 50;
  options.gradient_weight = 0.1;
  Rng rng(4);
  const SwarmResult result =
      MaximiseBySwarm(Bowl(Eigen::Vector2d(3.0, 0.5)), 2, kNoStart, options, rng);
  EXPECT_EQ(result.positions(0, 0), 1.0);
  EXPECT_LE(result.positions.cwiseAbs().maxCoeff(), 1.0);
}

TEST(Swarm, StartsAtWhatIsRememberedAndAtFreshPlaces) {
  SwarmOptions options = Options();
  options.num_iterations = 0;
  options.num_particles = 4;
  Eigen::MatrixXd start(2, 2);
  start << 0.5, 5.0,  //
      0.25, -5.0;
  Rng rng(5);
  const SwarmResult result =
      MaximiseBySwarm(Bowl(Eigen::Vector2d(0.5, 0.25)), 2, start, options, rng);
  ASSERT_EQ(result.positions.cols(), 4);
  EXPECT_EQ(result.positions.col(0), Eigen::Vector2d(0.5, 0.25));
  int num_clipped = 0;
  for (Eigen::Index i = 1; i < 4; ++i) {
    if (result.positions.col(i) == Eigen::Vector2d(1.0, -1.0)) ++num_clipped;
  }
  EXPECT_EQ(num_clipped, 1);
}

TEST(Swarm, DrawsFreshParticlesOverTheWholeRange) {
  SwarmOptions options = Options();
  options.num_iterations = 0;
  options.num_particles = 2000;
  options.limit = 0.015;
  Rng rng(6);
  const SwarmResult result =
      MaximiseBySwarm(Bowl(Eigen::Vector2d::Zero()), 2, kNoStart, options, rng);
  EXPECT_LE(result.positions.maxCoeff(), 0.015);
  EXPECT_GT(result.positions.maxCoeff(), 0.0149);
  EXPECT_LT(result.positions.minCoeff(), -0.0149);
  // Standard deviation of the mean of 4000 draws: 0.015 / sqrt(3 * 4000) = 1.4e-4.
  EXPECT_NEAR(result.positions.mean(), 0.0, 6e-4);
}

TEST(Swarm, KeepsTheBestPositionEverSeenThoughParticlesMoveOn) {
  SwarmOptions options = Options();
  options.num_particles = 3;
  options.num_iterations = 1;
  options.gradient_weight = 1.0;  // So long a step that it jumps across the top: x -> -x.
  options.social_weight = 0.0;
  Eigen::MatrixXd start(1, 3);
  start << 0.1, 0.8, 0.9;
  const SearchObjective jumpy = [](const Eigen::MatrixXd& x, bool) {
    return SearchValues{-x.row(0).array().abs().transpose(), Eigen::MatrixXd::Constant(1, 3, 0.5)};
  };
  Rng rng(7);
  const SwarmResult result = MaximiseBySwarm(jumpy, 1, start, options, rng);
  EXPECT_EQ(result.best_position[0], 0.1);
  EXPECT_EQ(result.best_value, -0.1);
  EXPECT_DOUBLE_EQ(result.values[0], -0.6);  // Freshly evaluated where they ended.
}

TEST(Swarm, RanksNanBelowAllElse) {
  SwarmOptions options = Options();
  options.num_particles = 3;
  options.num_iterations = 0;
  Eigen::MatrixXd start(1, 3);
  start << 0.1, 0.2, 0.3;
  const SearchObjective broken = [](const Eigen::MatrixXd&, bool) {
    return SearchValues{Eigen::Vector3d(std::numeric_limits<double>::quiet_NaN(), -5.0, -1.0), {}};
  };
  Rng rng(8);
  const SwarmResult result = MaximiseBySwarm(broken, 1, start, options, rng);
  EXPECT_EQ(result.best_position[0], 0.3);
  EXPECT_EQ(result.values[0], -1.0);
  EXPECT_EQ(result.values[1], -5.0);
  EXPECT_TRUE(std::isnan(result.values[2]));
}

// A slope of 1 along every coordinate: the paper's step is the gradient weight, the original's less
// than a tenth of it.
TEST(MaximiseBySwarm, StandsNearlyStillWhereItIsFrozen) {
  const SearchObjective slope = [](const Eigen::MatrixXd& positions, bool want_gradients) {
    SearchValues values{positions.colwise().sum(), {}};
    if (want_gradients) {
      values.gradients = Eigen::MatrixXd::Ones(positions.rows(), positions.cols());
    }
    return values;
  };
  SwarmOptions options;
  options.num_iterations = 5;
  const Eigen::MatrixXd start = Eigen::MatrixXd::Zero(3, options.num_particles);
  const auto way = [&](bool frozen) {
    options.frozen = frozen;
    Rng rng(1);
    return MaximiseBySwarm(slope, 3, start, options, rng).positions.mean();
  };
  EXPECT_GT(way(false), 5.0 * options.gradient_weight * 0.99);
  EXPECT_LT(way(true), 5.0 * options.gradient_weight * 0.1);
  EXPECT_GT(way(true), 0.0);
}

TEST(MaximiseBySwarm, TellsHowItConverged) {
  const SearchObjective height = [](const Eigen::MatrixXd& positions, bool want_gradients) {
    SearchValues values{-positions.colwise().squaredNorm().transpose(), {}};
    if (want_gradients) values.gradients = -2.0 * positions;
    return values;
  };
  SwarmOptions options;
  options.gradient_weight = 0.1;
  Rng rng(1);
  const SwarmResult result = MaximiseBySwarm(height, 4, Eigen::MatrixXd(4, 0), options, rng);
  ASSERT_EQ(result.best_so_far.size(), 6U);
  for (size_t i = 1; i < 6; ++i) EXPECT_GT(result.best_so_far[i], result.best_so_far[i - 1]);
  EXPECT_EQ(result.best_so_far.back(), result.best_value);
}

}  // namespace
}  // namespace calibrato
