#pragma once

#include <Eigen/Core>
#include <vector>

#include "calibrato/detection/dark_blobs.h"
#include "calibrato/detection/lattice.h"
#include "calibrato/sensors/image.h"

namespace calibrato {

/// By number on the board, the blobs; -1 where one is missing.
using DiscNumbering = std::vector<int>;

struct MendedNumbering {
  DiscNumbering numbering;
  int num_near_border = 0;  ///< Of those missing, the discs that the image's border cuts.
};

/// Puts a grid's numbering right where it went wrong on the way from disc to neighbouring disc, as
/// it does at the edge of oblique views, where the discs of the next row are nearer than those of
/// the same. All discs together tell what the lens does (lens_map.h): those that are out of place
/// by more than a seventh of a step are taken out, the worst first, and where one is missing the
/// blob is taken that lies where it should be, if it has the right size. Unchanged where no lens
/// fits.
/// @param board  The centres on the board, (x, y) [m], by number.
/// @param index  Of the blobs' middles.
[[nodiscard]] MendedNumbering Mended(const DiscNumbering& numbering, const Eigen::Matrix2Xd& board,
                                     const std::vector<DarkBlob>& blobs, const PointIndex& index,
                                     const Resolution& resolution);

}  // namespace calibrato
