#include "calibrato/geometry/spline_basis.h"

#include <gtest/gtest.h>

namespace calibrato {
namespace {

TEST(CumulativeBasis, CubicAtAKnotIsOneFourOneSixths) {
  // The ordinary cubic basis at a knot is 1/6, 4/6, 1/6, 0; lambda_j sums it from the end.
  const auto basis = CumulativeBasis<4>(0.0);
  EXPECT_NEAR(basis.value[0], 1.0, 1e-15);
  EXPECT_NEAR(basis.value[1], 5.0 / 6.0, 1e-15);
  EXPECT_NEAR(basis.value[2], 1.0 / 6.0, 1e-15);
  EXPECT_NEAR(basis.value[3], 0.0, 1e-15);
}

// Points on a line, c_j = j, give the line t = u + (k - 2) / 2 at speed 1.
template <int kOrder>
void ExpectLine() {
  for (const double u : {0.0, 0.3, 0.77, 1.0}) {
    const auto basis = CumulativeBasis<kOrder>(u);
    double value = 0.0;
    double first = 0.0;
    double second = 0.0;
    double third = 0.0;
    for (int j = 1; j < kOrder; ++j) {
      value += basis.value[j];
      first += basis.first[j];
      second += basis.second[j];
      third += basis.third[j];
    }
    EXPECT_NEAR(value, u + 0.5 * (kOrder - 2), 1e-13);
    EXPECT_NEAR(first, 1.0, 1e-13);
    EXPECT_NEAR(second, 0.0, 1e-12);
    EXPECT_NEAR(third, 0.0, 1e-12);
  }
}

TEST(CumulativeBasis, ReproducesALine) {
  ExpectLine<4>();
  ExpectLine<5>();
  ExpectLine<6>();
}

// Where one segment ends the next begins: lambda_j(1) = lambda_{j-1}(0), and so the derivatives.
template <int kOrder>
void ExpectSmoothAtTheKnot() {
  const auto end = CumulativeBasis<kOrder>(1.0);
  const auto begin = CumulativeBasis<kOrder>(0.0);
  for (int j = 1; j < kOrder; ++j) {
    EXPECT_NEAR(end.value[j], begin.value[j - 1], 1e-13);
    EXPECT_NEAR(end.first[j], begin.first[j - 1], 1e-13);
    EXPECT_NEAR(end.second[j], begin.second[j - 1], 1e-12);
    // A cubic's third derivative jumps at knots.
    if (kOrder > 4) {
      EXPECT_NEAR(end.third[j], begin.third[j - 1], 1e-12);
    }
  }
}

TEST(CumulativeBasis, IsSmoothAtTheKnot) {
  ExpectSmoothAtTheKnot<4>();
  ExpectSmoothAtTheKnot<5>();
  ExpectSmoothAtTheKnot<6>();
}

}  // namespace
}  // namespace calibrato
