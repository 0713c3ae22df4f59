#pragma once

#include <Eigen/Core>
#include <vector>

#include "calibrato/sensors/image.h"

namespace calibrato {

/// A place that looks like the corner of four squares.
struct Saddle {
  Eigen::Vector2d pixel;  ///< To about a quarter of a pixel of the image that was searched [px].
  /// Unit vectors along the two edges: from the first, anticlockwise in (u, v), that is clockwise
  /// on the screen, to the second it is dark.
  Eigen::Matrix2d edges;
  double strength = 0.0;  ///< Grows with the contrast [grey levels squared].
};

/// All saddles of an image reduced by 1, 2, 4, .., the strongest first. A reduced image is searched
/// faster, and blur and noise shrink with it; corners less than about seven of its pixels apart
/// hide each other, and those within four of its border are not looked for.
/// Positions are those of the image itself.
[[nodiscard]] std::vector<Saddle> FindSaddles(const GreyImage& image, int reduction);

/// The reductions to try, one after the other, until a board is found: the first makes the image's
/// longer side 480 px or less, twice as fine ones follow as long as it stays below 2600 px, and in
/// the end comes one twice as coarse as the first, for boards out of focus.
[[nodiscard]] std::vector<int> ReductionsToSearch(Resolution resolution);

}  // namespace calibrato
