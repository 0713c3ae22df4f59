// Documents of what is said of recordings before they are solved.

#include <cmath>
#include <string>
#include <vector>

#include "calibrato/report/documents_for_test.h"

namespace calibrato {
namespace {

Value Numbers(const std::vector<double>& numbers) { return Value::Numbers(numbers); }

// A sine of so many values, as an envelope.
Value Wave(double size) {
  std::vector<double> times_s;
  std::vector<double> low;
  std::vector<double> high;
  for (int k = 0; k < 100; ++k) {
    times_s.push_back(0.2 * k);
    low.push_back(size * std::sin(0.3 * k) - 0.1 * size);
    high.push_back(size * std::sin(0.3 * k) + 0.1 * size);
  }
  return std::move(Value::Object()
                       .Set("time_s", Numbers(times_s))
                       .Set("low", Numbers(low))
                       .Set("high", Numbers(high)));
}

Value Stream(const std::string& name, double rate_hz) {
  return std::move(Value::Object()
                       .Set("name", name)
                       .Set("verdict", "warn")
                       .Set("num", 4000)
                       .Set("duration_s", 20.0)
                       .Set("rate_hz", rate_hz)
                       .Set("jitter_s", 1e-4)
                       .Set("num_missing", 3)
                       .Set("num_gaps", 1)
                       .Set("longest_gap_s", 0.43)
                       .Set("steps_back_s", Value::Array())
                       .Set("num_duplicates", 7));
}

Value CheckPlotsForTest() {
  std::vector<double> times_s;
  std::vector<double> corners;
  Value pixels = Value::Array();
  for (int k = 0; k < 200; ++k) {
    times_s.push_back(0.1 * k);
    corners.push_back(k % 40 < 30 ? 42 : 0);
    pixels.Append(Numbers({3.0 * k, 2.0 * k}));
  }
  Value camera = Value::Object();
  camera.Set("name", "cam0")
      .Set("resolution", Numbers({640, 480}))
      .Set("time_s", Numbers(times_s))
      .Set("num_corners", Numbers(corners))
      .Set("edge_time_s", Numbers({1.0, 5.0, 9.0}))
      .Set("edge_width_px", Numbers({2.0, 3.5, 2.2}))
      .Set("corners", std::move(pixels));
  const auto three = [](double size) {
    return Value::Array().Append(Wave(size)).Append(Wave(size)).Append(Wave(size));
  };
  Value imu = Value::Object();
  imu.Set("name", "imu0").Set("gyro", three(0.5)).Set("accel", three(2.0));
  Value interval = Value::Object();
  interval.Set("name", "cam0").Set("median_ms", 100.0).Set("interval_ms", Wave(100.0));
  return std::move(Value::Object()
                       .Set("duration_s", 20.0)
                       .Set("cameras", Value::Array().Append(camera))
                       .Set("imus", Value::Array().Append(imu))
                       .Set("intervals", Value::Array().Append(interval)));
}

Value NoiseSensor() {
  std::vector<double> tau_s;
  std::vector<double> deviation;
  std::vector<double> sigma;
  for (int k = 0; k < 40; ++k) {
    tau_s.push_back(0.005 * std::exp2(0.5 * k));
    deviation.push_back(std::sqrt(4e-8 / tau_s.back() + 1e-10 * tau_s.back()));
    sigma.push_back(0.01 * k);
  }
  Value axis = Value::Object();
  axis.Set("noise_density", 2e-4)
      .Set("random_walk", 1.7e-5)
      .Set("bias_instability", 6e-5)
      .Set("tau_s", Numbers(tau_s))
      .Set("deviation", Numbers(deviation))
      .Set("relative_sigma", Numbers(sigma));
  return std::move(Value::Object()
                       .Set("rate_hz", 200.0)
                       .Set("duration_s", 10800.0)
                       .Set("noise_density", 2e-4)
                       .Set("noise_density_relative_sigma", 0.005)
                       .Set("noise_density_is_upper_bound", false)
                       .Set("random_walk", 3e-5)
                       .Set("random_walk_relative_sigma", 1.0)
                       .Set("random_walk_is_upper_bound", true)
                       .Set("axes", Value::Array().Append(axis).Append(axis).Append(axis)));
}

}  // namespace

Value CheckDocumentForTest() {
  Value finding = Value::Object();
  finding.Set("severity", "warn")
      .Set("what", "cam0: about 3 images are missing; the longest gap is 0.43 s")
      .Set("remedy", "record to a faster disk");
  Value clock = Value::Object();
  clock.Set("imu", "imu0")
      .Set("camera", "cam0")
      .Set("time_offset_s", 0.02)
      .Set("correlation", 0.993)
      .Set("speed_ratio", 1.01)
      .Set("pieces", Value::Array()
                         .Append(Value::Object().Set("time_offset_s", 0.01))
                         .Append(Value::Object().Set("time_offset_s", 0.03)));
  Value board = Value::Object();
  board.Set("camera", "cam0")
      .Set("verdict", "warn")
      .Set("num_images", 200)
      .Set("num_with_board", 150)
      .Set("longest_away_s", 1.0)
      .Set("coverage",
           Value::Object().Set("x", 0.7).Set("y", 1.0).Set("size", 0.5).Set("skew", 1.0))
      .Set("uncovered_parts", Value::Array().Append("top left"))
      .Set("travel_m", Numbers({0.3, 0.2, 0.4}))
      .Set("edge_width_px", 2.2)
      .Set("black", 20.0)
      .Set("white", 210.0)
      .Set("brightness", 110.0);
  Value motion = Value::Object();
  motion.Set("imu", "imu0")
      .Set("verdict", "pass")
      .Set("rates_rad_s", Numbers({0.5, 0.4, 0.3}))
      .Set("forces_m_s2", Numbers({1.5, 0.4, 2.3}))
      .Set("median_force_m_s2", 9.81)
      .Set("rest", Value::Object()
                       .Set("duration_s", 3.0)
                       .Set("gyro_noise_density", 2e-4)
                       .Set("accel_noise_density", 2e-3));
  const auto expected = [](const std::string& name, double sigma, const std::string& advice) {
    return Value::Object()
        .Set("name", name)
        .Set("sigma", sigma)
        .Set("enough", 5e-3)
        .Set("verdict", advice.empty() ? "pass" : "warn")
        .Set("advice", advice);
  };
  return std::move(
      Value::Object()
          .Set("kind", "check")
          .Set("verdict", "warn")
          .Set("findings", Value::Array().Append(finding))
          .Set("streams",
               Value::Array().Append(Stream("cam0", 10.0)).Append(Stream("imu0 gyroscope", 200.0)))
          .Set("clocks", Value::Array().Append(clock))
          .Set("boards", Value::Array().Append(board))
          .Set("motions", Value::Array().Append(motion))
          .Set("expected",
               Value::Array()
                   .Append(expected("cam0.pos_x", 2e-3, ""))
                   .Append(expected("cam0.pos_y", 7e-3, "record 15 s more, rotate about x")))
          .Set("plots", CheckPlotsForTest()));
}

Value NoiseDocumentForTest() {
  Value imu = Value::Object();
  imu.Set("name", "imu0").Set("gyro", NoiseSensor()).Set("accel", NoiseSensor());
  return std::move(
      Value::Object()
          .Set("kind", "noise")
          .Set("warnings", Value::Array().Append("imu0 gyroscope: the log of 60 s is too short"))
          .Set("imus", Value::Array().Append(imu)));
}

}  // namespace calibrato
