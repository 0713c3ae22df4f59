#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include "calibrato/sensors/double_sphere.h"
#include "calibrato/sensors/extended_unified.h"
#include "calibrato/sensors/field_of_view.h"
#include "calibrato/sensors/kannala_brandt.h"
#include "calibrato/sensors/pinhole_radtan.h"
#include "calibrato/sensors/unified_omni.h"

// To add a camera model:
//   1. write a class with the members of `KannalaBrandt` (kannala_brandt.h), in a file of its own;
//   2. name it in `CameraModel::Variant` below;
//   3. add it to the list of lenses in camera_model_test.cc: Jacobians, round trip, domain and YAML
//      are then tested;
//   4. write its formula, domain and source into docs/camera-models.md, and its name into
//      docs/formats.md section 2.

namespace calibrato {

/// Image size [px].
struct Resolution {
  int width = 0;
  int height = 0;
  bool operator==(const Resolution&) const = default;
};

/// One of the camera models, with its parameters: a closed set, visited rather than inherited from,
/// so that the solver's inner loop is compiled for each of them.
class CameraModel {
 public:
  using Variant =
      std::variant<PinholeRadtan<0>, PinholeRadtan<4>, PinholeRadtan<5>, KannalaBrandt, FieldOfView,
                   UnifiedOmni<0>, UnifiedOmni<4>, DoubleSphere, ExtendedUnified>;

  /// @param parameters  The intrinsics, then the distortion.
  /// @throws InputError if there is no model of that name (the nearest is named), if the number of
  /// parameters is wrong, or unless they are valid (AreValidParameters).
  CameraModel(std::string_view name, const Eigen::VectorXd& parameters);
  /// @throws InputError unless there is a model of that name.
  static int NumParameters(std::string_view name);
  /// How many of them are intrinsics: 4 to 6. @throws InputError likewise.
  static int NumIntrinsics(std::string_view name);
  /// Where fu stands among the parameters; fv, pu, pv follow. @throws InputError likewise.
  static int FocalIndex(std::string_view name) { return NumIntrinsics(name) - 4; }
  /// "fu", "fv", "pu", "pv", "k1", .. in the order of the parameters. @throws InputError likewise.
  static std::vector<std::string> ParameterNames(std::string_view name);

  std::string_view name() const;
  Eigen::VectorXd parameters() const;
  int num_parameters() const;
  /// What Kalibr's YAML calls intrinsics: the parameters of the projection, of which fu fv pu pv
  /// are the last four.
  Eigen::VectorXd intrinsics() const;
  /// fu fv pu pv [px].
  Eigen::Vector4d focal_and_centre() const { return intrinsics().tail<4>(); }
  /// The parameters behind the intrinsics.
  Eigen::VectorXd distortion() const;

  /// Nothing where the point lies outside the model's domain. Wide lenses see points with Z <= 0.
  std::optional<Eigen::Vector2d> Project(const Eigen::Vector3d& p_c) const;
  /// A ray of any length; nothing where no point maps to the pixel. Its Z is 1 for pinholes with
  /// none or Brown's distortion, and may be 0 or less for wide lenses.
  std::optional<Eigen::Vector3d> Unproject(const Eigen::Vector2d& pixel) const;

  const Variant& variant() const { return model_; }

 private:
  Variant model_;
};

/// Whether parameters are a camera's: finite, focal lengths positive, and the model's own
/// constraint. A solver refuses a step that leaves this set.
template <typename Model>
bool AreValidParameters(const typename Model::Parameters& parameters) {
  constexpr int kFu = Model::kNumIntrinsics - 4;
  return parameters.allFinite() && parameters(kFu) > 0.0 && parameters(kFu + 1) > 0.0 &&
         Model::SatisfiesConstraint(parameters);
}

template <typename... Models>
constexpr std::array<std::string_view, sizeof...(Models)> CameraModelNames(
    std::type_identity<std::variant<Models...>>) {
  return {Models::kName...};
}

template <typename... Models>
constexpr int MaxCameraParameters(std::type_identity<std::variant<Models...>>) {
  return std::max({Models::kNumParameters...});
}

/// The names of the models (docs/formats.md section 2), in the order of CameraModel::Variant.
inline constexpr auto kCameraModelNames =
    CameraModelNames(std::type_identity<CameraModel::Variant>{});

/// No model has more.
inline constexpr int kMaxCameraParameters =
    MaxCameraParameters(std::type_identity<CameraModel::Variant>{});

/// True if the lens can exist with such an image: every pixel has a ray, or lies outside the image
/// circle of a lens that sees 90 degrees off its axis in that direction. Fisheyes often leave the
/// corners of their image dark; but a distortion that turns back within the image, before that, is
/// no lens. For the models that end at 90 degrees or before (pinholes), every pixel has a ray.
bool CoversImage(const CameraModel& model, Resolution resolution);

}  // namespace calibrato
