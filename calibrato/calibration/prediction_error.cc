#include "calibrato/calibration/prediction_error.h"

#include <array>
#include <cmath>
#include <vector>

#include "calibrato/calibration/pixel_derivatives.h"
#include "calibrato/geometry/so3.h"

namespace calibrato {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kColumns = 16;
constexpr int kRows = 12;
// From the camera [1/m]; 0 is infinity.
constexpr std::array<double, 3> kInverseDistances = {2.0, 0.5, 0.0};

// The middles of a grid of cells that covers the image.
std::vector<Vector2d> GridOf(Resolution resolution) {
  std::vector<Vector2d> pixels;
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      pixels.emplace_back((column + 0.5) / kColumns * resolution.width - 0.5,
                          (row + 0.5) / kRows * resolution.height - 0.5);
    }
  }
  return pixels;
}

// Root mean square of what adds squares.
class RootMeanSquare {
 public:
  void Add(double squared) {
    sum_ += squared;
    ++count_;
  }
  double value() const { return std::sqrt(sum_ / count_); }

 private:
  double sum_ = 0.0;
  int count_ = 0;
};

// Of the angular velocity [rad/s]. Of what is linear in it, the mean square over these six is that
// over all directions.
std::array<Vector3d, 6> Directions() {
  const Eigen::Matrix3d unit = Eigen::Matrix3d::Identity();
  return {unit.col(0), unit.col(1), unit.col(2), -unit.col(0), -unit.col(1), -unit.col(2)};
}

double DiagonalOf(Resolution resolution) { return std::hypot(resolution.width, resolution.height); }

}  // namespace

double PredictionErrorPx(const CameraModel& estimate, const CameraModel& truth,
                         Resolution resolution) {
  RootMeanSquare error;
  for (const Vector2d& pixel : GridOf(resolution)) {
    const auto ray = truth.Unproject(pixel);
    if (!ray) continue;  // The true lens sees nothing there.
    const auto predicted = estimate.Project(*ray);
    error.Add(predicted ? (*predicted - pixel).squaredNorm() : std::pow(DiagonalOf(resolution), 2));
  }
  return error.value();
}

double PredictionErrorPx(const CameraCalibrationState& estimate,
                         const CameraCalibrationState& truth, Resolution resolution) {
  const Rigid3 T_i_c = truth.T_c_i.Inverse();
  RootMeanSquare error;
  for (const Vector2d& pixel : GridOf(resolution)) {
    const auto ray = truth.model.Unproject(pixel);
    if (!ray) continue;
    const double late_s = estimate.time_offset_s - truth.time_offset_s +
                          (estimate.line_delay_s - truth.line_delay_s) * pixel.y();
    for (const double inverse_distance : kInverseDistances) {
      // The point times the inverse of its distance, which is finite at infinity and has the same
      // image.
      const Vector3d p_i = T_i_c.R * ray->normalized() + inverse_distance * T_i_c.t;
      for (const Vector3d& omega_i : Directions()) {
        const Vector3d p_i_later = ExpSo3(-late_s * omega_i) * p_i;
        const auto predicted = estimate.model.Project(estimate.T_c_i.R * p_i_later +
                                                      inverse_distance * estimate.T_c_i.t);
        error.Add(predicted ? (*predicted - pixel).squaredNorm()
                            : std::pow(DiagonalOf(resolution), 2));
      }
    }
  }
  return error.value();
}

double ExpectedPredictionErrorPx(const CameraCalibrationState& camera, Resolution resolution,
                                 const CameraImuLayout::Camera& columns,
                                 const MatrixXd& covariance) {
  const Rigid3 T_i_c = camera.T_c_i.Inverse();
  const int num_parameters = camera.model.num_parameters();
  RootMeanSquare error;
  MatrixXd J = MatrixXd::Zero(2, covariance.cols());
  for (const Vector2d& pixel : GridOf(resolution)) {
    const auto ray = camera.model.Unproject(pixel);
    if (!ray) continue;
    for (const double inverse_distance : kInverseDistances) {
      const Vector3d p_i = T_i_c.R * ray->normalized() + inverse_distance * T_i_c.t;
      const auto image = ProjectWithDerivatives(camera.model, ray->normalized());
      if (!image) continue;
      J.middleCols<3>(columns.pose) = -image->by_point * Hat(camera.T_c_i.R * p_i);
      J.middleCols<3>(columns.pose + 3) = inverse_distance * image->by_point;
      if (columns.parameters >= 0) {
        J.middleCols(columns.parameters, num_parameters) = image->by_parameters;
      }
      for (const Vector3d& omega_i : Directions()) {
        const Vector2d by_time = -image->by_point * (camera.T_c_i.R * omega_i.cross(p_i));
        if (columns.time_offset >= 0) J.col(columns.time_offset) = by_time;
        if (columns.line_delay >= 0) J.col(columns.line_delay) = pixel.y() * by_time;
        error.Add((J * covariance * J.transpose()).trace());
      }
    }
  }
  return error.value();
}

}  // namespace calibrato
