#include "calibrato/diagnosis/residual_field.h"

#include <algorithm>
#include <cmath>

namespace calibrato {
namespace {

Eigen::Index CellOf(double pixel, int image_size, int num_cells) {
  const double place = (pixel + 0.5) / image_size * num_cells;
  return std::clamp<Eigen::Index>(static_cast<Eigen::Index>(std::floor(place)), 0, num_cells - 1);
}

void FillCells(const CameraCalibration& calibration, Resolution resolution, ResidualField* field) {
  field->mean_u.setZero(ResidualField::kRows, ResidualField::kColumns);
  field->mean_v = field->mean_u;
  field->num_corners.setZero(ResidualField::kRows, ResidualField::kColumns);
  for (size_t v = 0; v < calibration.used_views.size(); ++v) {
    const Eigen::Matrix2Xd& pixels = calibration.used_views[v].pixels;
    const Eigen::Matrix2Xd& residuals = calibration.residuals[v];
    for (Eigen::Index k = 0; k < pixels.cols(); ++k) {
      const Eigen::Index row = CellOf(pixels(1, k), resolution.height, ResidualField::kRows);
      const Eigen::Index column = CellOf(pixels(0, k), resolution.width, ResidualField::kColumns);
      field->mean_u(row, column) += residuals(0, k);
      field->mean_v(row, column) += residuals(1, k);
      ++field->num_corners(row, column);
    }
  }
  // An empty cell becomes 0 / 0: not a number.
  field->mean_u = field->mean_u.cwiseQuotient(field->num_corners.cast<double>());
  field->mean_v = field->mean_v.cwiseQuotient(field->num_corners.cast<double>());
}

// Of the corners after k in the view, the one nearest to it on the board: each pair comes once.
Eigen::Index NeighbourOf(const BoardView& view, Eigen::Index k) {
  Eigen::Index nearest = 0;
  const auto rest = view.points_g.rightCols(view.num_corners() - k - 1);
  (rest.colwise() - view.points_g.col(k)).colwise().squaredNorm().minCoeff(&nearest);
  return k + 1 + nearest;
}

void Correlate(const CameraCalibration& calibration, ResidualField* field) {
  double products = 0.0;
  double squares = 0.0;
  double num_pairs = 0.0;
  for (size_t v = 0; v < calibration.used_views.size(); ++v) {
    const BoardView& view = calibration.used_views[v];
    const Eigen::Matrix2Xd& residuals = calibration.residuals[v];
    for (Eigen::Index k = 0; k + 1 < view.num_corners(); ++k) {
      const Eigen::Index neighbour = NeighbourOf(view, k);
      products += residuals.col(k).dot(residuals.col(neighbour));
      squares += 0.5 * (residuals.col(k).squaredNorm() + residuals.col(neighbour).squaredNorm());
      num_pairs += 1.0;
    }
  }
  if (!(squares > 0.0)) return;
  field->neighbour_correlation = products / squares;
  // Var(r_i . r_j) = 2 sigma^4, over the squared mean of |r|^2, 4 sigma^4.
  field->correlation_sigma = 1.0 / std::sqrt(2.0 * num_pairs);
  field->systematic_rms_px =
      std::sqrt(std::max(0.0, field->neighbour_correlation)) * calibration.reprojection_rms_px;
}

}  // namespace

ResidualField ResidualFieldOf(const CameraCalibration& calibration, Resolution resolution) {
  ResidualField field;
  FillCells(calibration, resolution, &field);
  Correlate(calibration, &field);
  return field;
}

}  // namespace calibrato
