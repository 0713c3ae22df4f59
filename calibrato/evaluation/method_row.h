#pragma once

#include <string>
#include <vector>

#include "calibrato/base/value.h"
#include "calibrato/evaluation/contest.h"
#include "calibrato/evaluation/statistics.h"
#include "calibrato/evaluation/trial.h"

namespace calibrato {

/// A figure of trials that rows carry as its mean, with its key (docs/formats.md section 3).
struct NamedFigure {
  const char* key;
  double Trial::*figure;
};
inline constexpr NamedFigure kTrialFigures[] = {
    {"prediction_error_px", &Trial::prediction_error_px},
    {"focal_error_px", &Trial::focal_error_px},
    {"centre_error_px", &Trial::centre_error_px},
    {"distortion_error_px", &Trial::distortion_error_px},
    {"translation_error_m", &Trial::translation_error_m},
    {"rotation_error_rad", &Trial::rotation_error_rad},
    {"time_offset_error_s", &Trial::time_offset_error_s},
    {"a_optimality", &Trial::a_optimality},
    {"a_optimality_conditional", &Trial::a_optimality_conditional},
    {"a_optimality_original", &Trial::a_optimality_original}};

/// [low, high], each times the factor.
[[nodiscard]] Value PairValue(const Interval& interval, double factor = 1.0);

/// Null for what is not there.
[[nodiscard]] Value FiniteValue(double x);

/// {"task", "carrier", "fidelity", "rigs", "seed"}: what every row of every table says of where it
/// comes from.
[[nodiscard]] Value SettingValue(const ContestSetting& setting);

/// What every table and figure says of one method in one setting: where it comes from, n, errors
/// with medians and intervals, path, time, frames, honesty of the covariance, failures. Means are
/// over the trials that did not fail.
/// @param rng  Of the bootstrap.
[[nodiscard]] Value MethodRow(const ContestSetting& setting, const std::string& policy,
                              const std::vector<std::vector<Trial>>& trials, const Rng& rng);

}  // namespace calibrato
