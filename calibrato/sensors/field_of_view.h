#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string_view>

namespace calibrato {

/// `pinhole-fov`: one parameter bends the image of a wide lens. With m = (X, Y) / Z and r = |m|:
///
///     r' = atan(2 r tan(w / 2)) / w
///     u = fu r' x / r + pu
///     v = fv r' y / r + pv
///
/// Parameters, in this order: fu fv pu pv [px], w [rad] in [0, pi); w = 0 is a pinhole.
///
/// Domain: Z > 0. All of it fits into the image circle r' < pi / (2 w).
///
/// Source: Devernay and Faugeras, "Straight lines have to be straight", MVA 2001, as in Kalibr.
class FieldOfView {
 public:
  static constexpr std::string_view kName = "pinhole-fov";
  static constexpr int kNumIntrinsics = 4;
  static constexpr int kNumParameters = 5;
  static constexpr std::array<std::string_view, 5> kParameterNames = {"fu", "fv", "pu", "pv", "w"};
  using Parameters = Eigen::Matrix<double, kNumParameters, 1>;
  using JacobianParameters = Eigen::Matrix<double, 2, kNumParameters>;
  using JacobianPoint = Eigen::Matrix<double, 2, 3>;

  static constexpr std::string_view kConstraint = "w must lie in [0, pi)";
  static bool SatisfiesConstraint(const Parameters& parameters);

  explicit FieldOfView(const Parameters& parameters);

  /// False, with the outputs untouched, where the point lies outside the domain.
  /// @param J_pixel_point, J_pixel_parameters  May be null.
  bool Project(const Eigen::Vector3d& p_c, Eigen::Vector2d* pixel, JacobianPoint* J_pixel_point,
               JacobianParameters* J_pixel_parameters) const;

  /// The unit ray through a pixel; nothing where no point of the domain maps to the pixel.
  std::optional<Eigen::Vector3d> Unproject(const Eigen::Vector2d& pixel) const;

  const Parameters& parameters() const { return parameters_; }

 private:
  Parameters parameters_;
  double twice_tangent_;       // 2 tan(w / 2)
  double magnification_;       // twice_tangent_ / w: the slope of r' at the centre
  double twice_tangent_by_w_;  // Derivatives of both by w.
  double magnification_by_w_;
};

}  // namespace calibrato
