#pragma once

#include <Eigen/Core>

#include "calibrato/geometry/rigid3.h"
#include "calibrato/sensors/board.h"
#include "calibrato/sensors/camera_model.h"
#include "calibrato/sensors/image.h"

namespace calibrato {

/// For tests: a picture of a circle grid through any lens, whose centres are known exactly. Discs
/// have a quarter of the distance to the next one as radius, on paper without end, evenly lit. Each
/// pixel is the mean of 144 samples over its area.
[[nodiscard]] GreyImage DrawDiscs(const CircleGrid& board, const CameraModel& lens,
                                  const Rigid3& T_c_g, Resolution resolution);

/// Where that picture has the discs' centres: 2 x N [px].
[[nodiscard]] Eigen::Matrix2Xd DrawnCentres(const CircleGrid& board, const CameraModel& lens,
                                            const Rigid3& T_c_g);

/// Their radius [m].
[[nodiscard]] double DrawnRadius(const CircleGrid& board);

/// A fisheye of 150 degrees with 640 x 480 pixels, and a grid of 7 x 4 discs so near and so oblique
/// (60 degrees) at its side that they are from 5 to 40 px wide and bent like the lens.
struct ObliqueView {
  CircleGrid board{7, 4, 0.03, true};
  CameraModel lens;
  Rigid3 T_c_g;
  Resolution resolution{640, 480};

  ObliqueView();
};

}  // namespace calibrato
