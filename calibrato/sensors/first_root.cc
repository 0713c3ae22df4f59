#include "calibrato/sensors/first_root.h"

#include <algorithm>
#include <limits>

namespace calibrato {
namespace {

// Lowest power first.
double Evaluate(const std::vector<double>& polynomial, double s) {
  double value = 0.0;
  for (size_t i = polynomial.size(); i-- > 0;) value = value * s + polynomial[i];
  return value;
}

// A root between two points at which the signs differ: the side of `low`.
double Bisect(const std::vector<double>& polynomial, double low, double high) {
  const bool low_is_positive = Evaluate(polynomial, low) > 0.0;
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (low + high);
    if (middle == low || middle == high) break;
    ((Evaluate(polynomial, middle) > 0.0) == low_is_positive ? low : high) = middle;
  }
  return low;
}

// Where the polynomial changes its sign in (0, end), ascending. Between the points at which its
// derivative changes sign it is monotone, and has one root at most.
std::vector<double> SignChanges(const std::vector<double>& polynomial, double end) {
  if (polynomial.size() < 2) return {};
  std::vector<double> derivative;
  for (size_t i = 1; i < polynomial.size(); ++i) {
    derivative.push_back(static_cast<double>(i) * polynomial[i]);
  }
  std::vector<double> ends = SignChanges(derivative, end);
  ends.push_back(end);
  std::vector<double> roots;
  double low = 0.0;
  for (const double high : ends) {
    if ((Evaluate(polynomial, low) > 0.0) != (Evaluate(polynomial, high) > 0.0)) {
      roots.push_back(Bisect(polynomial, low, high));
    }
    low = high;
  }
  return roots;
}

}  // namespace

double FirstRoot(const std::vector<double>& coefficients, double end) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  if (std::all_of(coefficients.begin(), coefficients.end(), [](double a) { return a >= 0.0; })) {
    return kNone;
  }
  std::vector<double> polynomial = {1.0};
  polynomial.insert(polynomial.end(), coefficients.begin(), coefficients.end());
  const std::vector<double> roots = SignChanges(polynomial, end);
  return roots.empty() ? kNone : roots.front();
}

}  // namespace calibrato
