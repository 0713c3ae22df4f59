#include "calibrato/diagnosis/checks_document.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace calibrato {
namespace {

// Four digits are enough to draw, and keep the file small.
double FourDigits(double x) {
  if (!std::isfinite(x) || x == 0.0) return x;
  const double unit = std::pow(10.0, std::floor(std::log10(std::abs(x))) - 3.0);
  return std::round(x / unit) * unit;
}

Value Rows(const Eigen::MatrixXd& matrix) {
  Value rows = Value::Array();
  for (Eigen::Index row = 0; row < matrix.rows(); ++row) {
    Value numbers = Value::Array();
    for (const double x : matrix.row(row)) numbers.Append(FourDigits(x));
    rows.Append(std::move(numbers));
  }
  return rows;
}

double MedianDistance(const CameraCalibration& calibration) {
  std::vector<double> distances;
  for (size_t v = 0; v < calibration.used_views.size(); ++v) {
    const Eigen::Vector3d middle_g = calibration.used_views[v].points_g.rowwise().mean();
    distances.push_back((calibration.T_c_g[v] * middle_g).norm());
  }
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  return *middle;
}

Value SplitValue(const SplitCheck& split) {
  Value value = Value::Object();
  value.Set("first", Value::Numbers(split.parameters[0]))
      .Set("second", Value::Numbers(split.parameters[1]))
      .Set("sigma", Value::Numbers(split.sigma))
      .Set("probability", split.significance.probability)
      .Set("in_sample_stddev_px", split.in_sample_stddev_px)
      .Set("held_out_stddev_px", split.held_out_stddev_px)
      .Set("expected_held_out_stddev_px", split.expected_held_out_stddev_px);
  return value;
}

Value ResidualFieldValue(const ResidualField& field) {
  Value value = Value::Object();
  value.Set("mean_u_px", Rows(field.mean_u))
      .Set("mean_v_px", Rows(field.mean_v))
      .Set("num_corners", Rows(field.num_corners.cast<double>()))
      .Set("systematic_rms_px", field.systematic_rms_px)
      .Set("neighbour_correlation", field.neighbour_correlation)
      .Set("correlation_sigma", field.correlation_sigma);
  return value;
}

Value BendingValue(const BoardBendingEstimate& estimate) {
  Value value = Value::Object();
  value.Set("coefficients_per_m", Value::Numbers(estimate.bending.coefficients))
      .Set("depth_m", estimate.depth_m)
      .Set("probability", estimate.significance.probability);
  return value;
}

Value StretchValue(const BoardStretchEstimate& estimate) {
  Value value = Value::Object();
  value.Set("stretch", estimate.stretch)
      .Set("stretch_sigma", estimate.stretch_sigma)
      .Set("shear_rad", estimate.shear)
      .Set("shear_sigma_rad", estimate.shear_sigma)
      .Set("probability", estimate.significance.probability);
  return value;
}

}  // namespace

Value ToValue(const ImageMap& map) {
  Value value = Value::Object();
  value.Set("median_px", map.median).Set("worst_px", map.worst).Set("values_px", Rows(map.values));
  return value;
}

Value ProjectionUncertaintyValue(const std::optional<HousedCamera>& camera,
                                 const CameraCalibration& calibration, Resolution resolution) {
  if (!camera || calibration.used_views.empty()) return {};
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const double distance_m = MedianDistance(calibration);
  Value value = Value::Object();
  value.Set("distance_m", distance_m)
      .Set("at_distance", ToValue(ProjectionUncertainty(*camera, resolution, distance_m)))
      .Set("at_infinity", ToValue(ProjectionUncertainty(*camera, resolution, kInfinity)));
  return value;
}

Value ChecksValue(const CameraDiagnosis& diagnosis) {
  const std::optional<BoardShape>& shape = diagnosis.board_shape;
  Value value = Value::Object();
  value.Set("split", diagnosis.split ? SplitValue(*diagnosis.split) : Value())
      .Set("residual_field",
           diagnosis.residual_field ? ResidualFieldValue(*diagnosis.residual_field) : Value())
      .Set("bending", shape ? BendingValue(shape->bending) : Value())
      .Set("stretch", shape && shape->stretch ? StretchValue(*shape->stretch) : Value());
  return value;
}

}  // namespace calibrato
