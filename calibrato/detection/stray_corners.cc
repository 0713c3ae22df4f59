#include "calibrato/detection/stray_corners.h"

#include <algorithm>

namespace calibrato {

std::vector<LocalMap> RemoveStrays(const Eigen::Matrix2Xd& board, const Eigen::Vector2d& steps_m,
                                   const MapFit& fit, double share_of_worst,
                                   std::vector<std::optional<Eigen::Vector2d>>* corners,
                                   RejectionCounts* rejected) {
  constexpr double kMaxSurprise = 0.25;  // of a step
  constexpr double kMinSurprise = 1.0;   // [px]
  while (true) {
    std::vector<Eigen::Index> kept;
    for (size_t k = 0; k < corners->size(); ++k) {
      if ((*corners)[k]) kept.push_back(static_cast<Eigen::Index>(k));
    }
    std::vector<LocalMap> maps(corners->size());
    if (kept.size() < 4) return maps;
    Eigen::Matrix2Xd pixels(2, static_cast<Eigen::Index>(kept.size()));
    for (Eigen::Index i = 0; i < pixels.cols(); ++i) {
      pixels.col(i) = *(*corners)[static_cast<size_t>(kept[static_cast<size_t>(i)])];
    }
    const std::vector<LocalMap> fitted = fit(board(Eigen::all, kept), pixels);
    std::vector<double> surprises;
    for (size_t i = 0; i < kept.size(); ++i) {
      const LocalMap& map = fitted[i];
      maps[static_cast<size_t>(kept[i])] = map;
      const Eigen::Matrix2d steps = map.J_pixel_board * steps_m.asDiagonal();
      const double allowed =
          std::max(kMinSurprise, kMaxSurprise * steps.colwise().norm().minCoeff());
      surprises.push_back(map.surprise / allowed);
    }
    const double worst = *std::max_element(surprises.begin(), surprises.end());
    if (!(worst > 1.0)) return maps;
    for (size_t i = 0; i < kept.size(); ++i) {
      if (!(surprises[i] > 1.0 && surprises[i] >= share_of_worst * worst)) continue;
      (*corners)[static_cast<size_t>(kept[i])].reset();
      ++rejected->corners_of_bad_fit;
    }
  }
}

}  // namespace calibrato
