#include "calibrato/calibration/pixel_derivatives.h"

#include <type_traits>
#include <variant>

namespace calibrato {

std::optional<PixelDerivatives> ProjectWithDerivatives(const CameraModel& model,
                                                       const Eigen::Vector3d& p_c) {
  return std::visit(
      [&](const auto& lens) -> std::optional<PixelDerivatives> {
        using Lens = std::decay_t<decltype(lens)>;
        Eigen::Vector2d pixel;
        typename Lens::JacobianPoint J_point;
        typename Lens::JacobianParameters J_parameters;
        if (!lens.Project(p_c, &pixel, &J_point, &J_parameters)) return std::nullopt;
        return PixelDerivatives{pixel, J_point, J_parameters};
      },
      model.variant());
}

}  // namespace calibrato
