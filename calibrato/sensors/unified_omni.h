#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string_view>

#include "calibrato/sensors/radial_tangential.h"

namespace calibrato {

/// `omni-none`, `omni-radtan`: the unified sphere, with none or four coefficients of Brown's
/// distortion. A point is projected to the unit sphere, and from a centre xi behind the sphere's to
/// the plane; with d = |p| and m' the distorted m (radial_tangential.h):
///
///     m = (X, Y) / (Z + xi d)
///     u = fu x' + pu
///     v = fv y' + pv
///
/// Parameters, in this order: xi [-] > -1, fu fv pu pv [px], then kNumDistortion of k1 k2 p1 p2
/// [-]. xi = 0 is `pinhole`; mirrors and lenses have xi > 0. Between -1 and 0 the formula goes on
/// smoothly, so that the estimate of a nearly straight lens is not cut off.
///
/// Domain: Z > -w d with w = xi up to xi = 1 and 1/xi from there on, where the image radius stops
/// growing; m in the domain of the distortion. Points behind the camera are seen.
///
/// Source: Mei and Rives, "Single view point omnidirectional camera calibration from planar grids",
/// ICRA 2007, as in Kalibr (whose fu is the paper's gamma).
template <int kNumDistortion>
class UnifiedOmni {
 public:
  static_assert(kNumDistortion == 0 || kNumDistortion == 4);
  static constexpr std::string_view kName = kNumDistortion == 0 ? "omni-none" : "omni-radtan";
  static constexpr int kNumIntrinsics = 5;
  static constexpr int kNumParameters = kNumIntrinsics + kNumDistortion;
  /// The first kNumParameters are this model's.
  static constexpr std::array<std::string_view, 9> kParameterNames = {"xi", "fu", "fv", "pu", "pv",
                                                                      "k1", "k2", "p1", "p2"};
  using Parameters = Eigen::Matrix<double, kNumParameters, 1>;
  using JacobianParameters = Eigen::Matrix<double, 2, kNumParameters>;
  using JacobianPoint = Eigen::Matrix<double, 2, 3>;

  static constexpr std::string_view kConstraint = "xi must be above -1";
  static bool SatisfiesConstraint(const Parameters& parameters) { return parameters(0) > -1.0; }

  explicit UnifiedOmni(const Parameters& parameters);

  /// False, with the outputs untouched, where the point lies outside the domain.
  /// @param J_pixel_point, J_pixel_parameters  May be null.
  bool Project(const Eigen::Vector3d& p_c, Eigen::Vector2d* pixel, JacobianPoint* J_pixel_point,
               JacobianParameters* J_pixel_parameters) const;

  /// The unit ray through a pixel; nothing where no point of the domain maps to the pixel.
  std::optional<Eigen::Vector3d> Unproject(const Eigen::Vector2d& pixel) const;

  const Parameters& parameters() const { return parameters_; }

 private:
  Parameters parameters_;
  double limit_;
  RadialTangential<kNumDistortion> distortion_;
};

extern template class UnifiedOmni<0>;
extern template class UnifiedOmni<4>;

}  // namespace calibrato
