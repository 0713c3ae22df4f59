#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string_view>

namespace calibrato {

/// `pinhole-equi`: a fisheye whose image radius is a polynomial in the angle off the axis. With
/// r = |(X, Y)| and theta = atan2(r, Z):
///
///     theta' = theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8)
///     u = fu theta' X / r + pu
///     v = fv theta' Y / r + pv
///
/// Parameters, in this order: fu fv pu pv [px], k1 k2 k3 k4 [-].
///
/// Domain: theta < pi, and inside the angle up to which theta' grows. Points behind the camera are
/// seen; Kalibr and OpenCV, which divide by Z, have the same image of those in front only.
///
/// Source: Kannala and Brandt, "A generic camera model and calibration method for conventional,
/// wide-angle, and fish-eye lenses", PAMI 2006, in the arrangement of cv::fisheye and Kalibr.
class KannalaBrandt {
 public:
  static constexpr std::string_view kName = "pinhole-equi";
  static constexpr int kNumIntrinsics = 4;
  static constexpr int kNumParameters = 8;
  static constexpr std::array<std::string_view, 8> kParameterNames = {"fu", "fv", "pu", "pv",
                                                                      "k1", "k2", "k3", "k4"};
  using Parameters = Eigen::Matrix<double, kNumParameters, 1>;
  using JacobianParameters = Eigen::Matrix<double, 2, kNumParameters>;
  using JacobianPoint = Eigen::Matrix<double, 2, 3>;

  static constexpr std::string_view kConstraint = "";
  static bool SatisfiesConstraint(const Parameters&) { return true; }

  explicit KannalaBrandt(const Parameters& parameters);

  /// False, with the outputs untouched, where the point lies outside the domain.
  /// @param J_pixel_point, J_pixel_parameters  May be null.
  bool Project(const Eigen::Vector3d& p_c, Eigen::Vector2d* pixel, JacobianPoint* J_pixel_point,
               JacobianParameters* J_pixel_parameters) const;

  /// The unit ray through a pixel, by Newton's method; nothing where no point of the domain maps to
  /// the pixel.
  std::optional<Eigen::Vector3d> Unproject(const Eigen::Vector2d& pixel) const;

  const Parameters& parameters() const { return parameters_; }

 private:
  double Radius(double theta) const;
  double RadiusDerivative(double theta) const;

  Parameters parameters_;
  double max_theta_;
};

}  // namespace calibrato
