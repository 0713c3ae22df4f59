#include "calibrato/detection/lens_map.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numbers>
#include <string>
#include <vector>

#include "calibrato/detection/draw_discs.h"
#include "calibrato/geometry/expect_jacobian.h"

namespace calibrato {
namespace {

constexpr Resolution kResolution{640, 480};
constexpr double kRadius = 0.0106;

Eigen::Matrix2Xd Board() { return BoardPoints(CircleGrid{7, 4, 0.03, true}).topRows<2>(); }

struct Lens {
  std::string name;
  CameraModel model;
};

std::vector<Lens> Lenses() {
  const auto lens = [](const std::string& name, std::initializer_list<double> parameters) {
    return Lens{name, CameraModel(name, Eigen::Map<const Eigen::VectorXd>(
                                            parameters.begin(),
                                            static_cast<Eigen::Index>(parameters.size())))};
  };
  return {
      lens("pinhole-none", {400.0, 400.0, 325.0, 236.0}),
      lens("pinhole-radtan", {500.0, 500.0, 325.0, 236.0, -0.28, 0.08, 0.0005, -0.0003}),
      lens("pinhole-equi", {260.0, 260.0, 319.5, 239.5, -0.01, 0.004, -0.002, 0.0005}),
      lens("pinhole-fov", {300.0, 300.0, 330.0, 240.0, 0.9}),
      lens("omni-radtan", {1.6, 650.0, 650.0, 322.0, 238.0, -0.1, 0.02, 0.0, 0.0}),
      lens("ds-none", {-0.2, 0.58, 180.0, 180.0, 318.0, 242.0}),
  };
}

// Its middle to the right of and below the axis, tilted by about 50 degrees.
Rigid3 Pose() {
  const Eigen::Matrix3d R = (Eigen::AngleAxisd(0.9, Eigen::Vector3d(0.6, 0.8, 0.0)) *
                             Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ()) *
                             Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()))
                                .toRotationMatrix();
  const Eigen::Vector3d middle = BoardCentre(CircleGrid{7, 4, 0.03, true});
  return {R, Eigen::Vector3d(0.06, 0.05, 0.33) - R * middle};
}

Eigen::Vector2d Project(const CameraModel& model, const Rigid3& T_c_g, const Eigen::Vector2d& x) {
  return model.Project(T_c_g * Eigen::Vector3d(x.x(), x.y(), 0.0)).value();
}

Eigen::Matrix2Xd PixelsOf(const CameraModel& model, const Rigid3& T_c_g) {
  const Eigen::Matrix2Xd board = Board();
  Eigen::Matrix2Xd pixels(2, board.cols());
  for (Eigen::Index k = 0; k < board.cols(); ++k) {
    pixels.col(k) = Project(model, T_c_g, board.col(k));
  }
  return pixels;
}

// Of any function from the board to the image, by differences.
template <typename Function>
LocalMap MapByDifferences(const Function& f, const Eigen::Vector2d& x) {
  constexpr double h = 1e-4;
  const Eigen::Vector2d dx(h, 0.0);
  const Eigen::Vector2d dy(0.0, h);
  LocalMap map;
  map.pixel = f(x);
  map.J_pixel_board << (f(x + dx) - f(x - dx)) / (2.0 * h), (f(x + dy) - f(x - dy)) / (2.0 * h);
  map.second << f(x + dx) - 2.0 * f(x) + f(x - dx),
      0.25 * (f(x + dx + dy) + f(x - dx - dy) - f(x + dx - dy) - f(x - dx + dy)),
      f(x + dy) - 2.0 * f(x) + f(x - dy);
  map.second /= h * h;
  return map;
}

TEST(LensMap, FollowsEveryKindOfLensUpToTheBoardsCorners) {
  const Eigen::Matrix2Xd board = Board();
  for (const Lens& lens : Lenses()) {
    const Eigen::Matrix2Xd pixels = PixelsOf(lens.model, Pose());
    const std::optional<LensMap> map = FitLensMap(board, pixels, 0.0, kResolution);
    ASSERT_TRUE(map) << lens.name;
    for (Eigen::Index k = 0; k < board.cols(); ++k) {
      const auto around = map->Around(board.col(k), pixels.col(k));
      ASSERT_TRUE(around) << lens.name << " " << k;
      const LocalMap truth = MapByDifferences(
          [&](const Eigen::Vector2d& x) { return Project(lens.model, Pose(), x); }, board.col(k));
      EXPECT_LT((around->pixel - truth.pixel).norm(), 0.02) << lens.name << " " << k;
      EXPECT_LT((around->J_pixel_board - truth.J_pixel_board).norm(),
                2e-3 * truth.J_pixel_board.norm())
          << lens.name << " " << k;
      EXPECT_LT((around->CentroidOffset(kRadius) - truth.CentroidOffset(kRadius)).norm(), 0.015)
          << lens.name << " " << k;
    }
  }
}

