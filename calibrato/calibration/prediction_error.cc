#include "calibrato/calibration/prediction_error.h"

#include <cmath>

namespace calibrato {

double PredictionErrorPx(const CameraModel& estimate, const CameraModel& truth,
                         Resolution resolution) {
  constexpr int kColumns = 16;
  constexpr int kRows = 12;
  const double diagonal = std::hypot(resolution.width, resolution.height);
  double sum = 0.0;
  int count = 0;
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      const Eigen::Vector2d pixel((column + 0.5) / kColumns * resolution.width - 0.5,
                                  (row + 0.5) / kRows * resolution.height - 0.5);
      const auto ray = truth.Unproject(pixel);
      if (!ray) continue;  // The true lens sees nothing there.
      const auto predicted = estimate.Project(*ray);
      const double error = predicted ? (*predicted - pixel).norm() : diagonal;
      sum += error * error;
      ++count;
    }
  }
  return std::sqrt(sum / count);
}

}  // namespace calibrato
