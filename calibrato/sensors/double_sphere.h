#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string_view>

namespace calibrato {

/// `ds-none`: a point is projected to one unit sphere, from there to a second one xi before it, and
/// then to the plane as in the unified model. With d1 = |p|, z2 = xi d1 + Z and d2 = |(X, Y, z2)|:
///
///     m = (X, Y) / (alpha d2 + (1 - alpha) z2)
///     u = fu x + pu
///     v = fv y + pv
///
/// Parameters, in this order: xi [-] > -1, alpha [-], fu fv pu pv [px]. The paper has alpha in
/// [0, 1]; beyond, the formula goes on smoothly, so that an estimate near an end is not cut off.
///
/// Domain: z2 > -w d2 with w = alpha / (1 - alpha) up to alpha = 1/2 and (1 - alpha) / alpha from
/// there on; for xi > 1 also xi Z > -d1. This is exactly where the image radius is finite and grows
/// with the angle; the paper's bound on Z / d1 is the same for xi = 0 and for alpha = 1/2 only
/// (docs/camera-models.md). Points behind the camera are seen.
///
/// Source: Usenko, Demmel, Cremers, "The double sphere camera model", 3DV 2018, as in Kalibr.
class DoubleSphere {
 public:
  static constexpr std::string_view kName = "ds-none";
  static constexpr int kNumIntrinsics = 6;
  static constexpr int kNumParameters = 6;
  static constexpr std::array<std::string_view, 6> kParameterNames = {"xi", "alpha", "fu",
                                                                      "fv", "pu",    "pv"};
  using Parameters = Eigen::Matrix<double, kNumParameters, 1>;
  using JacobianParameters = Eigen::Matrix<double, 2, kNumParameters>;
  using JacobianPoint = Eigen::Matrix<double, 2, 3>;

  static constexpr std::string_view kConstraint = "xi must be above -1";
  static bool SatisfiesConstraint(const Parameters& parameters) { return parameters(0) > -1.0; }

  explicit DoubleSphere(const Parameters& parameters);

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
};

}  // namespace calibrato
