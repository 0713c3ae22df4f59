#pragma once

#include <string>
#include <vector>

#include "calibrato/geometry/rigid3.h"
#include "calibrato/motion/carrier.h"
#include "calibrato/sensors/rig.h"

namespace calibrato {

/// A camera that somebody carried before a board, as poses over time: a motion under trial beside
/// looped ones.
struct RecordedTrajectory {
  std::vector<double> t_s;     ///< Ascending, the first 0.
  std::vector<Rigid3> T_g_c0;  ///< Pose of camera 0 in the board's frame (docs/conventions.md).
};

/// A text file in the form of the TUM RGB-D benchmark (Sturm, Engelhard, Endres, Burgard, Cremers,
/// IROS 2012): on each line a stamp [s], tx ty tz [m] and the quaternion qx qy qz qw, with spaces
/// between; what begins with # is a remark. The pose is that of camera 0 in the board's frame g, z
/// out of the board: where T_world_camera of another world is at hand, it has to be turned into
/// this frame first.
/// @throws InputError with the line: not eight finite numbers, stamps that do not ascend, a
/// quaternion whose norm is more than 0.01 off 1, poses more than 0.2 s apart; and for less than
/// one second of them.
[[nodiscard]] RecordedTrajectory ParseTumTrajectory(const std::string& text,
                                                    const std::string& name);

/// The carrier's way: a spline of order 6 through the poses, its knots 0.1 s apart (or as far as
/// the poses, where those are further), so that the rig's acceleration is continuous and the noise
/// of recorded poses is smoothed out of it. Before and after it the carrier is at rest.
/// @param rig  Says where the board stands and where the camera sits on the carrier.
[[nodiscard]] CarrierPath PathAlong(const RecordedTrajectory& trajectory, const Rig& rig);

/// As path_length_m, of the controlled frame at 62 instants in 5 s: translation plus 1 m/rad of
/// rotation [m].
[[nodiscard]] double PathLength(const CarrierPath& path);

}  // namespace calibrato
