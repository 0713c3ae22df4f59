#include "calibrato/sensors/first_root.h"

#include <gtest/gtest.h>

#include <cmath>

namespace calibrato {
namespace {

// The coefficients a1, a2, .. of the product of (1 - s / root).
std::vector<double> FromRoots(const std::vector<double>& roots) {
  std::vector<double> polynomial = {1.0};
  for (const double root : roots) {
    polynomial.push_back(0.0);
    for (size_t i = polynomial.size() - 1; i > 0; --i) polynomial[i] -= polynomial[i - 1] / root;
  }
  return {polynomial.begin() + 1, polynomial.end()};
}

TEST(FirstRoot, IsTheSmallestPositiveOne) {
  EXPECT_NEAR(FirstRoot(FromRoots({2.0}), 10.0), 2.0, 1e-14);
  EXPECT_NEAR(FirstRoot(FromRoots({3.0, -1.0}), 10.0), 3.0, 1e-14);
  EXPECT_NEAR(FirstRoot(FromRoots({3.0, 0.5, 2.0}), 10.0), 0.5, 1e-14);
  EXPECT_NEAR(FirstRoot(FromRoots({5.0, 4.0, 1.5, 2.0}), 10.0), 1.5, 1e-12);
  EXPECT_NEAR(FirstRoot(FromRoots({-5.0, -4.0, -1.5, 7.0}), 10.0), 7.0, 1e-12);
}

TEST(FirstRoot, IsApproachedFromBelow) {
  const std::vector<double> coefficients = FromRoots({3.0, 0.7, 2.0});
  const double s = FirstRoot(coefficients, 10.0);
  EXPECT_GE(1.0 + s * (coefficients[0] + s * (coefficients[1] + s * coefficients[2])), 0.0);
}

TEST(FirstRoot, IsInfiniteWithoutOneBeforeTheEnd) {
  EXPECT_TRUE(std::isinf(FirstRoot({}, 10.0)));
  EXPECT_TRUE(std::isinf(FirstRoot({0.0, 0.0, 0.0}, 10.0)));
  EXPECT_TRUE(std::isinf(FirstRoot({0.3, 0.0, 2.0}, 10.0)));
  EXPECT_TRUE(std::isinf(FirstRoot(FromRoots({12.0}), 10.0)));
  // 1 - s + s^2 has no real root; nor has its square.
  EXPECT_TRUE(std::isinf(FirstRoot({-1.0, 1.0}, 10.0)));
  EXPECT_TRUE(std::isinf(FirstRoot({-2.0, 3.0, -2.0, 1.0}, 10.0)));
}

}  // namespace
}  // namespace calibrato
