#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calibrato/detection/local_map.h"
#include "calibrato/sensors/image.h"

namespace calibrato {

/// How a lens that is the same all around its axis shows the plane of a board:
///
///     (h_u, h_v, h_z) = H (x, y, 1),      pixel = centre + scale s (h_u, h_v),
///     s h_z = g(s^2 (h_u^2 + h_v^2)),     g(t) = 1 + g_1 t + .. + g_4 t^4,
///
/// that is, the ray through a pixel at the distance rho * scale from the centre is
/// (rho_u, rho_v, g(rho^2)). With g = 1 this is a homography. An equidistant fisheye has
/// g = rho / tan(rho), of which these terms are exact to 4e-5 up to 60 degrees from the axis; past
/// 90 degrees g is negative, which does no harm. (Scaramuzza, Martinelli and Siegwart: A Flexible
/// Technique for Accurate Omnidirectional Camera Calibration and Structure from Motion, 2006.)
///
/// H is any matrix, so pose and focal length need not be told apart: one view suffices, and nothing
/// about the lens has to be known. The map holds between the points that it was fitted to and a
/// little beyond them, by about one step of the board.
struct LensMap {
  Eigen::Matrix3d H = Eigen::Matrix3d::Identity();   ///< Of (x, y, 1), x and y in [m].
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  ///< Where the axis meets the image [px].
  double scale = 1.0;                                ///< [px]
  Eigen::Vector4d g = Eigen::Vector4d::Zero();       ///< g_1 .. g_4.

  /// To second order around a point of the board; nothing where the lens does not see it.
  /// @param near  A pixel about there, to start from: that of a neighbouring point will do [px].
  [[nodiscard]] std::optional<LocalMap> Around(const Eigen::Vector2d& point,
                                               const Eigen::Vector2d& near) const;
};

/// The one that fits best, by least squares of the distances in the image. What few points leave
/// open is held by weak expectations: the centre near the image's middle, g near 1. Nothing where
/// the homography that the search begins with puts a point behind the camera.
/// @param board  The points on the board, (x, y) [m], at least four and not on one line.
/// @param pixels  Where the image shows them [px], as many.
/// @param radius  0, or that of discs about the points, whose centroids the pixels are [m].
[[nodiscard]] std::optional<LensMap> FitLensMap(const Eigen::Matrix2Xd& board,
                                                const Eigen::Matrix2Xd& pixels, double radius,
                                                const Resolution& resolution);

/// The maps around all points, by the lens that fits best, and what is left over as in
/// FitLocalMaps; without a lens where none fits.
[[nodiscard]] std::vector<LocalMap> FitLocalMapsThroughLens(const Eigen::Matrix2Xd& board,
                                                            const Eigen::Matrix2Xd& pixels,
                                                            double radius,
                                                            const Resolution& resolution);

}  // namespace calibrato
