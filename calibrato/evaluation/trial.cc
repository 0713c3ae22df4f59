#include "calibrato/evaluation/trial.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <utility>

#include "calibrato/base/input_error.h"
#include "calibrato/calibration/camera_calibration.h"
#include "calibrato/calibration/camera_imu_calibration.h"
#include "calibrato/calibration/prediction_error.h"
#include "calibrato/detection/detect.h"
#include "calibrato/evaluation/original_information.h"
#include "calibrato/mdp/calibration_status.h"
#include "calibrato/mdp/extrinsic_problem.h"
#include "calibrato/mdp/frames_that_count.h"
#include "calibrato/simulation/fast_simulation.h"
#include "calibrato/simulation/imu_simulation.h"
#include "calibrato/simulation/rendered_camera.h"
#include "calibrato/simulation/simulated_run.h"

namespace calibrato {
namespace {

// No stamp is negative, whatever the time offset.
constexpr Time kStart = Time::FromNanoseconds(1'000'000'000'000);

std::vector<BoardView> ViewsIn(const std::vector<SimulatedImage>& images, const Rig& rig) {
  if (images.empty()) return {};
  ImageSource source;
  for (const SimulatedImage& image : images) {
    source.names.push_back(std::to_string(image.stamp.nanoseconds()));
    source.stamps.push_back(image.stamp);
  }
  source.load = [&](size_t i) { return images[i].image; };
  return SearchForBoards(source, rig.board).views;
}

TrialRecording RecordLoops(const Rig& rig, const TimedMotion& timed, Fidelity fidelity,
                           const Rng& noise) {
  std::vector<SimulatedImage> images;
  SimulatedRun run = SimulateRun(
      rig, timed, fidelity, kStart, noise,
      [&](const CarrierPath&, const SimulatedImage& image) { images.push_back(image); });
  TrialRecording recording{std::move(run.frames.views), std::move(run.imu.stream),
                           run.frames.num_frames};
  if (fidelity == Fidelity::kRendered) recording.views = ViewsIn(images, rig);
  return recording;
}

TrialRecording RecordPath(const Rig& rig, const CarrierPath& path, Fidelity fidelity,
                          const Rng& noise) {
  TrialRecording recording;
  if (fidelity == Fidelity::kRendered) {
    std::vector<SimulatedImage> images;
    const int num_dropped =
        SimulateImages(rig, path, kStart, noise.Stream("simulate images"),
                       [&](SimulatedImage image) { images.push_back(std::move(image)); });
    recording.num_frames = static_cast<int>(images.size()) + num_dropped;
    recording.views = ViewsIn(images, rig);
  } else {
    Rng frame_noise = noise.Stream("simulate");
    SimulatedFrames frames = SimulateFrames(rig, path, kStart, frame_noise);
    recording.num_frames = frames.num_frames;
    recording.views = std::move(frames.views);
  }
  Rng imu_noise = noise.Stream("simulate imu");
  recording.imu = SimulateImu(rig, path, kStart, imu_noise).stream;
  return recording;
}

Trial Failed(int num_frames, std::string why) {
  Trial trial;
  trial.num_frames = num_frames;
  trial.failure = std::move(why);
  return trial;
}

double DistortionError(const CameraModel& estimate, const Camera& truth) {
  Eigen::VectorXd parameters = estimate.parameters();
  const int focal = CameraModel::FocalIndex(estimate.name());
  if (focal != CameraModel::FocalIndex(truth.model.name())) return Trial::kNone;
  parameters.head(focal + 4) = truth.model.intrinsics();
  const CameraModel mixed(estimate.name(), parameters);
  return PredictionErrorPx(mixed, truth.model, truth.resolution);
}

Trial IntrinsicTrial(const Rig& rig, const TrialRecording& recording) {
  const Camera& camera = rig.cameras.front();
  CameraProblem problem;
  // The paper's rigs without distortion are calibrated with it, as by someone who does not know.
  problem.model = camera.model.name() == "pinhole-none" ? std::string(kIntrinsicTaskModel)
                                                        : std::string(camera.model.name());
  problem.resolution = camera.resolution;
  problem.views = FramesThatCount(recording.views, camera.resolution, rig.board);
  const auto num_frames = static_cast<int>(problem.views.size());
  if (num_frames < kMinViews) return Failed(num_frames, "fewer than three frames count");
  const CameraCalibration calibration = CalibrateCamera(problem);
  if (calibration.termination != Termination::kConverged || calibration.covariance.size() == 0) {
    return Failed(num_frames, std::string(TerminationName(calibration.termination)));
  }
  const CameraModel& estimate = *calibration.model;
  const Eigen::Vector4d truth = camera.model.focal_and_centre();
  const Eigen::Vector4d error = estimate.focal_and_centre() - truth;
  const int focal = CameraModel::FocalIndex(problem.model);
  const Eigen::Matrix4d covariance = calibration.covariance.block<4, 4>(focal, focal);
  Trial trial;
  trial.num_frames = num_frames;
  trial.relative_error = RelativeIntrinsicError(estimate.focal_and_centre(), truth);
  trial.focal_error_px = error.head<2>().norm() / std::sqrt(2.0);
  trial.centre_error_px = error.tail<2>().norm() / std::sqrt(2.0);
  trial.distortion_error_px = DistortionError(estimate, camera);
  trial.prediction_error_px = PredictionErrorPx(estimate, camera.model, camera.resolution);
  trial.a_optimality = calibration.information.a_optimality;
  trial.nees = error.dot(covariance.ldlt().solve(error));
  return trial;
}

Trial ExtrinsicTrial(const Rig& rig, const TrialRecording& recording) {
  const auto num_frames = static_cast<int>(recording.views.size());
  if (num_frames < kMinViews) return Failed(num_frames, "fewer than three frames show the board");
  const CameraImuProblem problem = ExtrinsicProblem(rig, recording.views, recording.imu);
  const CameraImuCalibration calibration = CalibrateCameraImu(problem);
  if (calibration.termination != Termination::kConverged) {
    return Failed(num_frames, std::string(TerminationName(calibration.termination)));
  }
  const Eigen::MatrixXd& marginal = calibration.information.covariance;
  if (marginal.rows() < 6 || !marginal.topLeftCorner<6, 6>().allFinite()) {
    return Failed(num_frames, std::string(TerminationName(Termination::kRankDeficient)));
  }
  const CameraCalibrationState& estimate = calibration.state->cameras.front();
  const CameraCalibrationState truth{rig.cameras.front().model, rig.T_c0_i,
                                     rig.time_offset_i_c.seconds(),
                                     rig.image_disturbances.line_delay_s};
  const Eigen::Matrix<double, 6, 1> error = rig.T_c0_i.DifferenceTo(estimate.T_c_i);
  const Eigen::Matrix<double, 6, 6> covariance = marginal.topLeftCorner<6, 6>();
  Trial trial;
  trial.num_frames = num_frames;
  trial.relative_error = RelativeExtrinsicError(estimate.T_c_i, rig.T_c0_i);
  trial.rotation_error_rad = error.head<3>().norm();
  trial.translation_error_m = error.tail<3>().norm();
  trial.time_offset_error_s = std::abs(estimate.time_offset_s - truth.time_offset_s);
  trial.prediction_error_px = PredictionErrorPx(estimate, truth, rig.cameras.front().resolution);
  trial.a_optimality = calibration.information.extrinsics.a_optimality;
  trial.a_optimality_conditional = calibration.information.a_optimality_conditional;
  trial.a_optimality_original = OriginalAOptimality(problem, *calibration.state);
  trial.nees = error.dot(covariance.ldlt().solve(error));
  return trial;
}

}  // namespace

TrialRecording RecordForTrial(Task task, const Rig& rig, const ExecutableMotion& motion,
                              Fidelity fidelity, const Rng& noise) {
  if (task == Task::kIntrinsic && fidelity == Fidelity::kFast) {
    Rng frame_noise = noise.Stream("simulate");
    SimulatedFrames frames = SimulateFrames(rig, motion.path, kStart, frame_noise);
    return {std::move(frames.views), {}, frames.num_frames};
  }
  if (motion.timed) return RecordLoops(rig, *motion.timed, fidelity, noise);
  return RecordPath(rig, motion.path, fidelity, noise);
}

int NeesDimension(Task task) { return task == Task::kIntrinsic ? 4 : 6; }

Trial CalibrateRecording(Task task, const Rig& rig, const TrialRecording& recording) {
  return task == Task::kIntrinsic ? IntrinsicTrial(rig, recording) : ExtrinsicTrial(rig, recording);
}

Trial RunTrial(Task task, const Rig& rig, const ExecutableMotion& motion, Fidelity fidelity,
               const Rng& noise) {
  Trial trial;
  try {
    trial = CalibrateRecording(task, rig, RecordForTrial(task, rig, motion, fidelity, noise));
  } catch (const InputError& error) {
    trial = Failed(0, error.what());
  }
  trial.path_length_m = motion.path_length_m;
  trial.path_length_original_m = motion.path_length_original_m;
  trial.motion_s = motion.path.duration_s;
  return trial;
}

}  // namespace calibrato
