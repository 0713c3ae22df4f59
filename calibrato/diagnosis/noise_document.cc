#include "calibrato/diagnosis/noise_document.h"

#include <cmath>
#include <cstdlib>
#include <utility>

#include "calibrato/diagnosis/finding.h"

namespace calibrato {
namespace {

// Four digits are enough to draw by.
double Rounded(double x) { return std::strtod(Format("%.4g", x).c_str(), nullptr); }

Value AxisValue(const AxisNoise& axis) {
  Value tau = Value::Array();
  Value deviation = Value::Array();
  Value sigma = Value::Array();
  for (size_t k = 0; k < axis.points.size(); ++k) {
    tau.Append(Rounded(axis.points[k].tau_s));
    deviation.Append(Rounded(axis.points[k].deviation));
    sigma.Append(Rounded(axis.relative_sigma[k]));
  }
  Value value = Value::Object();
  value.Set("noise_density", axis.white.value)
      .Set("noise_density_is_upper_bound", axis.white.is_upper_bound)
      .Set("random_walk", axis.walk.value)
      .Set("random_walk_is_upper_bound", axis.walk.is_upper_bound)
      .Set("bias_instability", axis.bias_instability)
      .Set("tau_s", std::move(tau))
      .Set("deviation", std::move(deviation))
      .Set("relative_sigma", std::move(sigma));
  return value;
}

void SetFigure(const std::string& name, const NoiseFigure& figure, Value* value) {
  value->Set(name, figure.value)
      .Set(name + "_relative_sigma", figure.relative_sigma)
      .Set(name + "_is_upper_bound", figure.is_upper_bound);
}

Value SensorValue(const SensorNoiseEstimate& sensor) {
  Value axes = Value::Array();
  for (const AxisNoise& axis : sensor.axes) axes.Append(AxisValue(axis));
  Value value = Value::Object();
  value.Set("rate_hz", sensor.rate_hz).Set("duration_s", sensor.duration_s);
  SetFigure("noise_density", sensor.white, &value);
  SetFigure("random_walk", sensor.walk, &value);
  value.Set("axes", std::move(axes));
  return value;
}

std::string FigureText(const NoiseFigure& figure) {
  if (figure.is_upper_bound) return Format("below %.3g", figure.value);
  return Format("%.4g +- %.1f %%", figure.value, 100.0 * figure.relative_sigma);
}

}  // namespace

Value NoiseResult(const std::vector<NamedNoise>& imus) {
  Value warnings = Value::Array();
  Value array = Value::Array();
  for (const NamedNoise& imu : imus) {
    for (const std::string& warning : imu.estimate.warnings) warnings.Append(warning);
    Value value = Value::Object();
    value.Set("name", imu.name)
        .Set("gyro", SensorValue(imu.estimate.gyro))
        .Set("accel", SensorValue(imu.estimate.accel));
    array.Append(std::move(value));
  }
  Value result = Value::Object();
  result.Set("kind", "noise").Set("warnings", std::move(warnings)).Set("imus", std::move(array));
  return result;
}

std::string NoiseText(const std::vector<NamedNoise>& imus) {
  std::string text;
  for (const NamedNoise& imu : imus) {
    for (const auto& [name, unit, sensor] :
         {std::tuple("gyroscope", "rad/s", &imu.estimate.gyro),
          std::tuple("accelerometer", "m/s^2", &imu.estimate.accel)}) {
      text += Format("%s %s: %.0f s at %.4g Hz\n", imu.name.c_str(), name, sensor->duration_s,
                     sensor->rate_hz);
      text += Format("  noise density  %s %s/sqrt(Hz)\n", FigureText(sensor->white).c_str(), unit);
      text += Format("  random walk    %s %s/s/sqrt(Hz)\n", FigureText(sensor->walk).c_str(), unit);
      for (size_t axis = 0; axis < sensor->axes.size(); ++axis) {
        const double instability = sensor->axes[axis].bias_instability;
        if (instability > 0.0) {
          text += Format("  bias instability of %c: %.3g %s\n", "xyz"[axis], instability, unit);
        }
      }
    }
  }
  return text;
}

}  // namespace calibrato
