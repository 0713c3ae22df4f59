#pragma once

#include "calibrato/sensors/rig.h"

namespace calibrato {

/// The scene of the paper as its code built it: a camera of 640 x 480 px and 1 rad field of view
/// without distortion and an IMU on the fingers of a Panda, before a checkerboard of 6 rows x 7
/// columns of 60 mm, 1.44 m away (the paper's text says 2 m; only this distance agrees with its
/// figures). Extrinsics are the means of the paper's Table 4.
[[nodiscard]] Rig PaperRig();

/// fu = fv = (width / 2) / tan(hfov / 2) [px].
/// @param hfov_rad  Horizontal field of view, in (0, pi).
[[nodiscard]] double FocalLengthFromFieldOfView(double hfov_rad, int width);

}  // namespace calibrato
