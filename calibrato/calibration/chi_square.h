#pragma once

namespace calibrato {

/// The probability that a chi-square variable exceeds a value by chance: small means that what was
/// observed is not chance.
///
///     P(X > value) = Q(degrees / 2, value / 2), the regularised upper incomplete gamma function
///
/// by its series below degrees + 2 and Lentz's continued fraction above (Numerical Recipes, section
/// 6.2); relative error below 1e-10.
/// @param value    >= 0; NaN gives NaN.
/// @param degrees  Degrees of freedom, > 0; not necessarily whole.
[[nodiscard]] double ChiSquareTail(double value, double degrees);

/// Beyond this probability of chance a difference is called significant: three sigma of a normal
/// variable, two-sided.
inline constexpr double kSignificance = 0.0027;

}  // namespace calibrato
