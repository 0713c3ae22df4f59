#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

// To add a camera model:
//   1. write a class with the members of `PinholeRadtan` below, in a file of its own when it is
//   long;
//   2. name it in `CameraModel::Variant` and in kCameraModelNames, in the same place in both;
//   3. add it to the lists of camera_model_test.cc: Jacobians, round trip, domain and YAML are then
//   tested;
//   4. write its formula and source into docs/camera-models.md.

namespace calibrato {

/// A pinhole camera with Brown's radial and tangential distortion, as in OpenCV and Kalibr. With
/// x = X/Z, y = Y/Z and s = x^2 + y^2:
///
///     c = 1 + k1 s + k2 s^2 + k3 s^3
///     u = fu (c x + 2 p1 x y + p2 (s + 2 x^2)) + pu
///     v = fv (c y + p1 (s + 2 y^2) + 2 p2 x y) + pv
///
/// Parameters, in this order: fu fv pu pv [px], then kNumDistortion of k1 k2 p1 p2 k3 [-].
/// (0, 0) is the centre of the top-left pixel.
///
/// Domain: Z > 0, and inside the radius up to which r c(r^2) grows. Beyond it the lens would map
/// two directions to one pixel, which no real lens does: such points are not projected.
///
/// Source: Brown, "Decentering distortion of lenses", 1966, in OpenCV's arrangement.
template <int kNumDistortion>
class PinholeRadtan {
 public:
  static_assert(kNumDistortion == 0 || kNumDistortion == 4 || kNumDistortion == 5);
  static constexpr int kNumParameters = 4 + kNumDistortion;
  using Parameters = Eigen::Matrix<double, kNumParameters, 1>;
  using JacobianParameters = Eigen::Matrix<double, 2, kNumParameters>;
  using JacobianPoint = Eigen::Matrix<double, 2, 3>;

  explicit PinholeRadtan(const Parameters& parameters);

  /// False, with the outputs untouched, where the point lies outside the domain.
  /// @param J_pixel_point, J_pixel_parameters  May be null.
  bool Project(const Eigen::Vector3d& p_c, Eigen::Vector2d* pixel, JacobianPoint* J_pixel_point,
               JacobianParameters* J_pixel_parameters) const;

  /// The ray (x, y, 1) through a pixel, by Newton's method; nothing where no point of the domain
  /// maps to the pixel.
  std::optional<Eigen::Vector3d> Unproject(const Eigen::Vector2d& pixel) const;

  const Parameters& parameters() const { return parameters_; }

 private:
  Parameters parameters_;
  double max_squared_radius_ = std::numeric_limits<double>::infinity();
};

extern template class PinholeRadtan<0>;
extern template class PinholeRadtan<4>;
extern template class PinholeRadtan<5>;

/// Image size [px].
struct Resolution {
  int width = 0;
  int height = 0;
  bool operator==(const Resolution&) const = default;
};

/// The names of the models (docs/formats.md section 2), in the order of CameraModel::Variant.
inline constexpr std::string_view kCameraModelNames[] = {"pinhole-none", "pinhole-radtan",
                                                         "pinhole-radtan5"};

/// One of the camera models, with its parameters: a closed set, visited rather than inherited from,
/// so that the solver's inner loop is compiled for each of them.
class CameraModel {
 public:
  using Variant = std::variant<PinholeRadtan<0>, PinholeRadtan<4>, PinholeRadtan<5>>;

  /// @param parameters  The intrinsics, then the distortion.
  /// @throws InputError if there is no model of that name (the nearest is named), if the number of
  /// parameters is wrong, if one is not finite, or if a focal length is not positive.
  CameraModel(std::string_view name, const Eigen::VectorXd& parameters);
  /// @throws InputError unless there is a model of that name.
  static int NumParameters(std::string_view name);
  /// "fu", "fv", "pu", "pv", "k1", .. in the order of the parameters.
  static std::vector<std::string> ParameterNames(std::string_view name);

  std::string_view name() const { return kCameraModelNames[model_.index()]; }
  Eigen::VectorXd parameters() const;
  int num_parameters() const;
  /// The four of fu fv pu pv; every model so far has them first.
  Eigen::Vector4d intrinsics() const { return parameters().head<4>(); }

  /// Nothing where the point lies outside the model's domain (behind the camera, for one).
  std::optional<Eigen::Vector2d> Project(const Eigen::Vector3d& p_c) const;
  /// A ray of any length, z forward.
  std::optional<Eigen::Vector3d> Unproject(const Eigen::Vector2d& pixel) const;

  const Variant& variant() const { return model_; }

 private:
  Variant model_;
};

/// True if every pixel of the image has a ray: the test of a lens that can exist (the distortion is
/// monotone in the image).
bool CoversImage(const CameraModel& model, Resolution resolution);

}  // namespace calibrato
