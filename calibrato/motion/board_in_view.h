#pragma once

#include <optional>

#include "calibrato/motion/carrier.h"

namespace calibrato {

/// The centre of the rig's board must lie inside the image of camera 0. Wide lenses see points
/// beside and behind the camera too.
///
/// @return  Nothing if it does, else the refusal's limit, value, bound and unit: the pixel
/// coordinate beyond the image's edge, or, where the lens can't see the centre at all, its angle
/// off the optical axis against that of the image's farthest corner.
[[nodiscard]] std::optional<Refusal> CheckBoardInView(const Rigid3& T_b_e, const Rig& rig);

}  // namespace calibrato
