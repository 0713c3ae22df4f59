#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "calibrato/geometry/rigid3.h"
#include "calibrato/guide/wanted_accuracy.h"
#include "calibrato/sensors/camera_model.h"
#include "calibrato/sensors/imu.h"
#include "calibrato/sensors/measurements.h"

namespace calibrato {

/// What a person set out to calibrate: one camera, alone or with an IMU.
struct GuideProblem {
  BoardView points;  ///< All points of the board, as from PlannedView.
  Resolution resolution;
  std::string model = "pinhole-radtan";     ///< Of the camera, where it is to be found.
  std::optional<CameraModel> known_camera;  ///< Else it is estimated.
  std::optional<ImuNoise> imu;              ///< Without it, the camera alone is calibrated.
  double gravity = kStandardGravity;        ///< [m/s^2]
  WantedAccuracy wanted;
};

/// What was recorded so far.
struct GuideData {
  std::vector<BoardView> views;  ///< In order of time.
  ImuStream imu;                 ///< Stamps ascending, values finite.
};

/// What is known so far, measured or, before anything is, guessed.
struct LiveEstimate {
  CameraModel camera;
  Rigid3 T_c_i{};
  double time_offset_s = 0.0;
  Eigen::Vector3d gravity_g{0.0, 0.0, -kStandardGravity};
  double corner_noise_px = 0.3;  ///< Of one coordinate.
  /// Information on what LayoutOf names: from the data, and a little from nothing: lenses and rigs
  /// are of ordinary size.
  Eigen::MatrixXd information{};
  bool camera_is_measured = false;       ///< A solve of the camera converged.
  bool extrinsics_are_measured = false;  ///< A solve with the IMU converged.
  std::vector<ParameterProgress> progress{};
  [[nodiscard]] bool is_reached() const;
};

[[nodiscard]] KnowledgeLayout LayoutOf(const GuideProblem& problem);

/// Before any data: a lens of about 60 degrees, IMU and camera at one place.
[[nodiscard]] LiveEstimate GuessBefore(const GuideProblem& problem);

/// Calibrates what there is, from nothing but the data, as the calibration at the end does: the
/// camera from its views, then both with the IMU; with a camera that is not known, its parameters
/// are free in both. Where a solve has nothing to start from, or does not converge, the guess
/// stays, and its numbers say so. What takes time is the solve: some 0.1 s for each half minute.
[[nodiscard]] LiveEstimate EstimateSoFar(const GuideProblem& problem, const GuideData& data);

}  // namespace calibrato
