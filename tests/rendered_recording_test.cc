// The whole scene rendered, from the arm's dynamics to pixels, and the board found in it again.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <variant>

#include "calibrato/base/full_sample_for_test.h"
#include "calibrato/detection/detect.h"
#include "calibrato/motion/paper_scene.h"
#include "calibrato/simulation/arm_execution.h"
#include "calibrato/simulation/fast_simulation.h"
#include "calibrato/simulation/rendered_camera.h"

namespace calibrato {
namespace {

TimedMotion Handcrafted() {
  Motion motion = HandcraftedMotion(Task::kExtrinsic);
  motion.carrier = Carrier::kArm;
  return std::get<TimedMotion>(PlanMotion(motion, PaperRig()));
}

CarrierPath Executed(const Rig& rig) {
  const TimedMotion motion = Handcrafted();
  const ArmScene scene(rig);
  Rng rng(1);
  return PathOf(ExecuteOnArm(scene, rig, motion, rng), motion.duration_s());
}

// Computed independently of this code base: board 1.4421 m away, mean of the inner corners at
// (312.55, 228.02), their bounding box 124.0 x 148.0 px.
TEST(RenderedRecording, TheStartViewIsThatOfTheSetting) {
  const Rig rig = PaperRig();
  Rng noise(1);
  const GreyImage image = RenderedCamera(rig).Take(PlannedPath(Handcrafted()), 0.0, noise);
  const std::optional<BoardView> view = DetectBoard(image, rig.board);
  ASSERT_TRUE(view);
  ASSERT_EQ(view->pixels.cols(), 42);
  const Eigen::Vector2d middle = view->pixels.rowwise().mean();
  const Eigen::Vector2d size =
      view->pixels.rowwise().maxCoeff() - view->pixels.rowwise().minCoeff();
  EXPECT_NEAR(middle.x(), 312.55, 0.3);
  EXPECT_NEAR(middle.y(), 228.02, 0.3);
  EXPECT_NEAR(size.x(), 124.0, 0.3);
  EXPECT_NEAR(size.y(), 148.0, 0.3);
}

struct Errors {
  int num_images = 0;
  int num_found = 0;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  Eigen::Vector2d deviation = Eigen::Vector2d::Zero();
  double worst = 0.0;
};

// Of the corners found along the handcrafted motion against where they were in the middle of the
// exposure.
Errors ErrorsAlongTheMotion(const Rig& rig, double step_s) {
  const CarrierPath path = Executed(rig);
  const RenderedCamera camera(rig);
  const Eigen::Matrix3Xd points_g = BoardPoints(rig.board);
  Errors errors;
  double n = 0.0;
  Eigen::Vector2d squares = Eigen::Vector2d::Zero();
  for (double t_s = 0.0; t_s < path.duration_s; t_s += step_s) {
    ++errors.num_images;
    Rng noise = Rng(1).Stream("noise", static_cast<uint64_t>(errors.num_images));
    const std::optional<BoardView> view = DetectBoard(camera.Take(path, t_s, noise), rig.board);
    if (!view) continue;
    ++errors.num_found;
    const Rigid3 T_c_g = BoardInCamera(rig, path.at(t_s).T_b_e);
    for (Eigen::Index k = 0; k < view->pixels.cols(); ++k) {
      const Eigen::Vector2d truth =
          *rig.cameras[0].model.Project(T_c_g * points_g.col(view->corner_ids[k]));
      const Eigen::Vector2d error = view->pixels.col(k) - truth;
      errors.mean += error;
      squares += error.cwiseAbs2();
      errors.worst = std::max(errors.worst, error.norm());
      n += 1.0;
    }
  }
  errors.mean /= n;
  errors.deviation = (squares / n - errors.mean.cwiseAbs2()).cwiseSqrt();
  return errors;
}

// The bars of detection on boards before plain grey (detection_accuracy_test.cc).
TEST(RenderedRecording, CornersInTheFullSceneAreWhereTheyAreProjected) {
  Rig rig = PaperRig();
  Eigen::VectorXd parameters(9);
  parameters << 560.0, 560.0, 320.5, 240.5, -0.15, 0.08, 0.0, 0.0, 0.0;
  rig.cameras[0].model = CameraModel("pinhole-radtan5", parameters);
  const Errors errors = ErrorsAlongTheMotion(rig, FullSample() ? 0.1 : 0.5);
  EXPECT_EQ(errors.num_found, errors.num_images);
  EXPECT_LE(errors.mean.cwiseAbs().maxCoeff(), 0.02);
  EXPECT_LE(errors.deviation.maxCoeff(), 0.05);
  EXPECT_LE(errors.worst, 0.5);
  std::printf("%d images: mean %.4f %.4f, standard deviation %.4f %.4f, worst %.3f px\n",
              errors.num_images, errors.mean.x(), errors.mean.y(), errors.deviation.x(),
              errors.deviation.y(), errors.worst);
}

// The figures of docs/simulation.md, fitted to boards that move at constant speed, on the arm's own
// motion: its blur reaches 2 px with this exposure. (A longer one would also see accelerations.)
TEST(RenderedRecording, CornerNoiseIsWhatTheFittedModelPredicts) {
  Rig rig = PaperRig();
  rig.exposure_s = 0.02;
  rig.image_disturbances.defocus_px = 0.5;
  rig.image_disturbances.read_noise = 1.5;
  rig.image_disturbances.shot_noise = 0.02;
  const CornerNoise fitted{.stddev_px = 0.0054, .blur_factor = 0.00205, .blur_knee_px = 4.7};
  const CarrierPath path = Executed(rig);
  const RenderedCamera camera(rig);
  const CameraModel& lens = rig.cameras[0].model;
  const Eigen::Matrix3Xd points_g = BoardPoints(rig.board);
  double measured = 0.0;
  double predicted = 0.0;
  double longest = 0.0;
  const double step_s = FullSample() ? 0.1 : 0.4;
  for (double t_s = 0.05; t_s < path.duration_s; t_s += step_s) {
    Rng noise = Rng(2).Stream("noise", static_cast<uint64_t>(1000.0 * t_s));
    const std::optional<BoardView> view = DetectBoard(camera.Take(path, t_s, noise), rig.board);
    ASSERT_TRUE(view) << t_s;
    const Rigid3 first = BoardInCamera(rig, path.at(t_s - 0.5 * rig.exposure_s).T_b_e);
    const Rigid3 middle = BoardInCamera(rig, path.at(t_s).T_b_e);
    const Rigid3 last = BoardInCamera(rig, path.at(t_s + 0.5 * rig.exposure_s).T_b_e);
    double blur = 0.0;
    for (Eigen::Index k = 0; k < points_g.cols(); ++k) {
      const Eigen::Vector3d p = points_g.col(k);
      measured += (view->pixels.col(k) - *lens.Project(middle * p)).squaredNorm();
      blur += (*lens.Project(last * p) - *lens.Project(first * p)).norm() /
              static_cast<double>(points_g.cols());
    }
    longest = std::max(longest, blur);
    predicted += 2.0 * static_cast<double>(points_g.cols()) * std::pow(fitted.Stddev(blur), 2);
  }
  std::printf("blur up to %.1f px, measured over predicted %.3f\n", longest,
              std::sqrt(measured / predicted));
  EXPECT_GT(longest, 1.5);
  EXPECT_NEAR(std::sqrt(measured / predicted), 1.0, FullSample() ? 0.15 : 0.3);
}

}  // namespace
}  // namespace calibrato
