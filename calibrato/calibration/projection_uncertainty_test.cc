#include "calibrato/calibration/projection_uncertainty.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <limits>

#include "calibrato/base/full_sample_for_test.h"
#include "calibrato/base/parallel.h"
#include "calibrato/calibration/synthetic_views_for_test.h"
#include "calibrato/geometry/so3.h"

namespace calibrato {
namespace {

constexpr Resolution kImage{640, 480};
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNoise = 0.15;  // [px]

CameraModel Lens(double f) {
  Eigen::VectorXd parameters(8);
  parameters << f, f + 5.0, 322.0, 236.0, -0.2, 0.05, 0.001, -0.002;
  return {"pinhole-radtan", parameters};
}

// Frames that one or two cameras see without noise, and the truth behind them.
struct Scene {
  BundleAdjustmentState truth;
  std::vector<std::vector<BoardView>> views;  // [camera][frame]

  std::vector<BundleView> Bundle(const std::vector<std::vector<BoardView>>& measured) const {
    std::vector<BundleView> bundle;
    for (size_t f = 0; f < truth.T_c0_g.size(); ++f) {
      for (size_t c = 0; c < measured.size(); ++c) {
        bundle.push_back({static_cast<int>(c), static_cast<int>(f), &measured[c][f]});
      }
    }
    return bundle;
  }
};

Scene MakeScene(int num_cameras, int num_frames, uint64_t seed) {
  const Board board = Checkerboard{6, 7, 0.05, 0.05};
  const Eigen::Matrix3Xd points = BoardPoints(board);
  Scene scene;
  scene.views.resize(static_cast<size_t>(num_cameras));
  for (int c = 0; c < num_cameras; ++c) scene.truth.models.push_back(Lens(420.0 + 30.0 * c));
  if (num_cameras == 2) scene.truth.T_cn_cnm1 = {{ExpSo3({0.01, 0.1, 0.02}), {-0.1, 0.01, 0.0}}};
  Rng rng(seed);
  while (static_cast<int>(scene.truth.T_c0_g.size()) < num_frames) {
    const Eigen::Vector3d tilt(rng.Uniform(-0.6, 0.6), rng.Uniform(-0.6, 0.6),
                               rng.Uniform(-0.6, 0.6));
    const Eigen::Matrix3d R = ExpSo3(tilt) * ExpSo3({3.14159265, 0.0, 0.0});
    const Eigen::Vector3d middle(rng.Uniform(-0.4, 0.4), rng.Uniform(-0.3, 0.3),
                                 rng.Uniform(0.6, 1.2));
    const Rigid3 T_c0_g{R, middle - R * BoardCentre(board)};
    std::vector<BoardView> seen;
    for (int c = 0; c < num_cameras; ++c) {
      BoardView view;
      view.points_g = points;
      view.pixels.resize(2, points.cols());
      for (Eigen::Index k = 0; k < points.cols(); ++k) {
        const auto pixel = scene.truth.models[static_cast<size_t>(c)].Project(
            scene.truth.T_cn_c0(c) * (T_c0_g * points.col(k)));
        if (!pixel || pixel->minCoeff() < 0.0 || pixel->x() > kImage.width - 1 ||
            pixel->y() > kImage.height - 1) {
          break;
        }
        view.corner_ids.push_back(static_cast<int>(k));
        view.pixels.col(k) = *pixel;
      }
      if (static_cast<Eigen::Index>(view.corner_ids.size()) == points.cols()) {
        seen.push_back(std::move(view));
      }
    }
    if (static_cast<int>(seen.size()) < num_cameras) continue;
    scene.truth.T_c0_g.push_back(T_c0_g);
    for (int c = 0; c < num_cameras; ++c) {
      scene.views[static_cast<size_t>(c)].push_back(seen[static_cast<size_t>(c)]);
    }
  }
  return scene;
}

BundleAdjustmentOptions WithNoise(const Scene& scene, double noise) {
  BundleAdjustmentOptions options;
  options.noise_stddev_px.assign(scene.truth.models.size(), noise);
  return options;
}

HousedCamera Housed(const Scene& scene, int camera, double noise = kNoise) {
  const BundleAdjustmentOptions options = WithNoise(scene, noise);
  const std::vector<BundleView> views = scene.Bundle(scene.views);
  const Eigen::MatrixXd information = BorderInformation(scene.truth, views, options);
  return HouseCamera(camera, scene.truth, views, options,
                     *CovarianceFromInformation(information, {}));
}

// Where a point of the housing, at p_c in the true camera's frame, is in that of a new solution:
// the mean over the frames of where the board says it is.
Eigen::Vector3d HousedPoint(const Eigen::Vector3d& p_c, int camera,
                            const BundleAdjustmentState& truth,
                            const BundleAdjustmentState& solution, bool at_infinity) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (size_t f = 0; f < truth.T_c0_g.size(); ++f) {
    const Rigid3 T_true = truth.T_cn_c0(camera) * truth.T_c0_g[f];
    const Rigid3 T_new = solution.T_cn_c0(camera) * solution.T_c0_g[f];
    const Rigid3 motion = T_new * T_true.Inverse();
    sum += at_infinity ? Eigen::Vector3d(motion.R * p_c) : motion * p_c;
  }
  return sum / static_cast<double>(truth.T_c0_g.size());
}

// Re-solves with fresh noise, and compares the spread of pixels of housed points with the map.
void ExpectMapToBeTheSpread(const Scene& scene, int camera, int num_solves, uint64_t seed) {
  const HousedCamera housed = Housed(scene, camera);
  const CameraModel& model = scene.truth.models[static_cast<size_t>(camera)];
  struct Probe {
    Eigen::Vector3d p_c;
    bool at_infinity;
  };
  std::vector<Probe> probes;
  for (const double u : {2.0, 160.0, 320.0, 600.0}) {
    for (const double v : {5.0, 240.0, 470.0}) {
      const Eigen::Vector3d ray = model.Unproject({u, v})->normalized();
      probes.push_back({0.5 * ray, false});
      probes.push_back({ray, true});
    }
  }
  std::vector<Eigen::Matrix2Xd> errors(static_cast<size_t>(num_solves));
  const Rng rng(seed);
  ParallelFor(errors.size(), [&](size_t i) {
    Rng noise = rng.Stream("solve", i);
    std::vector<std::vector<BoardView>> measured = scene.views;
    for (std::vector<BoardView>& views : measured) {
      for (BoardView& view : views) {
        for (double& x : view.pixels.reshaped()) x += kNoise * noise.Normal();
      }
    }
    const BundleAdjustmentState solution =
        AdjustBundle(scene.truth, scene.Bundle(measured), {}).state;
    errors[i].resize(2, static_cast<Eigen::Index>(probes.size()));
    for (size_t k = 0; k < probes.size(); ++k) {
      const auto& [p_c, at_infinity] = probes[k];
      const auto pixel = solution.models[static_cast<size_t>(camera)].Project(
          HousedPoint(p_c, camera, scene.truth, solution, at_infinity));
      errors[i].col(static_cast<Eigen::Index>(k)) = *pixel - *model.Project(p_c);
    }
  });

  double mean_ratio = 0.0;
  for (size_t k = 0; k < probes.size(); ++k) {
    const auto& [p_c, at_infinity] = probes[k];
    Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
    for (const Eigen::Matrix2Xd& error : errors) {
      const Eigen::Vector2d e = error.col(static_cast<Eigen::Index>(k));
      spread += e * e.transpose() / num_solves;
    }
    const Eigen::Matrix2d predicted =
        at_infinity ? *PixelCovarianceAtInfinity(housed, p_c) : *PixelCovariance(housed, p_c);
    const auto worst = [](const Eigen::Matrix2d& covariance) {
      return std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(covariance).eigenvalues()(1));
    };
    // Each of the sampled sigmas has a relative error of 1 / sqrt(2 n).
    const double ratio = worst(spread) / worst(predicted);
    EXPECT_NEAR(ratio, 1.0, std::max(0.1, 4.0 / std::sqrt(2.0 * num_solves)))
        << p_c.transpose() << (at_infinity ? " at infinity" : "");
    mean_ratio += ratio / static_cast<double>(probes.size());
  }
  EXPECT_NEAR(mean_ratio, 1.0, 0.1);
  testing::Test::RecordProperty("mean_ratio", std::to_string(mean_ratio));
}

