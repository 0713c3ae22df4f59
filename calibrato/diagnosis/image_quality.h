#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibrato/diagnosis/finding.h"
#include "calibrato/sensors/board.h"
#include "calibrato/sensors/image.h"
#include "calibrato/sensors/measurements.h"

namespace calibrato {

/// How sharp and how well lit a board is in one image, at the edges between its corners.
struct BoardSharpness {
  /// Contrast over the steepest slope across an edge, median over the edges of a direction, the
  /// larger of the two directions [px]. 1 for a perfect lens at rest; for a Gaussian blur of sigma
  /// 2.5 sigma, for a motion across the edge its length in the image.
  double edge_width_px = 0.0;
  double black = 0.0;  ///< Medians beside the edges [grey levels, 0 to 255].
  double white = 0.0;
};

/// Profiles are taken at right angles to the middles of the edges. Nothing for boards without edges
/// between their points (circle grids), and where all edges are too short in the image (squares of
/// less than 12 px, tags of less than 20 px).
[[nodiscard]] std::optional<BoardSharpness> SharpnessOf(const GreyImage& image,
                                                        const BoardView& view, const Board& board);

/// Mean of all pixels [grey levels].
[[nodiscard]] double BrightnessOf(const GreyImage& image);

/// One of the images that were looked at.
struct ImageQuality {
  Time stamp;
  double brightness = 0.0;
  std::optional<BoardSharpness> board;  ///< Where it was found, and has edges.
};

/// warn: more than a fifth of the images with the board have edges wider than 5 px (of images up to
/// 1280 px wide; in proportion beyond), white paper at the end of the sensor's range, or less than
/// 40 grey levels of contrast; half of all images all but black or white.
[[nodiscard]] std::vector<Finding> FindingsOnImages(const std::string& camera,
                                                    const std::vector<ImageQuality>& images,
                                                    Resolution resolution);

}  // namespace calibrato
