#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string_view>

#include "calibrato/sensors/radial_tangential.h"

namespace calibrato {

/// `pinhole-none`, `pinhole-radtan`, `pinhole-radtan5`: a pinhole camera with none, four or five
/// coefficients of Brown's distortion. With m' the distorted m = (X/Z, Y/Z) (radial_tangential.h):
///
///     u = fu x' + pu
///     v = fv y' + pv
///
/// Parameters, in this order: fu fv pu pv [px], then kNumDistortion of k1 k2 p1 p2 k3 [-].
///
/// Domain: Z > 0, and m in the domain of the distortion.
///
/// Source: the models of OpenCV's calib3d and, but for k3, of Kalibr.
template <int kNumDistortion>
class PinholeRadtan {
 public:
  static constexpr std::string_view kName = kNumDistortion == 0   ? "pinhole-none"
                                            : kNumDistortion == 4 ? "pinhole-radtan"
                                                                  : "pinhole-radtan5";
  static constexpr int kNumIntrinsics = 4;
  static constexpr int kNumParameters = kNumIntrinsics + kNumDistortion;
  /// The first kNumParameters are this model's.
  static constexpr std::array<std::string_view, 9> kParameterNames = {"fu", "fv", "pu", "pv", "k1",
                                                                      "k2", "p1", "p2", "k3"};
  using Parameters = Eigen::Matrix<double, kNumParameters, 1>;
  using JacobianParameters = Eigen::Matrix<double, 2, kNumParameters>;
  using JacobianPoint = Eigen::Matrix<double, 2, 3>;

  /// What the parameters must be, in words and as a test (focal lengths and NaN aside, which
  /// CameraModel::AreValid looks at for every model).
  static constexpr std::string_view kConstraint = "";
  static bool SatisfiesConstraint(const Parameters&) { return true; }

  explicit PinholeRadtan(const Parameters& parameters);

  /// False, with the outputs untouched, where the point lies outside the domain.
  /// @param J_pixel_point, J_pixel_parameters  May be null.
  bool Project(const Eigen::Vector3d& p_c, Eigen::Vector2d* pixel, JacobianPoint* J_pixel_point,
               JacobianParameters* J_pixel_parameters) const;

  /// The ray (x, y, 1) through a pixel; nothing where no point of the domain maps to the pixel.
  std::optional<Eigen::Vector3d> Unproject(const Eigen::Vector2d& pixel) const;

  const Parameters& parameters() const { return parameters_; }

 private:
  Parameters parameters_;
  RadialTangential<kNumDistortion> distortion_;
};

extern template class PinholeRadtan<0>;
extern template class PinholeRadtan<4>;
extern template class PinholeRadtan<5>;

}  // namespace calibrato
