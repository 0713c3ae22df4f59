#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string_view>

namespace calibrato {

/// `eucm-none`: the unified model with an ellipsoid in the sphere's place. With
/// d = sqrt(beta (X^2 + Y^2) + Z^2):
///
///     m = (X, Y) / (alpha d + (1 - alpha) Z)
///     u = fu x + pu
///     v = fv y + pv
///
/// Parameters, in this order: alpha [-], beta [-] > 0, fu fv pu pv [px]. The paper has alpha in
/// [0, 1]; beyond, the formula goes on smoothly, so that an estimate near an end is not cut off.
/// With alpha = 0 the model is a pinhole and beta has no effect; with beta = 1 it is the unified
/// sphere of xi = alpha / (1 - alpha).
///
/// Domain: Z > -w d with w = alpha / (1 - alpha) up to alpha = 1/2 and (1 - alpha) / alpha from
/// there on, where the image radius stops growing. Points behind the camera are seen.
///
/// Source: Khomutenko, Garcia, Martinet, "An enhanced unified camera model", RA-L 2016; domain from
/// Usenko, Demmel, Cremers, "The double sphere camera model", 3DV 2018; as in Kalibr.
class ExtendedUnified {
 public:
  static constexpr std::string_view kName = "eucm-none";
  static constexpr int kNumIntrinsics = 6;
  static constexpr int kNumParameters = 6;
  static constexpr std::array<std::string_view, 6> kParameterNames = {"alpha", "beta", "fu",
                                                                      "fv",    "pu",   "pv"};
  using Parameters = Eigen::Matrix<double, kNumParameters, 1>;
  using JacobianParameters = Eigen::Matrix<double, 2, kNumParameters>;
  using JacobianPoint = Eigen::Matrix<double, 2, 3>;

  static constexpr std::string_view kConstraint = "beta must be positive";
  static bool SatisfiesConstraint(const Parameters& parameters) { return parameters(1) > 0.0; }

  explicit ExtendedUnified(const Parameters& parameters);

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
