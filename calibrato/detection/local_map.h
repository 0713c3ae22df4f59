#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

namespace calibrato {

/// How an image shows the surroundings of a point of the board: to second order,
///     pixel(x, y) = pixel + J (x, y) + 1/2 (xx x^2 + 2 xy x y + yy y^2),
/// with (x, y) on the board relative to the point [m].
struct LocalMap {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();          ///< Of the point itself [px].
  Eigen::Matrix2d J_pixel_board = Eigen::Matrix2d::Zero();  ///< [px/m]
  Eigen::Matrix<double, 2, 3> second = Eigen::Matrix<double, 2, 3>::Zero();  ///< xx xy yy [px/m^2]

  /// How far the point is from where its neighbours alone make it expected [px].
  double surprise = 0.0;

  /// How a line through the point, along `direction` on the board, bends in the image [1/px];
  /// the sign is that of SaddleFit::J_pixel_curvature.
  double CurvatureAlong(const Eigen::Vector2d& direction) const;

  /// The centroid of the image of a disc of this radius [m] about the point, minus the image of the
  /// point itself [px]: to second order in the radius r, with J = J_pixel_board,
  ///     r^2/8 (xx + yy) + r^2/4 J grad log |det J|
  /// (expand the integral of pixel(x, y) |det J| over the disc, over that of |det J|; the next
  /// terms are of fourth order).
  Eigen::Vector2d CentroidOffset(double radius) const;
};

/// The maps around all points, each fitted to the points nearest to it; of whatever lens and
/// perspective, which are smooth. Second derivatives are those of the homography that fits all the
/// points best, with what is left over fitted by cubic or quadratic polynomials; left at the
/// homography's where a point has too few neighbours.
/// @param board  The points on the board, (x, y) [m], at least four and not on one line.
/// @param pixels  Where the image shows them [px], as many.
[[nodiscard]] std::vector<LocalMap> FitLocalMaps(const Eigen::Matrix2Xd& board,
                                                 const Eigen::Matrix2Xd& pixels);

/// The same from other maps than the homography's, such as those of a lens (lens_map.h).
/// @param maps  What is fitted already, one of each point.
[[nodiscard]] std::vector<LocalMap> WithLeftOver(const Eigen::Matrix2Xd& board,
                                                 const Eigen::Matrix2Xd& pixels,
                                                 std::vector<LocalMap> maps);

/// A way to find the maps around all points, of (board, pixels).
using MapFit =
    std::function<std::vector<LocalMap>(const Eigen::Matrix2Xd&, const Eigen::Matrix2Xd&)>;

}  // namespace calibrato