TEST(ProjectionUncertainty, IsTheSpreadOfReSolves) {
  ExpectMapToBeTheSpread(MakeScene(1, 12, 1), 0, FullSample() ? 10000 : 800, 2);
}

TEST(ProjectionUncertainty, IsTheSpreadOfReSolvesForTheSecondCameraOfARig) {
  ExpectMapToBeTheSpread(MakeScene(2, 10, 3), 1, FullSample() ? 10000 : 600, 4);
}

TEST(ProjectionUncertainty, IsLessThanTheParametersAloneSay) {
  // Pose gauge: much of the principal point's uncertainty is a turn of the camera in its housing.
  const Scene scene = MakeScene(1, 12, 1);
  const HousedCamera housed = Housed(scene, 0);
  HousedCamera alone = housed;
  alone.covariance.bottomRows<6>().setZero();
  alone.covariance.rightCols<6>().setZero();
  EXPECT_LT(ProjectionUncertainty(housed, kImage, 0.8).median,
            0.5 * ProjectionUncertainty(alone, kImage, 0.8).median);
}

TEST(ProjectionUncertainty, IsLeastWhereTheBoardsWere) {
  const Scene scene = MakeScene(1, 12, 1);
  const HousedCamera housed = Housed(scene, 0);
  const double at_boards = ProjectionUncertainty(housed, kImage, 0.9).median;
  EXPECT_LT(at_boards, ProjectionUncertainty(housed, kImage, 0.2).median);
  EXPECT_LT(at_boards, ProjectionUncertainty(housed, kImage, kInfinity).median);
}

