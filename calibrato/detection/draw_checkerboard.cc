#include "calibrato/detection/draw_checkerboard.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <numbers>

namespace calibrato {
namespace {

constexpr double kWhite = 220.0;
constexpr double kBlack = 30.0;
constexpr double kBackground = 110.0;

double Brightness(const Checkerboard& board, double x, double y) {
  // Squares are counted from the one outside corner (0, 0).
  const double row = std::floor(x / board.row_spacing_m) + 1.0;
  const double column = std::floor(y / board.column_spacing_m) + 1.0;
  const bool is_square =
      row >= 0.0 && row <= board.rows && column >= 0.0 && column <= board.columns;
  if (is_square) return static_cast<int>(row + column) % 2 == 0 ? kBlack : kWhite;
  const bool is_margin =
      row >= -1.0 && row <= board.rows + 1.0 && column >= -1.0 && column <= board.columns + 1.0;
  return is_margin ? kWhite : kBackground;
}

}  // namespace

GreyImage DrawCheckerboard(const Checkerboard& board, const Eigen::Matrix3d& H_c_g,
                           Resolution resolution) {
  constexpr int kSamples = 89;  // a Fibonacci number, for which these samples are even
  constexpr double kGoldenRatio = std::numbers::phi;
  constexpr double kWidth = 2.0;  // [px] of the square that a pixel sees through the lens
  // Plain numbers, since Eigen without optimisation would take seconds for an image.
  const Eigen::Matrix3d H_g_c = H_c_g.inverse();
  double h[3][3];
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) h[row][column] = H_g_c(row, column);
  }
  GreyImage image{resolution, {}};
  for (int pixel_v = 0; pixel_v < resolution.height; ++pixel_v) {
    for (int pixel_u = 0; pixel_u < resolution.width; ++pixel_u) {
      double sum = 0.0;
      for (int i = 0; i < kSamples; ++i) {
        // Each sample has a row and a column of its own, so that upright edges too are where they
        // should be.
        const double u = pixel_u + kWidth * ((i + 0.5) / kSamples - 0.5);
        const double v = pixel_v + kWidth * (std::fmod(i * kGoldenRatio, 1.0) - 0.5);
        const double scale = h[2][0] * u + h[2][1] * v + h[2][2];
        sum += Brightness(board, (h[0][0] * u + h[0][1] * v + h[0][2]) / scale,
                          (h[1][0] * u + h[1][1] * v + h[1][2]) / scale);
      }
      image.pixels.push_back(static_cast<uint8_t>(std::lround(sum / kSamples)));
    }
  }
  return image;
}

Eigen::Matrix2Xd DrawnCorners(const Checkerboard& board, const Eigen::Matrix3d& H_c_g) {
  Eigen::Matrix3Xd points = BoardPoints(board);
  points.row(2).setOnes();
  return (H_c_g * points).colwise().hnormalized();
}

Eigen::Matrix3d BoardHomography(const Checkerboard& board, double f, const Eigen::Vector2d& centre,
                                double distance_m, double tilt, double roll) {
  Eigen::Matrix3d R_c_g;  // x of the board down, y to the right, z towards the camera
  R_c_g << 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0;
  R_c_g = Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ()) * R_c_g *
          Eigen::AngleAxisd(tilt, Eigen::Vector3d::UnitX());
  const Eigen::Vector3d t_c_g = Eigen::Vector3d(0.0, 0.0, distance_m) - R_c_g * BoardCentre(board);
  Eigen::Matrix3d K;
  K << f, 0.0, centre.x(), 0.0, f, centre.y(), 0.0, 0.0, 1.0;
  Eigen::Matrix3d H_c_g;
  H_c_g << R_c_g.leftCols<2>(), t_c_g;
  return K * H_c_g;
}

}  // namespace calibrato
