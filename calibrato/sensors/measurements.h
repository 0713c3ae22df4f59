#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calibrato/base/time.h"

namespace calibrato {

/// The corners of a board that one camera saw in one image: all that estimation ever sees of an
/// image, whether it was taken by a lens, rendered, or computed. Column k of each array is one
/// corner.
struct BoardView {
  Time stamp;  ///< Middle of the exposure, on the camera's clock; 0 for photos without stamps.
  std::string name;  ///< What to call it when it is worth a word, "left03.jpg" or its stamp.
  std::vector<int> corner_ids;  ///< Numbers of the corners on the board, ascending.
  Eigen::Matrix2Xd pixels;      ///< (u, v) [px]; (0, 0) is the centre of the top-left pixel.
  Eigen::Matrix3Xd points_g;    ///< Where these corners are on the board [m].

  Eigen::Index num_corners() const { return pixels.cols(); }
};

}  // namespace calibrato
