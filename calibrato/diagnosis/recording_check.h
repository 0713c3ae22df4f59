#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "calibrato/detection/rejection.h"
#include "calibrato/diagnosis/clock_steps.h"
#include "calibrato/diagnosis/expected_sigmas.h"
#include "calibrato/diagnosis/finding.h"
#include "calibrato/diagnosis/image_quality.h"
#include "calibrato/diagnosis/rest_noise.h"
#include "calibrato/diagnosis/stream_check.h"
#include "calibrato/diagnosis/stream_defects.h"
#include "calibrato/diagnosis/stream_timing.h"

namespace calibrato {

/// What is known of one camera of a recording without calibrating it.
struct CameraToCheck {
  std::string name;           ///< "cam0"
  std::vector<Time> stamps;   ///< Of all images; of a list of corners, those of its views.
  bool has_images = true;     ///< False: a list of corners, in which nothing tells of other images.
  bool was_searched = false;  ///< For the board; without, its stamps alone are checked.
  std::optional<Resolution> resolution;
  std::vector<BoardView> views;            ///< In order of time.
  std::vector<Time> stamps_without_board;  ///< Of images that were searched in vain.
  std::optional<CameraModel> model;        ///< Where its intrinsics are known.
  std::vector<ImageQuality> images;        ///< Some, evenly chosen.
  RejectionCounts rejected;                ///< By the search.
  std::vector<Finding> search_findings;    ///< Why there is no search to speak of: an image that
                                           ///< can't be read, a board that is in none of them.
};

struct RecordingToCheck {
  std::vector<CameraToCheck> cameras;
  std::vector<CheckedImu> imus;
  double gravity = kStandardGravity;  ///< [m/s^2]
};

/// One camera, one gyroscope or one accelerometer.
struct CheckedStream {
  std::string name;  ///< "cam0", "imu0 gyroscope": how findings on it begin.
  StreamTiming timing;
  std::optional<StreamDefects> defects;  ///< Of samples.
};

struct CheckedBoard {
  std::string camera;
  size_t num_images = 0;        ///< Of a list of corners: with those that its gaps stand for.
  double longest_away_s = 0.0;  ///< Without the board [s].
  Coverage coverage;
  std::vector<std::string> uncovered_parts;
  /// How far the camera went along x, y, z of the board [m]; where its lens is known.
  std::optional<Eigen::Vector3d> travel_m;
};

struct CheckedMotion {
  std::string imu;
  Eigen::Vector3d rates;      ///< Standard deviation about each axis [rad/s].
  Eigen::Vector3d forces;     ///< Along each axis, gravity's turning included [m/s^2].
  double median_force = 0.0;  ///< [m/s^2]
  std::optional<RestNoise> rest;
};

struct CheckedClock {
  std::string imu;
  std::string camera;
  SpeedComparison comparison;
  std::vector<ClockOffset> offsets;
};

/// All that is said of a recording before it is solved.
struct RecordingCheck {
  std::vector<Finding> findings;  ///< The worst first; each begins with what it is about.
  std::vector<CheckedStream> streams;
  std::vector<CheckedBoard> boards;
  std::vector<CheckedMotion> motions;
  std::vector<CheckedClock> clocks;
  std::vector<ExpectedSigma> expected;

  /// The worst of the findings that begin with this name.
  [[nodiscard]] Verdict VerdictOn(const std::string& name) const;
};

/// The findings of CheckStreams and of each header included above, and besides:
/// - fail: of cameras alone (for which CheckStreams is not asked), fewer than three views;
/// - warn: the board is in less than half of the images; coverage ranges not reached, where the
///   camera is to be calibrated from this recording (FindingsOnBoardPoses);
/// - info: what the search for the board left out.
/// A camera without a model is calibrated by its views, roughly, so that its motion can be compared
/// with the IMU's. Extrinsics are expected where an IMU has its noise stated and no finding before
/// makes a solve impossible.
[[nodiscard]] RecordingCheck CheckRecording(const RecordingToCheck& recording);

}  // namespace calibrato
