#pragma once

#include <Eigen/Core>
#include <optional>
#include <variant>

#include "calibrato/sensors/image.h"

namespace calibrato {

/// The part of an image in which two straight edges cross: a corner of a checkerboard, of a ChArUco
/// board, or of an AprilGrid's tag, which touches a small black square there.
struct SaddleWindow {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  ///< About where [px].
  /// Columns: from the corner along its first and its second edge, as far as nothing but the two
  /// edges is in sight to either side [px]. The window is the parallelogram of half these axes,
  /// from -1 to 1 times each column.
  Eigen::Matrix2d arms = Eigen::Matrix2d::Zero();
  /// Of the window only what is within this share of an arm of either edge is looked at, 0 to 1:
  /// what lies deeper in a quadrant may be something else, as a marker's bits.
  double band = 1.0;
};

struct SaddleFit {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  ///< Where the edges cross [px].
  /// How `pixel` would change if the edges were known to bend [px^2]: at a distance t from the
  /// corner, edge k has left its tangent by 1/2 curvature_k t^2 along (-sin, cos) of the angle of
  /// its arm in (u, v). Curvature in [1/px].
  Eigen::Matrix2d J_pixel_curvature = Eigen::Matrix2d::Zero();
  double contrast = 0.0;         ///< Bright minus dark [grey levels].
  bool is_dark_between = false;  ///< Whether the quadrant between the two arms is dark.
};

/// Why there is no fit.
enum class SaddleFlaw {
  kNearBorder,  ///< The window is not inside the image.
  kBadFit,  ///< Too small, too faint, too uncertain (standard deviation above 0.3 px), or not what
            ///< two crossing edges look like.
};

/// Finds the crossing of two edges to sub-pixels by fitting the picture of one,
///
///     I(x) = (1 + h . (x - c0)) (m + a E(d1(x)) E(d2(x))),
///
/// where d1, d2 are the distances of x from the edges, E the mean over a pixel of erf(d / (sqrt 2
/// s)), s the blur [px], and h the gradient of the light: least squares over c, the edges' two
/// angles, s, m, a, h, with outlying pixels given less weight. The pixel's area is what sharp
/// images live by: an edge along the pixel rows shows its place in the grey of one row alone.
///
/// Whatever the lens's blur and the camera's tone curve are like, a corner's picture looks the same
/// after half a turn about it (blur does not shift edges, and a curve changes no place), and so
/// does the model: its errors do not pull at c. Only bent edges do; one corner alone does not tell
/// how they bend, but its neighbours do (corner_refinement.h).
[[nodiscard]] std::variant<SaddleFit, SaddleFlaw> FitSaddle(const GreyImage& image,
                                                            const SaddleWindow& window);

}  // namespace calibrato
