#include "calibrato/calibration/chi_square.h"

#include <cassert>
#include <cmath>
#include <limits>

namespace calibrato {
namespace {

constexpr double kPrecision = 1e-15;
constexpr int kMaxTerms = 100000;

// P(a, x) as a power series: x^a e^-x / Gamma(a) times the sum of x^n / (a (a+1) .. (a+n)).
double LowerSeries(double a, double x) {
  double term = 1.0 / a;
  double sum = term;
  for (int n = 1; n < kMaxTerms && term > kPrecision * sum; ++n) {
    term *= x / (a + n);
    sum += term;
  }
  return sum;
}

// Q(a, x) without the same factor: 1 / (x+1-a - 1(1-a) / (x+3-a - 2(2-a) / ..)).
double UpperFraction(double a, double x) {
  constexpr double kTiny = std::numeric_limits<double>::min() / kPrecision;
  double b = x + 1.0 - a;
  double c = 1.0 / kTiny;
  double d = 1.0 / b;
  double fraction = d;
  for (int n = 1; n < kMaxTerms; ++n) {
    const double numerator = -n * (n - a);
    b += 2.0;
    d = 1.0 / (numerator * d + b);
    c = b + numerator / c;
    fraction *= c * d;
    if (std::abs(c * d - 1.0) < kPrecision) break;
  }
  return fraction;
}

}  // namespace

double ChiSquareTail(double value, double degrees) {
  assert(degrees > 0.0);
  if (!(value > 0.0)) return std::isnan(value) ? value : 1.0;
  if (std::isinf(value)) return 0.0;
  const double a = 0.5 * degrees;
  const double x = 0.5 * value;
  const double factor = std::exp(a * std::log(x) - x - std::lgamma(a));
  return x < a + 1.0 ? 1.0 - factor * LowerSeries(a, x) : factor * UpperFraction(a, x);
}

}  // namespace calibrato
