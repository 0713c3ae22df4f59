#pragma once

#include <array>

namespace calibrato {

/// Cumulative uniform B-spline basis of order k and its derivatives to u, at u in [0, 1] of one
/// segment: lambda_j(u), j = 0 .. k - 1, with lambda_0 = 1. The ordinary basis is
/// lambda_j - lambda_{j+1}.
///
/// Source: Sommer et al., CVPR 2020, equations 14 to 18 (Qin, "General matrix representations for
/// B-splines", 2000).
template <int kOrder>
struct SplineBasis {
  std::array<double, kOrder> value;
  std::array<double, kOrder> first;
  std::array<double, kOrder> second;
  std::array<double, kOrder> third;
};

namespace spline_basis_internal {

constexpr double Binomial(int n, int k) {
  double result = 1.0;
  for (int i = 1; i <= k; ++i) result = result * (n - k + i) / i;
  return result;
}

constexpr double Power(double x, int n) {
  double result = 1.0;
  for (int i = 0; i < n; ++i) result *= x;
  return result;
}

// Row j: the coefficients of lambda_j(u) in powers of u.
template <int kOrder>
constexpr std::array<std::array<double, kOrder>, kOrder> CumulativeMatrix() {
  std::array<std::array<double, kOrder>, kOrder> matrix{};
  const double factorial = [] {
    double product = 1.0;
    for (int i = 2; i < kOrder; ++i) product *= i;
    return product;
  }();
  // The ordinary basis first, then its sums from the end.
  for (int s = 0; s < kOrder; ++s) {
    for (int n = 0; n < kOrder; ++n) {
      double sum = 0.0;
      for (int l = s; l < kOrder; ++l) {
        sum += ((l - s) % 2 == 0 ? 1.0 : -1.0) * Binomial(kOrder, l - s) *
               Power(kOrder - 1.0 - l, kOrder - 1 - n);
      }
      matrix[s][n] = Binomial(kOrder - 1, n) / factorial * sum;
    }
  }
  for (int s = kOrder - 2; s >= 0; --s) {
    for (int n = 0; n < kOrder; ++n) matrix[s][n] += matrix[s + 1][n];
  }
  return matrix;
}

}  // namespace spline_basis_internal

template <int kOrder>
SplineBasis<kOrder> CumulativeBasis(double u) {
  static constexpr auto kMatrix = spline_basis_internal::CumulativeMatrix<kOrder>();
  SplineBasis<kOrder> basis;
  for (int j = 0; j < kOrder; ++j) {
    // Horner's scheme for the polynomial and its derivatives at once.
    double value = 0.0;
    double first = 0.0;
    double half_second = 0.0;
    double sixth_third = 0.0;
    for (int n = kOrder - 1; n >= 0; --n) {
      sixth_third = sixth_third * u + half_second;
      half_second = half_second * u + first;
      first = first * u + value;
      value = value * u + kMatrix[j][n];
    }
    basis.value[j] = value;
    basis.first[j] = first;
    basis.second[j] = 2.0 * half_second;
    basis.third[j] = 6.0 * sixth_third;
  }
  return basis;
}

}  // namespace calibrato
