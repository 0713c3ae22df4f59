#include "calibrato/sensors/radial_tangential.h"

#include <Eigen/LU>

#include "calibrato/sensors/first_root.h"

namespace calibrato {
namespace {

// A pinhole lens that reaches this squared radius sees 179 degrees: beyond any there is.
constexpr double kEnd = 1e4;

// Relative to the focal length: 1e-9 px and 1e-6 px at a thousand pixels.
constexpr double kTolerance = 1e-12;
constexpr double kToleranceOfRounding = 1e-9;

}  // namespace

template <int kNumCoefficients>
RadialTangential<kNumCoefficients>::RadialTangential(const Coefficients& coefficients)
    : coefficients_(coefficients) {
  if constexpr (kNumCoefficients > 0) {
    double k3 = 0.0;
    if constexpr (kNumCoefficients == 5) k3 = coefficients(4);
    // The derivative of r c(r^2) by r.
    max_squared_radius_ = FirstRoot({3.0 * coefficients(0), 5.0 * coefficients(1), 7.0 * k3}, kEnd);
  }
}

template <int kNumCoefficients>
std::optional<Eigen::Vector2d> RadialTangential<kNumCoefficients>::Undistort(
    const Eigen::Vector2d& distorted) const {
  if (!distorted.allFinite()) return std::nullopt;
  if constexpr (kNumCoefficients == 0) return distorted;

  // Newton with the step halved while it leaves the domain or does not come nearer; from the centre
  // outwards where the distorted point itself lies outside the domain.
  const auto residual = [&](const Eigen::Vector2d& m, Eigen::Vector2d* difference,
                            Eigen::Matrix2d* J) {
    if (!Distort(m, difference, J, nullptr)) return false;
    *difference -= distorted;
    return true;
  };
  const double scale_of_rounding = 1.0 + distorted.norm();
  Eigen::Vector2d m = distorted;
  if (!(m.squaredNorm() < 0.5 * max_squared_radius_)) m.setZero();
  Eigen::Vector2d difference;
  Eigen::Matrix2d J;
  for (int iteration = 0; iteration < 50; ++iteration) {
    if (!residual(m, &difference, &J)) return std::nullopt;
    if (difference.norm() < kTolerance * scale_of_rounding) return m;
    const Eigen::Vector2d step = -J.inverse() * difference;
    double scale = 1.0;
    Eigen::Vector2d next_difference;
    while (scale > 1e-6 && !(residual(m + scale * step, &next_difference, nullptr) &&
                             next_difference.norm() < difference.norm())) {
      scale *= 0.5;
    }
    if (!(scale > 1e-6)) break;
    m += scale * step;
  }
  // Close to the domain's end rounding may keep the point above the strict tolerance.
  if (difference.norm() < kToleranceOfRounding * scale_of_rounding) return m;
  return std::nullopt;
}

template class RadialTangential<0>;
template class RadialTangential<4>;
template class RadialTangential<5>;

}  // namespace calibrato
