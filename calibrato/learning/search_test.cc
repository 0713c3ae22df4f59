#include "calibrato/learning/search.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "calibrato/base/input_error.h"

namespace calibrato {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// A long valley at an angle to the axes: -sum of (10^(i / 3) times rotated coordinates)^2.
SearchObjective Valley(const VectorXd& top) {
  return [top](const MatrixXd& x, bool) {
    SearchValues values{VectorXd(x.cols()), {}};
    for (Eigen::Index i = 0; i < x.cols(); ++i) {
      const VectorXd away = x.col(i) - top;
      double sum = 0.0;
      for (Eigen::Index k = 0; k < away.size(); ++k) {
        const double next = away[(k + 1) % away.size()];
        const double rotated = (away[k] + next) / std::sqrt(2.0);
        sum += std::pow(10.0, k / 3.0) * rotated * rotated;
      }
      values.values[i] = -sum;
    }
    return values;
  };
}

VectorXd Top() {
  VectorXd top(9);
  top << 0.3, -0.2, 0.1, 0.0, 0.4, -0.4, 0.2, -0.1, 0.05;
  return top;
}

class EverySearch : public testing::TestWithParam<std::string> {
 protected:
  SearchResult Run(const SearchObjective& objective, int dimension, const SearchOptions& options,
                   uint64_t seed = 1) const {
    Rng rng(seed);
    return SearchFromName(GetParam())(objective, dimension, options, rng);
  }
};

TEST_P(EverySearch, UsesNoMoreThanItsBudgetAndStaysInTheBox) {
  for (const int budget : {1, 7, 250, 1000}) {
    SearchOptions options;
    options.limit = 0.25;
    options.num_evaluations = budget;
    int num_seen = 0;
    const SearchObjective objective = [&](const MatrixXd& x, bool want_gradients) {
      EXPECT_FALSE(want_gradients);
      EXPECT_LE(x.cwiseAbs().maxCoeff(), 0.25);
      num_seen += static_cast<int>(x.cols());
      return Valley(Top())(x, false);
    };
    const SearchResult result = Run(objective, 9, options);
    EXPECT_EQ(result.num_evaluations, num_seen);
    EXPECT_LE(num_seen, budget);
  }
}

TEST_P(EverySearch, FindsBetterThanRandomShootingDoes) {
  SearchOptions options;
  options.limit = 1.0;
  options.num_evaluations = 3000;
  const SearchResult result = Run(Valley(Top()), 9, options);
  EXPECT_NEAR(result.best_value, Valley(Top())(result.best_position, false).values[0], 1e-12);
  for (size_t i = 1; i < result.best_so_far.size(); ++i) {
    EXPECT_GE(result.best_so_far[i], result.best_so_far[i - 1]);
  }
  Rng rng(2);
  const SearchResult shot = SearchByRandomShooting(Valley(Top()), 9, options, rng);
  if (GetParam() == "random-shooting") {
    EXPECT_LT(result.best_value, -1.0);  // Nine dimensions are many.
  } else {
    EXPECT_GT(result.best_value, 0.5 * shot.best_value);
  }
}

TEST_P(EverySearch, FindsATopOnTheEdgeOfTheBox) {
  SearchOptions options;
  options.limit = 0.2;
  options.num_evaluations = 4000;
  const SearchObjective slope = [](const MatrixXd& x, bool) {
    return SearchValues{x.colwise().sum().transpose(), {}};
  };
  const SearchResult result = Run(slope, 3, options);
  EXPECT_GT(result.best_value, GetParam() == "random-shooting" ? 0.5 : 0.59);
}

TEST_P(EverySearch, BeginsWithWhatItIsGiven) {
  SearchOptions options;
  options.limit = 1.0;
  options.num_evaluations = 200;
  options.start = Top();
  EXPECT_GE(Run(Valley(Top()), 9, options).best_value, -1e-12);
}

TEST_P(EverySearch, IsTheSameForTheSameSeed) {
  SearchOptions options;
  options.num_evaluations = 500;
  EXPECT_EQ(Run(Valley(Top()), 9, options, 3).best_position,
            Run(Valley(Top()), 9, options, 3).best_position);
  EXPECT_NE(Run(Valley(Top()), 9, options, 3).best_position,
            Run(Valley(Top()), 9, options, 4).best_position);
}

TEST_P(EverySearch, PassesOverWhatIsNotANumber) {
  SearchOptions options;
  options.limit = 1.0;
  options.num_evaluations = 600;
  const SearchObjective broken = [](const MatrixXd& x, bool) {
    SearchValues values = Valley(Top())(x, false);
    for (Eigen::Index i = 0; i < x.cols(); i += 3) {
      values.values[i] = std::numeric_limits<double>::quiet_NaN();
    }
    return values;
  };
  const SearchResult result = Run(broken, 9, options);
  EXPECT_TRUE(std::isfinite(result.best_value));
  EXPECT_TRUE(result.best_position.allFinite());
}

INSTANTIATE_TEST_SUITE_P(Methods, EverySearch, testing::ValuesIn(SearchNames()),
                         [](const auto& info) {
                           std::string name = info.param;
                           std::erase(name, '-');
                           return name;
                         });

TEST(SearchFromName, RefusesAnUnknownPlanner) {
  EXPECT_THROW((void)SearchFromName("simulated-annealing"), InputError);
}

// Textbook behaviour: the valley is followed to rounding, which no method without a full
// covariance does in as few evaluations.
TEST(CmaEs, FollowsALongValleyToItsEnd) {
  SearchOptions options;
  options.limit = 1.0;
  options.num_evaluations = 6000;
  Rng rng(5);
  EXPECT_GT(SearchByCmaEs(Valley(Top()), 9, options, rng).best_value, -1e-10);
}

}  // namespace
}  // namespace calibrato
