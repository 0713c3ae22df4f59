#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>

namespace calibrato {

/// Brown's distortion of the plane at depth 1. With m = (x, y) and s = x^2 + y^2:
///
///     c  = 1 + k1 s + k2 s^2 + k3 s^3
///     x' = c x + 2 p1 x y + p2 (s + 2 x^2)
///     y' = c y + p1 (s + 2 y^2) + 2 p2 x y
///
/// Coefficients [-]: the first kNumCoefficients of k1 k2 p1 p2 k3; with none m' = m.
///
/// Domain: inside the radius up to which r c(r^2) grows. Beyond it the lens would map two
/// directions to one pixel, which no real lens does: such points are not projected.
///
/// Source: Brown, "Decentering distortion of lenses", 1966, in OpenCV's arrangement.
template <int kNumCoefficients>
class RadialTangential {
 public:
  static_assert(kNumCoefficients == 0 || kNumCoefficients == 4 || kNumCoefficients == 5);
  using Coefficients = Eigen::Matrix<double, kNumCoefficients, 1>;
  using JacobianCoefficients = Eigen::Matrix<double, 2, kNumCoefficients>;

  explicit RadialTangential(const Coefficients& coefficients);

  /// False, with the outputs untouched, outside the domain.
  /// @param J_distorted_m, J_distorted_coefficients  May be null.
  bool Distort(const Eigen::Vector2d& m, Eigen::Vector2d* distorted, Eigen::Matrix2d* J_distorted_m,
               JacobianCoefficients* J_distorted_coefficients) const;

  /// The inverse, by Newton's method; nothing where no point of the domain maps there.
  std::optional<Eigen::Vector2d> Undistort(const Eigen::Vector2d& distorted) const;

 private:
  Coefficients coefficients_;
  double max_squared_radius_ = std::numeric_limits<double>::infinity();
};

// In the header, since the projections that it is a part of are the inner loop of everything.
template <int kNumCoefficients>
bool RadialTangential<kNumCoefficients>::Distort(
    const Eigen::Vector2d& m, Eigen::Vector2d* distorted, Eigen::Matrix2d* J_distorted_m,
    JacobianCoefficients* J_distorted_coefficients) const {
  const double s = m.squaredNorm();
  if (!(s < max_squared_radius_)) return false;  // Nor is NaN.
  if constexpr (kNumCoefficients == 0) {
    *distorted = m;
    if (J_distorted_m != nullptr) J_distorted_m->setIdentity();
  } else {
    const double x = m.x();
    const double y = m.y();
    const double k1 = coefficients_(0);
    const double k2 = coefficients_(1);
    const double p1 = coefficients_(2);
    const double p2 = coefficients_(3);
    double k3 = 0.0;
    if constexpr (kNumCoefficients == 5) k3 = coefficients_(4);
    const double c = 1.0 + s * (k1 + s * (k2 + s * k3));
    const double tangential_x = s + 2.0 * x * x;
    const double tangential_y = s + 2.0 * y * y;
    const double twice_xy = 2.0 * x * y;
    *distorted << c * x + p1 * twice_xy + p2 * tangential_x,
        c * y + p1 * tangential_y + p2 * twice_xy;
    if (J_distorted_m != nullptr) {
      // dc/dx = dc * x, dc/dy = dc * y.
      const double dc = 2.0 * (k1 + s * (2.0 * k2 + s * 3.0 * k3));
      const double cross = dc * x * y + 2.0 * (p1 * x + p2 * y);
      *J_distorted_m << c + dc * x * x + 2.0 * p1 * y + 6.0 * p2 * x, cross, cross,
          c + dc * y * y + 6.0 * p1 * y + 2.0 * p2 * x;
    }
    if (J_distorted_coefficients != nullptr) {
      JacobianCoefficients& J = *J_distorted_coefficients;
      J.col(0) = s * m;
      J.col(1) = s * s * m;
      J.col(2) << twice_xy, tangential_y;
      J.col(3) << tangential_x, twice_xy;
      if constexpr (kNumCoefficients == 5) J.col(4) = s * s * s * m;
    }
  }
  return true;
}

extern template class RadialTangential<0>;
extern template class RadialTangential<4>;
extern template class RadialTangential<5>;

}  // namespace calibrato