TEST(LensMap, FollowsALensThatSeesBehindItself) {
  const CameraModel lens("ds-none",
                         (Eigen::VectorXd(6) << -0.2, 0.58, 150.0, 150.0, 319.5, 239.5).finished());
  // Held to the right, facing the camera: the far discs are more than 90 degrees off the axis.
  const Eigen::Matrix3d R = (Eigen::AngleAxisd(0.5 * M_PI, Eigen::Vector3d::UnitY()) *
                             Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()))
                                .toRotationMatrix();
  const Rigid3 T_c_g{
      R, Eigen::Vector3d(0.25, 0.0, 0.08) - R * BoardCentre(CircleGrid{7, 4, 0.03, true})};
  const Eigen::Matrix2Xd board = Board();
  double lowest_z = 1.0;
  for (Eigen::Index k = 0; k < board.cols(); ++k) {
    lowest_z = std::min(lowest_z, (T_c_g * Eigen::Vector3d(board(0, k), board(1, k), 0.0)).z());
  }
  ASSERT_LT(lowest_z, -0.01);
  const Eigen::Matrix2Xd pixels = PixelsOf(lens, T_c_g);
  const std::optional<LensMap> map = FitLensMap(board, pixels, 0.0, kResolution);
  ASSERT_TRUE(map);
  for (Eigen::Index k = 0; k < board.cols(); ++k) {
    const auto around = map->Around(board.col(k), pixels.col(k));
    ASSERT_TRUE(around) << k;
    EXPECT_LT((around->pixel - pixels.col(k)).norm(), 0.1) << k;
    const LocalMap truth = MapByDifferences(
        [&](const Eigen::Vector2d& x) { return Project(lens, T_c_g, x); }, board.col(k));
    EXPECT_LT((around->CentroidOffset(kRadius) - truth.CentroidOffset(kRadius)).norm(), 0.03) << k;
  }
}

