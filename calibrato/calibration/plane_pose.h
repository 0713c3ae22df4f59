#pragma once

#include <Eigen/Core>
#include <optional>

#include "calibrato/geometry/rigid3.h"
#include "calibrato/sensors/camera_model.h"
#include "calibrato/sensors/measurements.h"

namespace calibrato {

/// The pose T_c_g of the plane z = 0 from the rays along which points of it are seen, by the direct
/// linear transform on rays: d x (H p) = 0 with H = [r1 r2 t] (Hartley and Zisserman, Multiple View
/// Geometry, section 4.1, with unit vectors in place of pixels). Rays may point backwards (z <= 0),
/// as those of a lens of more than 180 degrees do.
/// @param plane  2 x N [m].
/// @param rays   3 x N, of any length > 0.
/// @return nothing with fewer than four points, for points on a line, or where no pose has most
/// points in front of their rays.
[[nodiscard]] std::optional<Rigid3> PoseFromRays(const Eigen::Matrix2Xd& plane,
                                                 const Eigen::Matrix3Xd& rays);

/// The pose of a view's board from its corners' rays; corners without a ray are left out.
[[nodiscard]] std::optional<Rigid3> PoseFromView(const CameraModel& model, const BoardView& view);

/// The other pose that a small plane could have: its tilt mirrored about the line of sight to
/// `middle_g` (Schweighofer and Pinz, "Robust pose estimation from a planar target", PAMI 2006).
[[nodiscard]] Rigid3 MirroredPose(const Rigid3& T_c_g, const Eigen::Vector3d& middle_g);

}  // namespace calibrato
