#include "calibrato/detection/draw_discs.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace calibrato {
namespace {

constexpr double kBlack = 30.0;
constexpr double kWhite = 220.0;
constexpr int kSamples = 12;  // along each side of a pixel

Rigid3 PoseOfObliqueView() {
  const Eigen::Vector3d rotation(1.576, -0.903, -1.870);
  return {Eigen::AngleAxisd(rotation.norm(), rotation.normalized()).toRotationMatrix(),
          {0.1683, 0.1121, 0.2006}};
}

}  // namespace

double DrawnRadius(const CircleGrid& board) {
  return 0.25 * board.spacing_m * (board.asymmetric ? std::numbers::sqrt2 : 1.0);
}

Eigen::Matrix2Xd DrawnCentres(const CircleGrid& board, const CameraModel& lens,
                              const Rigid3& T_c_g) {
  const Eigen::Matrix3Xd points_g = BoardPoints(board);
  Eigen::Matrix2Xd pixels(2, points_g.cols());
  for (Eigen::Index k = 0; k < pixels.cols(); ++k) {
    pixels.col(k) = lens.Project(T_c_g * Eigen::Vector3d(points_g.col(k))).value();
  }
  return pixels;
}

GreyImage DrawDiscs(const CircleGrid& board, const CameraModel& lens, const Rigid3& T_c_g,
                    Resolution resolution) {
  constexpr double kNowhere = std::numeric_limits<double>::infinity();
  const Eigen::Matrix3Xd points_g = BoardPoints(board);
  const Rigid3 T_g_c = T_c_g.Inverse();
  const double radius = DrawnRadius(board);
  // From the edge of the nearest disc, on the board; negative inside.
  const auto distance = [&](double u, double v) {
    const std::optional<Eigen::Vector3d> ray_c = lens.Unproject({u, v});
    if (!ray_c) return kNowhere;
    const Eigen::Vector3d ray_g = T_g_c.R * *ray_c;
    if (!(ray_g.z() < 0.0)) return kNowhere;
    const Eigen::Vector3d p_g = T_g_c.t - T_g_c.t.z() / ray_g.z() * ray_g;
    return (points_g.colwise() - p_g).colwise().norm().minCoeff() - radius;
  };
  GreyImage image{resolution, {}};
  for (int v = 0; v < resolution.height; ++v) {
    for (int u = 0; u < resolution.width; ++u) {
      const double middle = distance(u, v);
      double across = 0.0;
      for (const double side : {-0.5, 0.5}) {
        across = std::max({across, std::abs(distance(u + side, v + side) - middle),
                           std::abs(distance(u + side, v - side) - middle)});
      }
      double share = middle < 0.0 ? 1.0 : 0.0;
      if (std::abs(middle) < 2.0 * across && middle != kNowhere) {
        int num_black = 0;
        for (int i = 0; i < kSamples * kSamples; ++i) {
          const double du = (i % kSamples + 0.5) / kSamples - 0.5;
          const double dv = (i / kSamples + 0.5) / kSamples - 0.5;
          num_black += distance(u + du, v + dv) < 0.0 ? 1 : 0;
        }
        share = static_cast<double>(num_black) / (kSamples * kSamples);
      }
      image.pixels.push_back(static_cast<uint8_t>(std::lround(kWhite + (kBlack - kWhite) * share)));
    }
  }
  return image;
}

ObliqueView::ObliqueView()
    : lens("pinhole-equi",
           (Eigen::VectorXd(8) << 260.0, 260.0, 319.5, 239.5, -0.01, 0.004, -0.002, 0.0005)
               .finished()),
      T_c_g(PoseOfObliqueView()) {}

}  // namespace calibrato