// The centroids of the images of discs, from the outlines of these, by Green's theorem.
Eigen::Matrix2Xd CentroidsOf(const CameraModel& model, const Rigid3& T_c_g, double radius) {
  const Eigen::Matrix2Xd board = Board();
  Eigen::Matrix2Xd centroids(2, board.cols());
  constexpr int kSides = 2000;
  for (Eigen::Index k = 0; k < board.cols(); ++k) {
    const auto corner = [&](int i) {
      const double angle = 2.0 * M_PI * i / kSides;
      return Project(model, T_c_g,
                     board.col(k) + radius * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
    };
    double area = 0.0;
    Eigen::Vector2d moment = Eigen::Vector2d::Zero();
    const Eigen::Vector2d origin = corner(0);  // close by, so that little cancels
    for (int i = 0; i < kSides; ++i) {
      const Eigen::Vector2d a = corner(i) - origin;
      const Eigen::Vector2d b = corner(i + 1) - origin;
      const double twice = a.x() * b.y() - a.y() * b.x();
      area += twice / 2.0;
      moment += twice / 6.0 * (a + b);
    }
    centroids.col(k) = origin + moment / area;
  }
  return centroids;
}

TEST(LensMap, TakesCentroidsForWhatTheyAre) {
  const ObliqueView view;
  const Eigen::Matrix2Xd board = Board();
  // Nearly touching, so that centroids and centres are far apart.
  const double radius = 0.4 * 0.03 * std::numbers::sqrt2;
  const Eigen::Matrix2Xd centres = PixelsOf(view.lens, view.T_c_g);
  const Eigen::Matrix2Xd centroids = CentroidsOf(view.lens, view.T_c_g, radius);
  ASSERT_GT((centroids - centres).colwise().norm().maxCoeff(), 1.0);
  const auto worst = [&](double fitted_radius) {
    const std::optional<LensMap> map = FitLensMap(board, centroids, fitted_radius, kResolution);
    double error = 0.0;
    for (Eigen::Index k = 0; k < board.cols(); ++k) {
      const LocalMap around = map.value().Around(board.col(k), centroids.col(k)).value();
      error = std::max(error,
                       (centroids.col(k) - around.CentroidOffset(radius) - centres.col(k)).norm());
    }
    return error;
  };
  EXPECT_LT(worst(radius), 0.02);
  EXPECT_GT(worst(0.0), 2.0 * worst(radius));  // had they been taken for centres
}

TEST(LensMap, HasTheDerivativesOfItself) {
  const ObliqueView view;
  const std::optional<LensMap> map =
      FitLensMap(Board(), PixelsOf(view.lens, view.T_c_g), 0.0, kResolution);
  ASSERT_TRUE(map);
  ASSERT_GT(map->g.norm(), 0.1);
  for (const Eigen::Index k : {0, 7, 13, 27}) {
    const Eigen::Vector2d x = Board().col(k);
    const Eigen::Vector2d near = Project(view.lens, view.T_c_g, x);
    const std::optional<LocalMap> around = map->Around(x, near);
    ASSERT_TRUE(around);
    const auto at = [&](const Eigen::VectorXd& y) { return map->Around(y, near).value(); };
    ExpectJacobian([&](const Eigen::VectorXd& y) -> Eigen::VectorXd { return at(y).pixel; }, x,
                   around->J_pixel_board);
    Eigen::MatrixXd by_x(4, 2);
    by_x << around->second.col(0), around->second.col(1), around->second.col(1),
        around->second.col(2);
    ExpectJacobian(
        [&](const Eigen::VectorXd& y) -> Eigen::VectorXd { return at(y).J_pixel_board.reshaped(); },
        x, by_x);
  }
}

TEST(LensMap, NeedsNoKnowledgeOfWhereTheAxisIs) {
  // An image that was cropped on one side: the axis is 40 px off its middle.
  const CameraModel lens(
      "pinhole-equi",
      (Eigen::VectorXd(8) << 260.0, 260.0, 359.5, 239.5, -0.01, 0.004, -0.002, 0.0005).finished());
  const Eigen::Matrix2Xd pixels = PixelsOf(lens, Pose());
  const std::optional<LensMap> map = FitLensMap(Board(), pixels, 0.0, kResolution);
  ASSERT_TRUE(map);
  EXPECT_LT((map->centre - Eigen::Vector2d(359.5, 239.5)).norm(), 8.0);
}

TEST(LensMap, StaysNearAHomographyWhereFewPointsTellNothingElse) {
  const CameraModel lens("pinhole-none",
                         (Eigen::VectorXd(4) << 400.0, 400.0, 319.5, 239.5).finished());
  const std::vector<Eigen::Index> few = {0, 1, 4, 5, 8, 9};
  const Eigen::Matrix2Xd board = Board()(Eigen::all, few);
  const Eigen::Matrix2Xd pixels = PixelsOf(lens, Pose())(Eigen::all, few);
  const std::optional<LensMap> map = FitLensMap(board, pixels, 0.0, kResolution);
  ASSERT_TRUE(map);
  EXPECT_LT(map->g.norm(), 0.1);
  EXPECT_LT((map->centre - Eigen::Vector2d(319.5, 239.5)).norm(), 1.0);
}

TEST(LensMap, EndsWhereTheLensSeesNoMore) {
  LensMap map;  // the identity: x / 1, y / 1
  map.H(2, 0) = -1.0;
  EXPECT_TRUE(map.Around({0.5, 0.0}, {0.5, 0.0}));
  EXPECT_FALSE(map.Around({1.5, 0.0}, {1.5, 0.0}));  // behind the camera
}

TEST(FitLocalMapsThroughLens, KnowsTheBendAtTheCornerWherePolynomialsDoNot) {
  const ObliqueView view;
  const Eigen::Matrix2Xd board = Board();
  const Eigen::Matrix2Xd pixels = PixelsOf(view.lens, view.T_c_g);
  const std::vector<LocalMap> by_lens = FitLocalMapsThroughLens(board, pixels, 0.0, kResolution);
  const std::vector<LocalMap> by_homography = FitLocalMaps(board, pixels);
  constexpr size_t kCorner = 7;
  const LocalMap truth =
      MapByDifferences([&](const Eigen::Vector2d& x) { return Project(view.lens, view.T_c_g, x); },
                       board.col(kCorner));
  const auto error = [&](const std::vector<LocalMap>& maps) {
    return (maps[kCorner].second - truth.second).norm() / truth.second.norm();
  };
  EXPECT_LT(error(by_lens), 0.02);
  EXPECT_GT(error(by_homography), 0.2);  // else there was nothing to gain
  EXPECT_LT(by_lens[kCorner].surprise, 0.1);
}

}  // namespace
}  // namespace calibrato
