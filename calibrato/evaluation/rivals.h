#pragma once

#include <map>
#include <string>
#include <vector>

#include "calibrato/base/value.h"
#include "calibrato/evaluation/chart.h"
#include "calibrato/evaluation/contest.h"
#include "calibrato/evaluation/contestant.h"
#include "calibrato/evaluation/outside_estimator.h"

namespace calibrato {

/// One estimator on the recordings of one motion.
struct RivalRow {
  std::string estimator;
  std::string policy;
  std::vector<std::vector<Trial>> trials;  ///< [member of the motion's method][rig]
};

/// Estimator by motion, each with each, on the same recordings.
///
/// Intrinsic task: calibrato; opencv (cv::calibrateCamera); mrcal (where its package is installed
/// and the board is a checkerboard). At most 50 frames a recording, evenly thinned, for all of
/// them: cv::calibrateCamera takes a time that grows with the cube of the frames.
///
/// Extrinsic task: calibrato; kalman-filter (filter_calibration.h), which is told the noise of the
/// corners at rest and starts from the mean of Table 4; and outside programs, which get a bag of
/// images: fidelity `rendered` alone.
///
/// What crashes, hangs or leaves nonsense is a trial that failed and says why; for estimates of
/// others nonsense is one that is off by more than half (relative error), or no rotation. `nees` is
/// that of OpenCV's standard deviations without correlations; mrcal and outside programs leave
/// none.
struct Rivals {
  ContestSetting setting;
  std::vector<RivalRow> rows;
  std::map<std::string, double> seconds;  ///< Wall time of each estimator over all trials.
};

/// @throws InputError for outside programs at other fidelities than `rendered`.
[[nodiscard]] Rivals EvaluateRivals(const ContestSetting& setting,
                                    const std::vector<MotionUnderTrial>& motions,
                                    const std::vector<OutsideEstimator>& outside,
                                    size_t most_frames = 50);

/// {"kind": "rivals", "rows": [..]}: the rows of MethodRow with "estimator".
[[nodiscard]] Value ToValue(const std::vector<Rivals>& tasks);
[[nodiscard]] std::vector<Chart> ChartsOf(const std::vector<Rivals>& tasks);

}  // namespace calibrato
