#include "calibrato/calibration/chi_square.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace calibrato {
namespace {

TEST(ChiSquareTail, IsAnExponentialForTwoDegrees) {
  for (const double x : {0.1, 1.0, 3.9, 4.1, 20.0, 300.0}) {
    EXPECT_NEAR(ChiSquareTail(x, 2.0) / std::exp(-0.5 * x), 1.0, 1e-10) << x;
  }
}

TEST(ChiSquareTail, IsTheNormalTailForOneDegree) {
  for (const double sigma : {0.5, 1.0, 3.0, 6.0}) {
    EXPECT_NEAR(ChiSquareTail(sigma * sigma, 1.0) / std::erfc(sigma / std::sqrt(2.0)), 1.0, 1e-10);
  }
  EXPECT_NEAR(ChiSquareTail(9.0, 1.0), kSignificance, 1e-5);
}

TEST(ChiSquareTail, AgreesWithTables) {
  EXPECT_NEAR(ChiSquareTail(15.507, 8.0), 0.05, 1e-5);
  EXPECT_NEAR(ChiSquareTail(26.124, 8.0), 0.001, 1e-6);
  EXPECT_NEAR(ChiSquareTail(124.342, 100.0), 0.05, 1e-5);
}

TEST(ChiSquareTail, ObeysTheRecurrenceOfTheGammaFunction) {
  // Q(a+1, x) = Q(a, x) + x^a e^-x / Gamma(a+1), also where series and fraction meet.
  for (const double degrees : {0.7, 3.0, 7.4, 80.0}) {
    for (const double value : {0.3, degrees, degrees + 1.9, degrees + 2.1, 2.0 * degrees + 9.0}) {
      const double a = 0.5 * degrees;
      const double x = 0.5 * value;
      const double step = std::exp(a * std::log(x) - x - std::lgamma(a + 1.0));
      EXPECT_NEAR(ChiSquareTail(value, degrees + 2.0), ChiSquareTail(value, degrees) + step, 1e-12);
    }
  }
}

TEST(ChiSquareTail, AtItsEnds) {
  EXPECT_EQ(ChiSquareTail(0.0, 3.0), 1.0);
  EXPECT_EQ(ChiSquareTail(std::numeric_limits<double>::infinity(), 3.0), 0.0);
  EXPECT_TRUE(std::isnan(ChiSquareTail(std::numeric_limits<double>::quiet_NaN(), 3.0)));
}

}  // namespace
}  // namespace calibrato