TEST(ProjectionUncertainty, GoesToThatAtInfinityWithDistance) {
  const HousedCamera housed = Housed(MakeScene(1, 12, 1), 0);
  const ImageMap far = ProjectionUncertainty(housed, kImage, 1e5);
  const ImageMap infinite = ProjectionUncertainty(housed, kImage, kInfinity);
  EXPECT_LT((far.values - infinite.values).cwiseAbs().maxCoeff(), 1e-4 * infinite.worst);
}

TEST(ProjectionUncertainty, IsProportionalToTheNoise) {
  const Scene scene = MakeScene(1, 8, 5);
  const ImageMap once = ProjectionUncertainty(Housed(scene, 0), kImage, 1.0);
  const ImageMap thrice = ProjectionUncertainty(Housed(scene, 0, 3.0 * kNoise), kImage, 1.0);
  EXPECT_LT((thrice.values - 3.0 * once.values).cwiseAbs().maxCoeff(), 1e-9 * thrice.worst);
}

// A rig's result says the same as the bundle that it came from.
TEST(HouseCameras, TakesARigTogetherAgain) {
  Scene scene = MakeScene(2, 14, 6);
  CameraRigProblem problem;
  problem.cameras.resize(2);
  problem.frame_of_view.resize(2);
  Rng rng(7);
  for (size_t c = 0; c < 2; ++c) {
    problem.cameras[c].resolution = kImage;
    problem.cameras[c].views = scene.views[c];
    for (size_t f = 0; f < scene.views[c].size(); ++f) {
      problem.frame_of_view[c].push_back(static_cast<int>(3 * f));
      for (double& x : problem.cameras[c].views[f].pixels.reshaped()) x += kNoise * rng.Normal();
    }
  }
  const CameraRigCalibration calibration = CalibrateCameraRig(problem);
  ASSERT_EQ(calibration.termination, Termination::kConverged);
  const auto housed = HouseCameras(problem, calibration);
  for (size_t c = 0; c < 2; ++c) {
    ASSERT_TRUE(housed[c]);
    const ImageMap map = ProjectionUncertainty(*housed[c], kImage, 0.9);
    const ImageMap at_truth =
        ProjectionUncertainty(Housed(scene, static_cast<int>(c)), kImage, 0.9);
    EXPECT_NEAR(map.median / at_truth.median, 1.0, 0.1);
  }
  // What the first camera saw helps the second.
  CameraRigProblem alone;
  alone.cameras = {problem.cameras[1]};
  alone.frame_of_view = {problem.frame_of_view[1]};
  const auto on_its_own = HouseCameras(alone, CalibrateCameraRig(alone));
  EXPECT_LT(ProjectionUncertainty(*housed[1], kImage, 0.9).median,
            0.98 * ProjectionUncertainty(*on_its_own[0], kImage, 0.9).median);
}

TEST(ImageMap, ReachesFromTheFirstPixelToTheLast) {
  EXPECT_EQ(ImageMapPixel(kImage, 0, 0), Eigen::Vector2d(0, 0));
  EXPECT_EQ(ImageMapPixel(kImage, kImageMapRows - 1, kImageMapColumns - 1),
            Eigen::Vector2d(639, 479));
}

TEST(ImageMap, MedianAndWorstLeaveOutWhatDoesNotExist) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const ImageMap map = MapOverImage(
      kImage, [&](const Eigen::Vector2d& pixel) { return pixel.x() > 320.0 ? nan : pixel.y(); });
  EXPECT_EQ(map.worst, 479.0);
  EXPECT_NEAR(map.median, 239.5, 1e-9);
  EXPECT_TRUE(std::isnan(MapOverImage(kImage, [&](const Eigen::Vector2d&) { return nan; }).median));
}

}  // namespace
}  // namespace calibrato
