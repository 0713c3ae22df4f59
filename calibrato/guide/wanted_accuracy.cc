#include "calibrato/guide/wanted_accuracy.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "calibrato/base/input_error.h"
#include "calibrato/base/nearest_name.h"
#include "calibrato/base/scalar_text.h"

namespace calibrato {

void SetWanted(const std::string& word, WantedAccuracy* wanted) {
  struct Entry {
    const char* name;
    double* value;
    double unit;
  };
  const std::array<Entry, 4> entries = {
      Entry{"focal-percent", &wanted->focal_share, 1e-2},
      Entry{"rotation-deg", &wanted->rotation_rad, std::numbers::pi / 180.0},
      Entry{"translation-mm", &wanted->translation_m, 1e-3},
      Entry{"time-ms", &wanted->time_offset_s, 1e-3}};
  const size_t equals = word.find('=');
  const std::string name = word.substr(0, equals);
  std::vector<std::string> names;
  for (const Entry& entry : entries) {
    names.emplace_back(entry.name);
    if (name != entry.name) continue;
    const auto value =
        equals == std::string::npos ? std::nullopt : ParseDecimal(word.substr(equals + 1));
    if (!value || !(*value > 0.0) || !std::isfinite(*value)) {
      throw InputError({"not an accuracy: '" + word + "'", "--want", "its value must be above 0",
                        "give it as " + name + "=0.1"});
    }
    *entry.value = *value * entry.unit;
    return;
  }
  const auto nearest = NearestName(name, names);
  throw InputError({"nothing called '" + name + "' can be wanted", "--want", "",
                    (nearest ? "did you mean " + *nearest + "? " : std::string()) +
                        "there are focal-percent, rotation-deg, translation-mm and time-ms"});
}

std::vector<ParameterProgress> ProgressOf(const Eigen::MatrixXd& information,
                                          const KnowledgeLayout& layout, const CameraModel& camera,
                                          const WantedAccuracy& wanted) {
  const Eigen::MatrixXd covariance =
      information.ldlt().solve(Eigen::MatrixXd::Identity(layout.size(), layout.size()));
  std::vector<ParameterProgress> progress;
  if (layout.num_parameters > 0) {
    const int focal = CameraModel::FocalIndex(camera.name());
    const double share = wanted.focal_share * camera.focal_and_centre()(0);
    const auto names = CameraModel::ParameterNames(camera.name());
    for (int k = focal; k < focal + 4; ++k) {
      const int place = layout.parameters() + k;
      progress.push_back(
          {names[static_cast<size_t>(k)], "px", std::sqrt(covariance(place, place)), share});
    }
  }
  if (layout.has_imu) {
    constexpr std::array<const char*, 7> kNames = {"rot_x", "rot_y", "rot_z",      "pos_x",
                                                   "pos_y", "pos_z", "time_offset"};
    for (int k = 0; k < 7; ++k) {
      const bool is_angle = k < 3;
      const bool is_time = k == 6;
      progress.push_back({kNames[static_cast<size_t>(k)],
                          is_angle  ? "rad"
                          : is_time ? "s"
                                    : "m",
                          std::sqrt(covariance(k, k)),
                          is_angle  ? wanted.rotation_rad
                          : is_time ? wanted.time_offset_s
                                    : wanted.translation_m});
    }
  }
  return progress;
}

double DistanceFromWanted(const std::vector<ParameterProgress>& progress) {
  constexpr double kShareOfAll = 0.02;
  double distance = 0.0;
  for (const ParameterProgress& parameter : progress) {
    const double excess = std::log(parameter.sigma / parameter.wanted);
    distance += std::max(0.0, excess) + kShareOfAll * excess;
  }
  return distance;
}

}  // namespace calibrato
