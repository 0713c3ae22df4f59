#include "calibrato/detection/disc_centres.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

namespace calibrato {
namespace {

constexpr int kWidth = 320;
constexpr int kHeight = 240;
constexpr double kSpacing = 0.05;
constexpr double kRadius = 0.019;

Eigen::Matrix2Xd Board() {
  Eigen::Matrix2Xd board(2, 20);
  for (int k = 0; k < 20; ++k) board.col(k) << kSpacing * (k / 5), kSpacing * (k % 5);
  return board;
}

// A steep view from near by, in which centroids and centres are far apart.
Eigen::Matrix3d Homography() {
  Eigen::Matrix3d H;
  H << 100.0, 900.0, 60.0, 900.0, 60.0, 50.0, 2.2, -0.7, 1.0;
  return H;
}

Eigen::Matrix2Xd Centres() {
  return (Homography() * Board().colwise().homogeneous()).colwise().hnormalized();
}

GreyImage Draw() {
  GreyImage image{{kWidth, kHeight}, {}};
  const Eigen::Matrix3d to_board = Homography().inverse();
  const Eigen::Matrix2Xd board = Board();
  constexpr int kSamples = 10;
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) {
      int num_dark = 0;
      for (int i = 0; i < kSamples * kSamples; ++i) {
        const Eigen::Vector3d pixel(u + (i % kSamples + 0.5) / kSamples - 0.5,
                                    v + (i / kSamples + 0.5) / kSamples - 0.5, 1.0);
        const Eigen::Vector2d x = (to_board * pixel).hnormalized();
        const double row = std::clamp(std::round(x.x() / kSpacing), 0.0, 3.0);
        const double column = std::clamp(std::round(x.y() / kSpacing), 0.0, 4.0);
        if ((x - kSpacing * Eigen::Vector2d(row, column)).norm() < kRadius) ++num_dark;
      }
      const double share = static_cast<double>(num_dark) / (kSamples * kSamples);
      image.pixels.push_back(static_cast<uint8_t>(std::lround(220.0 - 190.0 * share)));
    }
  }
  return image;
}

// The areas of the discs' images, by the determinant of the homography's Jacobian.
Eigen::VectorXd Areas() {
  const Eigen::Matrix2Xd board = Board();
  Eigen::VectorXd areas(board.cols());
  for (Eigen::Index k = 0; k < areas.size(); ++k) {
    const double w = Homography().row(2).dot(board.col(k).homogeneous());
    areas(k) = M_PI * kRadius * kRadius * std::abs(Homography().determinant()) / (w * w * w);
  }
  return areas;
}

TEST(DiscCentres, AreThoseOfTheDiscsNotOfTheirImages) {
  const GreyImage image = Draw();
  const Eigen::Matrix2Xd truth = Centres();
  RejectionCounts rejected;
  const auto centres = FindDiscCentres(image, Board(), truth, Areas(), &rejected);
  EXPECT_EQ(rejected, RejectionCounts());
  double worst_centroid = 0.0;
  for (Eigen::Index k = 0; k < truth.cols(); ++k) {
    ASSERT_TRUE(centres[static_cast<size_t>(k)]) << k;
    EXPECT_LT((*centres[static_cast<size_t>(k)] - truth.col(k)).norm(), 0.03) << k;
    // The centroid of what is dark around it, for comparison.
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    const double reach = 1.3 * std::sqrt(Areas()(k) / M_PI);
    for (int v = 0; v < kHeight; ++v) {
      for (int u = 0; u < kWidth; ++u) {
        const Eigen::Vector2d pixel(u, v);
        if ((pixel - truth.col(k)).norm() > reach) continue;
        sum += (220.0 - image.pixels[static_cast<size_t>(v * kWidth + u)]) * pixel.homogeneous();
      }
    }
    worst_centroid = std::max(worst_centroid, (sum.hnormalized() - truth.col(k)).norm());
  }
  EXPECT_GT(worst_centroid, 0.15);  // else there was nothing to correct
}

TEST(DiscCentres, RejectsAndCountsWhatIsNoDisc) {
  GreyImage image = Draw();
  const Eigen::Matrix2Xd truth = Centres();
  const auto at = [&](Eigen::Index k) {
    return std::pair(static_cast<int>(truth(0, k)), static_cast<int>(truth(1, k)));
  };
  const auto [u0, v0] = at(7);
  for (int v = v0 - 20; v <= v0 + 20; ++v) {
    for (int u = u0 - 20; u <= u0 + 20; ++u)
      image.pixels[static_cast<size_t>(v * kWidth + u)] = 220;
  }
  RejectionCounts rejected;
  const auto centres = FindDiscCentres(image, Board(), truth, Areas(), &rejected);
  EXPECT_FALSE(centres[7]);
  EXPECT_GE(rejected.corners_of_bad_fit, 1);
}

}  // namespace
}  // namespace calibrato
