// From the arm's dynamics over pixels to parameters: do both estimators know how wrong they are?

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "calibrato/base/full_sample_for_test.h"
#include "calibrato/calibration/camera_calibration.h"
#include "calibrato/calibration/camera_imu_calibration.h"
#include "calibrato/calibration/chi_square.h"
#include "calibrato/calibration/view_selection.h"
#include "calibrato/detection/detect.h"
#include "calibrato/recording/photo.h"
#include "calibrato/sensors/effects.h"
#include "calibrato/simulation/rig_distribution.h"
#include "calibrato/simulation/simulated_run.h"

namespace calibrato {
namespace {

// Normalised squared errors over rigs.
struct Honesty {
  double degrees = 0.0;   ///< Of freedom, of one rig.
  double quantile = 0.0;  ///< 95 % of chi-square with so many.
  int num_rigs = 0;
  int num_inside = 0;
  double sum = 0.0;

  void Add(const Eigen::VectorXd& error, const Eigen::MatrixXd& covariance) {
    const double squared = error.dot(covariance.ldlt().solve(error));
    ++num_rigs;
    num_inside += squared < quantile ? 1 : 0;
    sum += squared;
  }
  [[nodiscard]] double ErrorOverBound() const { return std::sqrt(sum / (degrees * num_rigs)); }
};

struct Judgement {
  Honesty camera{.degrees = 4.0, .quantile = 9.488};
  Honesty camera_imu{.degrees = 7.0, .quantile = 14.067};
  int num_not_converged = 0;
  double corner_noise_px = 0.0;  ///< As the camera's estimator found it, the mean over rigs.
};

// A rig of the paper's distribution with a time offset and biases.
Rig DrawTruth(Rng& rng) {
  Rig rig = DrawRig(RigDistribution::kPaper, rng);
  rig.time_offset_i_c = Duration::FromSeconds(rng.Uniform(-0.02, 0.02));
  for (int axis = 0; axis < 3; ++axis) {
    rig.imu_disturbances.gyro_bias(axis) = 0.01 * rng.Normal();
    rig.imu_disturbances.accel_bias(axis) = 0.1 * rng.Normal();
  }
  return rig;
}

std::vector<BoardView> Detected(const SimulatedRun& run, const Rig& rig) {
  ImageSource source;
  for (const StampedPng& image : run.images) {
    source.names.push_back(std::to_string(image.stamp.nanoseconds()));
    source.stamps.push_back(image.stamp);
  }
  source.load = [&](size_t k) { return DecodePhoto({run.images[k].png, ""}, source.names[k]); };
  return DetectBoards(source, rig.board).views;
}

void JudgeRig(int number, const std::function<void(Rig*)>& effect, Judgement* judgement) {
  Rng rng(static_cast<uint64_t>(number));
  Rig rig = DrawTruth(rng);
  effect(&rig);
  if (!FullSample()) rig.camera_rate_hz = 5.0;  // half the images to render
  Motion motion = HandcraftedMotion(Task::kExtrinsic);
  motion.carrier = Carrier::kArm;
  const SimulatedRun run =
      SimulateRun(rig, std::get<TimedMotion>(PlanMotion(motion, rig)), Fidelity::kRendered,
                  Time::FromNanoseconds(1'000'000'000'000), rng);
  const Camera& truth = rig.cameras.front();
  CameraProblem intrinsic;
  intrinsic.model = truth.model.name();
  intrinsic.resolution = truth.resolution;
  const std::vector<BoardView> views = Detected(run, rig);
  // The handcrafted motion rests between its loops.
  for (const size_t v : SelectDistinct(views)) intrinsic.views.push_back(views[v]);
  const CameraCalibration camera = CalibrateCamera(intrinsic);
  if (camera.termination != Termination::kConverged) {
    ++judgement->num_not_converged;
    return;
  }
  judgement->corner_noise_px += camera.noise_stddev_px;
  judgement->camera.Add(camera.model->focal_and_centre() - truth.model.focal_and_centre(),
                        camera.covariance.topLeftCorner<4, 4>());

  CameraImuProblem extrinsic;
  extrinsic.cameras.push_back({truth.model, views, IntrinsicsKnowledge::kExact, {}});
  extrinsic.imus.push_back({run.imu.stream, rig.imu_noise, ImuModelKind::kCalibrated});
  CameraImuOptions options;
  options.knot_spacing_s = 0.07;
  const CameraImuCalibration camera_imu = CalibrateCameraImu(extrinsic, options);

  if (camera_imu.termination != Termination::kConverged) {
    ++judgement->num_not_converged;
    return;
  }
  const CameraCalibrationState& estimate = camera_imu.state->cameras.front();
  Eigen::VectorXd error(7);
  error << estimate.T_c_i.DifferenceTo(rig.T_c0_i),
      estimate.time_offset_s - rig.time_offset_i_c.seconds();
  judgement->camera_imu.Add(error, camera_imu.information.covariance.topLeftCorner<7, 7>());
}

Judgement Judge(const std::string& name, int num_rigs, const std::function<void(Rig*)>& effect) {
  Judgement judgement;
  for (int i = 0; i < num_rigs; ++i) JudgeRig(i, effect, &judgement);
  judgement.corner_noise_px /= std::max(1, judgement.camera.num_rigs);
  std::printf(
      "%-28s corners %.3f px | camera: %d of %d inside, error over bound %.2f | "
      "camera-imu: %d of %d, %.2f | not converged %d\n",
      name.c_str(), judgement.corner_noise_px, judgement.camera.num_inside,
      judgement.camera.num_rigs, judgement.camera.ErrorOverBound(), judgement.camera_imu.num_inside,
      judgement.camera_imu.num_rigs, judgement.camera_imu.ErrorOverBound(),
      judgement.num_not_converged);
  std::fflush(stdout);
  return judgement;
}

// The paper's effects alone: an ideal sensor of the paper's rigs, the IMU's noise. As large a share
// of rigs inside their 95 % ellipsoids as 16 of 20, and the sum of all squared errors within the 95
// % interval of chi-square with all their degrees of freedom.
TEST(RenderedHonesty, OfBothEstimatorsOnThePapersRigs) {
  const int n = FullSample() ? 60 : 2;
  const Judgement judgement = Judge("paper", n, [](Rig*) {});
  EXPECT_EQ(judgement.num_not_converged, 0);
  for (const Honesty& honesty : {judgement.camera, judgement.camera_imu}) {
    EXPECT_GE(honesty.num_inside, FullSample() ? 0.8 * honesty.num_rigs : 1);
    const double above = ChiSquareTail(honesty.sum, honesty.degrees * honesty.num_rigs);
    // Three sigmas for the small sample.
    const double least = FullSample() ? 0.025 : 0.5 * kSignificance;
    EXPECT_GT(above, least);
    EXPECT_LT(above, 1.0 - least);
  }
}

// What each effect of real arms, cameras and IMUs does to that, at its ordinary size. Every solve
// converges, whatever its bounds are worth.
TEST(RenderedHonesty, EffectByEffect) {
  const int n = FullSample() ? 10 : 1;
  const auto with = [](const std::string& names) {
    return [names](Rig* rig) { SwitchOnEffects(names, rig); };
  };
  if (FullSample()) {
    for (const Effect& effect : Effects()) {
      const std::string name(effect.name);
      EXPECT_EQ(Judge(name, n, with(name)).num_not_converged, 0);
    }
  }
  EXPECT_EQ(Judge("all", n, with("all")).num_not_converged, 0);
}

}  // namespace
}  // namespace calibrato
