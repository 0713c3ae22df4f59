#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "calibrato/base/value.h"
#include "calibrato/sensors/camera_model.h"

namespace calibrato {

/// What a real lens does beyond what its model says. None by default.
struct LensResidual {
  /// Root mean square over the image of how far each pixel coordinate is displaced [px] >= 0.
  /// Splines fitted to real lenses leave models 0.05 to 0.2 px behind.
  double rms_px = 0.0;
  int64_t seed = 0;  ///< Which lens it is: 0 to 1e9.
};

/// RIG.yaml's optional key `lens_residual`: {rms_px, seed}, each optional. @throws InputError with
/// line and key. Unknown keys are appended to warnings (may be null).
[[nodiscard]] LensResidual LensResidualFromValue(const Value& value,
                                                 std::vector<std::string>* warnings);
[[nodiscard]] Value ToValue(const LensResidual& residual);

/// A smooth field of displacements over an image that no camera model follows:
///
///     d = sum over i, j of c_ij cos(pi i x) cos(pi j y),   2 <= i + j <= 5,   c_ij in R^2
///
/// with x, y from 0 to 1 over the image and c_ij normal, scaled so that the root mean square of
/// either coordinate over the image is exactly rms_px. Shifts and slopes are left out, since
/// principal point and focal lengths would take them up; of the rest a camera model can take up a
/// few combinations.
class LensField {
 public:
  LensField() = default;  ///< Of a lens that its model describes: no displacement.
  LensField(const LensResidual& residual, Resolution resolution);

  /// Displacement [px] of what the model images at `pixel`. Defined beyond the image too, where it
  /// goes on as its mirror image.
  [[nodiscard]] Eigen::Vector2d At(const Eigen::Vector2d& pixel) const;

 private:
  static constexpr int kNumWaves = 6;  // 0 to 5, along each side
  using Coefficients = Eigen::Matrix<double, kNumWaves, kNumWaves>;

  bool is_zero_ = true;
  Resolution resolution_;
  Coefficients u_ = Coefficients::Zero();
  Coefficients v_ = Coefficients::Zero();
};

}  // namespace calibrato
