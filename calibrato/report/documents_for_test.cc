#include "calibrato/report/documents_for_test.h"

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "calibrato/base/rng.h"

namespace calibrato {
namespace {

constexpr double kFocal = 585.76;  // [px]
constexpr double kCentreU = 320.5;
constexpr double kCentreV = 240.5;

Value Numbers(std::vector<double> numbers) { return Value::Numbers(numbers); }

double Rounded(double x) { return std::round(1e5 * x) / 1e5; }

using Point = std::array<double, 3>;

Point Rotated(double about_x, double about_y, const Point& p) {
  const Point q = {p[0], std::cos(about_x) * p[1] - std::sin(about_x) * p[2],
                   std::sin(about_x) * p[1] + std::cos(about_x) * p[2]};
  return {std::cos(about_y) * q[0] + std::sin(about_y) * q[2], q[1],
          -std::sin(about_y) * q[0] + std::cos(about_y) * q[2]};
}

std::vector<Point> BoardPoints() {
  std::vector<Point> points;
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 7; ++column) points.push_back({0.06 * row, 0.06 * column, 0.0});
  }
  return points;
}

Value View(int index, Rng* rng) {
  const double about_x = rng->Uniform(-0.5, 0.5);
  const double about_y = rng->Uniform(-0.5, 0.5);
  const double depth = rng->Uniform(0.9, 1.5);
  const Point shift = {depth * rng->Uniform(-0.4, 0.1), depth * rng->Uniform(-0.35, 0.0), depth};
  Value pixels = Value::Array();
  Value residuals = Value::Array();
  double sum = 0.0;
  for (const Point& point : BoardPoints()) {
    Point in_camera = Rotated(about_x, about_y, point);
    for (int i = 0; i < 3; ++i) in_camera[i] += shift[i];
    pixels.Append(Numbers({Rounded(kFocal * in_camera[0] / in_camera[2] + kCentreU),
                           Rounded(kFocal * in_camera[1] / in_camera[2] + kCentreV)}));
    const double du = rng->Normal(0.0, 0.1);
    const double dv = rng->Normal(0.0, 0.1);
    sum += du * du + dv * dv;
    residuals.Append(Numbers({Rounded(du), Rounded(dv)}));
  }
  const Point x = Rotated(about_x, about_y, {1, 0, 0});
  const Point y = Rotated(about_x, about_y, {0, 1, 0});
  const Point z = Rotated(about_x, about_y, {0, 0, 1});
  Value T_c_g = Value::Array();
  for (int i = 0; i < 3; ++i) T_c_g.Append(Numbers({x[i], y[i], z[i], shift[i]}));
  T_c_g.Append(Numbers({0, 0, 0, 1}));
  return std::move(Value::Object()
                       .Set("name", "left" + std::to_string(index) + ".jpg")
                       .Set("rms_px", std::sqrt(sum / 42))
                       .Set("pixels", pixels)
                       .Set("residuals", residuals)
                       .Set("T_c_g", T_c_g));
}

Value CameraCovariance() {
  const std::vector<std::string> names = {"fu", "fv", "pu", "pv", "k1", "k2", "p1", "p2"};
  const std::vector<double> sigma = {0.62, 0.61, 0.48, 0.44, 1.1e-3, 4e-3, 2.1e-4, 2.4e-4};
  Value labels = Value::Array();
  Value matrix = Value::Array();
  for (size_t i = 0; i < names.size(); ++i) {
    labels.Append("cam0." + names[i]);
    std::vector<double> row;
    for (size_t j = 0; j < names.size(); ++j) {
      const double apart = std::abs(static_cast<double>(i) - static_cast<double>(j));
      const double sign = (i + j) % 3 == 0 ? -1.0 : 1.0;
      row.push_back(sigma[i] * sigma[j] * (i == j ? 1.0 : sign * std::exp(-0.7 * apart)));
    }
    matrix.Append(Value::Numbers(row));
  }
  return std::move(Value::Object().Set("names", labels).Set("matrix", matrix));
}

Value Distortion() {
  std::vector<double> radius;
  std::vector<double> shift;
  for (int i = 0; i <= 40; ++i) {
    radius.push_back(10.0 * i);
    const double r = radius.back() / kFocal;
    shift.push_back(kFocal * (-0.28 * r * r * r + 0.07 * r * r * r * r * r));
  }
  return std::move(Value::Object()
                       .Set("radius_px", Value::Numbers(radius))
                       .Set("shift_px", Value::Numbers(shift)));
}

// The camera's path: loops of two harmonics around the start, of this size [m].
// A camera that swings before the board at the end of an arm with one elbow.
Value Played(double size) {
  Value camera = Value::Array();
  Value arm = Value::Array();
  for (int k = 0; k <= 200; ++k) {
    const double x = 0.45 + size * std::sin(0.1 * k);
    camera.Append(Numbers({Rounded(x), 0.05, 0.5, 0.0, 0.7071, 0.0, 0.7071}));
    arm.Append(Numbers({0.0, 0.0, 0.0, 0.1, 0.0, 0.7, Rounded(x), 0.05, 0.55}));
  }
  Value played = Value::Object();
  played.Set("step_s", 0.1).Set("camera_b", camera).Set("arm_b", arm);
  return played;
}

Value Motion(const std::string& policy, double size, double path_length_m) {
  Value loops = Value::Array();
  Value axes = Value::Array();
  for (int loop = 0; loop < 4; ++loop) {
    Value points = Value::Array();
    for (int i = 0; i <= 62; ++i) {
      const double theta = 2 * std::numbers::pi * i / 62;
      const Point p = {0.45 + size * (std::sin(theta + loop) - std::sin(loop)),
                       0.05 + size * (1 - std::cos(theta)) * (loop - 1.5),
                       0.5 + 0.6 * size * std::sin(2 * theta) * (loop % 2 == 0 ? 1 : -1)};
      points.Append(Numbers({Rounded(p[0]), Rounded(p[1]), Rounded(p[2])}));
      if (i % 10 == 0) {
        const Point to_board = {1.85 - p[0], 0.0 - p[1], 0.3 - p[2]};
        const double norm = std::hypot(to_board[0], to_board[1], to_board[2]);
        axes.Append(Numbers(
            {p[0], p[1], p[2], to_board[0] / norm, to_board[1] / norm, to_board[2] / norm}));
      }
    }
    loops.Append(points);
  }
  return std::move(Value::Object()
                       .Set("policy", policy)
                       .Set("path_length_m", path_length_m)
                       .Set("motion_s", 20.0)
                       .Set("loops", loops)
                       .Set("axis_b", axes)
                       .Set("played", Played(size)));
}

Value BoardOutline() {
  Value outline = Value::Array();
  for (const auto& [y, z] : {std::pair{-0.15, 0.15}, {0.15, 0.15}, {0.15, 0.45}, {-0.15, 0.45}}) {
    outline.Append(Numbers({1.85, y, z}));
  }
  return outline;
}

Value TrainingLine(int episode, const std::string& kind, double progress, Rng* rng) {
  const double coverage = 1.2 + 1.8 * progress + rng->Normal(0, 0.25);
  const double error = 0.006 * std::exp(-1.3 * progress + rng->Normal(0, 0.35));
  const double path = 11 - 5 * progress + rng->Normal(0, 0.8);
  const double total = coverage - 200 * error - 0.1 * path;
  Value line = Value::Object();
  line.Set("episode", episode)
      .Set("kind", kind)
      .Set("stage", episode < 200 ? "learned" : "fine-tuned")
      .Set("return", Rounded(total));
  line.Set("terms", Value::Object()
                        .Set("coverage", Rounded(coverage))
                        .Set("relative_error", Rounded(-200 * error))
                        .Set("path_length", Rounded(-0.1 * path)));
  line.Set("final_relative_error", error).Set("path_length_m", Rounded(path));
  line.Set("refused", rng->Uniform() < 0.1 * (1 - progress) ? 1 : 0);
  if (kind != "random") {
    line.Set("dynamics_loss", 0.9 * std::exp(-3 * progress) + 0.05 * rng->Uniform());
    line.Set("reward_loss", 0.5 * std::exp(-2 * progress) + 0.03 * rng->Uniform());
    line.Set("predicted_return", Rounded(total + 0.3 + rng->Normal(0, 0.4)));
    line.Set("reward_prediction_error", 0.4 * std::exp(-progress));
    line.Set("observation_prediction_error", 0.8 * std::exp(-progress));
    std::vector<double> best_so_far;
    for (int k = 0; k < 6; ++k) best_so_far.push_back(Rounded(total + 0.1 * k));
    line.Set("best_so_far", Value::Numbers(best_so_far));
  } else {
    line.Set("dynamics_loss", Value()).Set("reward_loss", Value()).Set("predicted_return", Value());
  }
  return line;
}

// The projection uncertainty over an image: least in the middle, up to `worst` in the corners.
Value UncertaintyMap(double worst) {
  Value rows = Value::Array();
  for (int row = 0; row < 24; ++row) {
    std::vector<double> numbers;
    for (int column = 0; column < 32; ++column) {
      const double off = std::hypot((column - 15.5) / 15.5, (row - 11.5) / 11.5) / std::sqrt(2.0);
      numbers.push_back(Rounded(worst * (0.1 + 0.9 * off * off * off)));
    }
    rows.Append(Value::Numbers(numbers));
  }
  return std::move(
      Value::Object().Set("median_px", 0.25 * worst).Set("worst_px", worst).Set("values_px", rows));
}

Value Checks(Rng* rng) {
  Value mean_u = Value::Array();
  Value mean_v = Value::Array();
  for (int row = 0; row < 6; ++row) {
    std::vector<double> u;
    std::vector<double> v;
    for (int column = 0; column < 8; ++column) {
      u.push_back(Rounded(rng->Normal(0, 0.02)));
      v.push_back(Rounded(rng->Normal(0, 0.02)));
    }
    mean_u.Append(Value::Numbers(u));
    mean_v.Append(Value::Numbers(v));
  }
  return std::move(
      Value::Object()
          .Set("split", Value::Object()
                            .Set("probability", 0.31)
                            .Set("in_sample_stddev_px", 0.1)
                            .Set("held_out_stddev_px", 0.11)
                            .Set("expected_held_out_stddev_px", 0.105))
          .Set("residual_field", Value::Object()
                                     .Set("mean_u_px", mean_u)
                                     .Set("mean_v_px", mean_v)
                                     .Set("systematic_rms_px", 0.012)
                                     .Set("probability", 0.2))
          .Set("bending", Value::Object().Set("depth_m", 7.1e-4).Set("probability", 1e-5))
          .Set("stretch", Value::Object().Set("stretch", 3e-4).Set("probability", 0.4)));
}

Value Rejected() {
  Value corner = Value::Object();
  corner.Set("view", "left3.jpg").Set("corner_id", 7).Set("residual_px", Numbers({2.1, -3.4}));
  Value view = Value::Object();
  view.Set("name", "left26.jpg")
      .Set("reason", "does not fit")
      .Set("num_corners", 42)
      .Set("rms_px", 7.12);
  return std::move(Value::Object()
                       .Set("num_corners", 1)
                       .Set("corners", Value::Array().Append(corner))
                       .Set("views", Value::Array().Append(view))
                       .Set("images_without_board", 2)
                       .Set("detection", Value::Object().Set("corners_near_border", 5)));
}

// One row of the board, bent and straight.
Value Straightened() {
  Value pixels = Value::Array();
  Value straight = Value::Array();
  for (int k = 0; k < 7; ++k) {
    pixels.Append(Numbers({100.0 + 60 * k, 80.0 + 2 * (k - 3) * (k - 3)}));
    straight.Append(Numbers({100.0 + 60 * k, 90.0}));
  }
  return std::move(Value::Object()
                       .Set("name", "left4.jpg")
                       .Set("pixels", pixels)
                       .Set("straightened", straight)
                       .Set("lines", Value::Array().Append(Numbers({0, 1, 2, 3, 4, 5, 6}))));
}

// What a series of this size looks like over 30 s, an envelope an axis.
Value Envelopes(double size, double frequency, Rng* rng) {
  Value axes = Value::Array();
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> time;
    std::vector<double> low;
    std::vector<double> high;
    for (int k = 0; k < 300; ++k) {
      time.push_back(0.1 * k);
      const double middle = size * std::sin(frequency * 0.1 * k + axis);
      low.push_back(Rounded(middle - 0.2 * size * rng->Uniform()));
      high.push_back(Rounded(middle + 0.2 * size * rng->Uniform()));
    }
    axes.Append(Value::Object()
                    .Set("time_s", Value::Numbers(time))
                    .Set("low", Value::Numbers(low))
                    .Set("high", Value::Numbers(high)));
  }
  return axes;
}

Value SensorPlot(double size, double stddev, Rng* rng) {
  const Value intervals = Envelopes(0.01, 3.0, rng);
  return std::move(Value::Object()
                       .Set("measured", Envelopes(size, 2.0, rng))
                       .Set("predicted", Envelopes(size, 2.0, rng))
                       .Set("residual", Envelopes(2.0 * stddev, 40.0, rng))
                       .Set("stddev", stddev)
                       .Set("outliers", Value::Array().Append(Numbers({12.0, 3 * size, 0.0, 0.0})))
                       .Set("interval_ms", intervals.elements()[0])
                       .Set("median_interval_ms", 5.0));
}

Value CameraImuPlots() {
  Rng rng(4);
  Value path = Value::Array();
  Value axes = Value::Array();
  for (int k = 0; k < 400; ++k) {
    const double t = 0.05 * k;
    path.Append(Numbers({Rounded(0.15 + 0.1 * std::sin(t)), Rounded(0.18 + 0.1 * std::cos(1.7 * t)),
                         Rounded(0.7 + 0.05 * std::sin(2.3 * t))}));
    if (k % 20 == 0) {
      axes.Append(Numbers({Rounded(0.15 + 0.1 * std::sin(t)),
                           Rounded(0.18 + 0.1 * std::cos(1.7 * t)), 0.7, 0.0, 0.0, -1.0}));
    }
  }
  Value corners = Value::Array();
  for (int k = 0; k < 800; ++k) {
    corners.Append(Numbers({0.03 * k, Rounded(rng.Normal(0, 0.1)), Rounded(rng.Normal(0, 0.1))}));
  }
  Value bias = Value::Array();
  std::vector<double> bias_time;
  for (int k = 0; k < 60; ++k) {
    bias_time.push_back(0.5 * k);
    bias.Append(Numbers({0.01, -0.02 + 1e-5 * k, 0.005}));
  }
  Value imu = Value::Object();
  imu.Set("gyro", SensorPlot(0.8, 2e-3, &rng))
      .Set("accel", SensorPlot(4.0, 3e-2, &rng))
      .Set("bias_time_s", Value::Numbers(bias_time))
      .Set("gyro_bias", bias)
      .Set("accel_bias", bias)
      .Set("gyro_walk", 2e-5)
      .Set("accel_walk", 3e-3);
  Value camera = Value::Object();
  camera.Set("rms", Envelopes(0.14, 1.0, &rng).elements()[0])
      .Set("corner_residuals", corners)
      .Set("interval_ms", Envelopes(0.5, 1.0, &rng).elements()[0])
      .Set("median_interval_ms", 50.0);
  Value outline = Value::Array();
  for (const auto& [x, y] : {std::pair{0.0, 0.0}, {0.3, 0.0}, {0.3, 0.36}, {0.0, 0.36}}) {
    outline.Append(Numbers({x, y, 0.0}));
  }
  Value knowledge = Value::Object();
  knowledge.Set("time_s", Numbers({5, 10, 20, 30}))
      .Set("rotation_sigma_rad", Numbers({4e-3, 2e-3, 1e-3, 8e-4}))
      .Set("translation_sigma_m", Numbers({9e-3, 4e-3, 2e-3, 1.4e-3}))
      .Set("time_offset_sigma_s", Numbers({2e-4, 1e-4, 6e-5, 5e-5}));
  return std::move(Value::Object()
                       .Set("duration_s", 30.0)
                       .Set("imus", Value::Array().Append(imu))
                       .Set("cameras", Value::Array().Append(camera))
                       .Set("corner_noise_px", 0.1)
                       .Set("trajectory_g", path)
                       .Set("axis_g", axes)
                       .Set("board_outline_g", outline)
                       .Set("knowledge", knowledge));
}

Value CameraImuCovariance() {
  const std::vector<std::string> names = {"rot_x", "rot_y", "rot_z",      "pos_x",
                                          "pos_y", "pos_z", "time_offset"};
  Value labels = Value::Array();
  Value matrix = Value::Array();
  for (size_t i = 0; i < names.size(); ++i) {
    labels.Append("cam0." + names[i]);
    std::vector<double> row;
    for (size_t j = 0; j < names.size(); ++j) row.push_back(i == j ? 1e-6 : 2e-7);
    matrix.Append(Value::Numbers(row));
  }
  return std::move(Value::Object().Set("names", labels).Set("matrix", matrix));
}

Value Words(const std::vector<std::string>& words) {
  Value value = Value::Array();
  for (const std::string& word : words) value.Append(word);
  return value;
}

Value Row(const std::string& policy, double mean, double ratio, double path_length_m) {
  return std::move(Value::Object()
                       .Set("task", "intrinsic")
                       .Set("policy", policy)
                       .Set("carrier", "free")
                       .Set("fidelity", "fast")
                       .Set("n", 40)
                       .Set("mean_error_percent", mean)
                       .Set("ci95", Numbers({0.88 * mean, 1.13 * mean}))
                       .Set("median_error_percent", 0.92 * mean)
                       .Set("ratio_to_handcrafted", ratio)
                       .Set("ratio_ci95", Numbers({0.9 * ratio, 1.1 * ratio}))
                       .Set("ratio_to_random", ratio / 2.1)
                       .Set("ratio_to_random_ci95", Numbers({0.4 * ratio, 0.55 * ratio}))
                       .Set("path_length_m", path_length_m)
                       .Set("path_length_original_m", 0.978 * path_length_m)
                       .Set("motion_s", 20.0)
                       .Set("a_optimality", 2.1 * ratio)
                       .Set("failures", policy == "random" ? 2 : 0));
}

}  // namespace

Value CameraDocumentForTest() {
  Rng rng(1);
  Value views = Value::Array();
  for (int i = 0; i < 25; ++i) views.Append(View(i, &rng));
  Value points = Value::Array();
  for (const Point& point : BoardPoints()) points.Append(Value::Numbers(point));

  Value camera = Value::Object();
  camera.Set("model", "pinhole-radtan")
      .Set("resolution", Numbers({640, 480}))
      .Set("intrinsics", Numbers({585.7561, 585.4312, 320.5213, 240.4876}))
      .Set("distortion", Numbers({-0.2812, 0.0713, 1.2e-4, 0.0}))
      .Set("intrinsics_sigma", Numbers({0.62, 0.61, 0.48, 0.44}))
      .Set("distortion_sigma", Numbers({1.1e-3, 4e-3, 2.1e-4, 0.0}))
      .Set("reprojection_rms_px", 0.1413)
      .Set("reprojection_rms_all_px", 0.1502)
      .Set("num_views", 25)
      .Set("num_corners", 25 * 42)
      .Set("rejected", Rejected())
      .Set("checks", Checks(&rng))
      .Set("projection_uncertainty", Value::Object()
                                         .Set("distance_m", 1.2)
                                         .Set("at_distance", UncertaintyMap(0.3))
                                         .Set("at_infinity", UncertaintyMap(0.5)));
  // A second camera, 83 mm to the right of the first.
  Value second = camera;
  Value T_cn_cnm1 = Value::Array();
  T_cn_cnm1.Append(Numbers({1, 0, 0, -0.083}))
      .Append(Numbers({0, 1, 0, 0.001}))
      .Append(Numbers({0, 0, 1, 0.002}))
      .Append(Numbers({0, 0, 0, 1}));
  second.Set("T_cn_cnm1", T_cn_cnm1).Set("num_shared_frames", 24);
  Value finding = Value::Object();
  finding.Set("severity", "warn")
      .Set("what", "the board's size varies little: 0.31 of the wanted range of 0.4")
      .Set("remedy", "add a few views with the board filling the image, at half the distance");
  Value plots = Value::Object();
  plots.Set("resolution", Numbers({640, 480}))
      .Set("noise_stddev_px", 0.1)
      .Set("views", views)
      .Set("board_points_g", points)
      .Set("images_without_board", Words({"left97.jpg", "left98.jpg"}))
      .Set("rejected_corners", Value::Array().Append(Value::Object()
                                                         .Set("view", "left3.jpg")
                                                         .Set("pixel", Numbers({400, 300}))
                                                         .Set("residual", Numbers({2.1, -3.4}))))
      .Set("straightened_view", Straightened())
      .Set("lens_curve", Value::Object()
                             .Set("angle_rad", Numbers({0.0, 0.2, 0.4, 0.6}))
                             .Set("radius_px", Numbers({0.0, 118.0, 245.0, 390.0})))
      .Set("distortion_curve", Distortion());
  // The second camera is a fisheye, drawn by angles.
  Value second_plots = plots;
  second_plots.Set("lens_curve", Value::Object()
                                     .Set("angle_rad", Numbers({0.0, 0.5, 1.0, 1.5}))
                                     .Set("radius_px", Numbers({0.0, 130.0, 255.0, 370.0})));
  Value coverage = Value::Object();
  coverage.Set("x", 1.0).Set("y", 0.93).Set("size", 0.775).Set("skew", 1.0);
  Value information = Value::Object();
  information.Set("a_optimality", 1.18)
      .Set("d_optimality", 6.3e-3)
      .Set("e_optimality", 0.51)
      .Set("eigenvalues", Numbers({0.11, 0.21, 0.35, 0.51}));
  return std::move(Value::Object()
                       .Set("kind", "camera")
                       .Set("termination", "converged")
                       .Set("verdict", "warn")
                       .Set("findings", Value::Array().Append(finding))
                       .Set("cameras", Value::Array().Append(camera).Append(second))
                       .Set("covariance", CameraCovariance())
                       .Set("coverage", coverage)
                       .Set("information", information)
                       .Set("plots", plots)
                       .Set("plots_cam1", second_plots));
}

Value CameraImuDocumentForTest() {
  Value T_cam_imu = Value::Array();
  T_cam_imu.Append(Numbers({0, -1, 0, 0.052}))
      .Append(Numbers({1, 0, 0, -0.031}))
      .Append(Numbers({0, 0, 1, 0.024}))
      .Append(Numbers({0, 0, 0, 1}));
  Value camera = Value::Object();
  camera.Set("T_cam_imu", T_cam_imu)
      .Set("time_offset_s", 0.0073)
      .Set("rotation_sigma_rad", Numbers({2e-4, 3e-4, 2e-4}))
      .Set("translation_sigma_m", Value::Array().Append(8e-4).Append(Value()).Append(7e-3))
      .Set("time_offset_sigma_s", 3e-5)
      .Set("verdicts", Value::Object()
                           .Set("rotation", Words({"pass", "pass", "pass"}))
                           .Set("translation", Words({"pass", "inconclusive", "warn"}))
                           .Set("time_offset", "pass"))
      .Set("split",
           Value::Object()
               .Set("difference_rad_m_s", Numbers({1e-4, -2e-4, 1e-4, 5e-4, -1e-3, 4e-3, 2e-5}))
               .Set("sigma_rad_m_s", Numbers({4e-4, 6e-4, 4e-4, 1.6e-3, 0.05, 0.014, 6e-5}))
               .Set("probability", 0.7))
      .Set("rejected_views", Words({"1403709383937837056"}))
      .Set("rejected_view_times_s", Numbers({7.3}))
      .Set("prediction_error_px", 0.71)
      .Set("num_outliers", 3);
  Value imu = Value::Object();
  imu.Set("model", "calibrated")
      .Set("gyro_bias", Numbers({0.01, -0.02, 0.005}))
      .Set("accel_bias", Numbers({0.05, 0.1, -0.08}))
      .Set("gyro_bias_sigma", Numbers({1e-5, 2e-5, 1e-5}))
      .Set("accel_bias_sigma", Numbers({1e-3, 2e-3, 1e-3}))
      .Set("gyro", Value::Object()
                       .Set("rms", 2e-3)
                       .Set("normalised", 1.1)
                       .Set("num_outliers", 1)
                       .Set("outlier_times_s", Numbers({12.0})))
      .Set("accel", Value::Object().Set("rms", 0.03).Set("normalised", 0.9));
  Value finding = Value::Object();
  finding.Set("severity", "inconclusive")
      .Set("what", "cam0: translation along y is not observable in this motion")
      .Set("remedy", "turn the camera to and fro about its x (look up and down) faster");
  return std::move(
      Value::Object()
          .Set("kind", "camera-imu")
          .Set("termination", "converged")
          .Set("verdict", "inconclusive")
          .Set("findings", Value::Array().Append(finding))
          .Set("cameras", Value::Array().Append(camera))
          .Set("imus", Value::Array().Append(imu))
          .Set("gravity_g", Numbers({-9.7, 0.9, 1.1}))
          .Set("knot_spacing_s", 0.1)
          .Set("num_iterations", 9)
          .Set("imu_models", Value::Object()
                                 .Set("simple", "calibrated")
                                 .Set("richer", "scale-misalignment")
                                 .Set("used", "calibrated")
                                 .Set("squared_residuals_fall", 65.5)
                                 .Set("degrees", 24)
                                 .Set("probability", 1e-5)
                                 .Set("qaic_change", -17.5)
                                 .Set("change_rad_m", Value::Array().Append(Numbers(
                                                          {2e-3, 1e-3, 0, 1e-3, 2e-3, -6.3e-3}))))
          .Set("covariance", CameraImuCovariance())
          .Set("information", Value::Object()
                                  .Set("a_optimality", 3.2)
                                  .Set("d_optimality", 1e-3)
                                  .Set("e_optimality", 2.1)
                                  .Set("eigenvalues", Numbers({0.01, 0.02, 0.04, 0.3, 0.7, 2.1})))
          .Set("residuals", Value::Object()
                                .Set("reprojection_rms_px", 0.143)
                                .Set("gyro_normalised", 1.1)
                                .Set("accel_normalised", 0.9))
          .Set("plots", CameraImuPlots()));
}

Value LearnDocumentForTest() {
  Rng rng(2);
  Value training = Value::Array();
  for (int episode = 0; episode < 300; ++episode) {
    const double progress = episode < 30 ? 0.0 : 1 - std::exp(-(episode - 30) / 90.0);
    training.Append(TrainingLine(episode, episode < 30 ? "random" : "training", progress, &rng));
    if (episode % 20 == 19) training.Append(TrainingLine(episode, "test", progress, &rng));
    if (episode != 150) continue;
    training.Append(Value::Object()
                        .Set("episode", 150)
                        .Set("kind", "rollback")
                        .Set("diverged_at_episode", 153)
                        .Set("why", "reward loss not finite")
                        .Set("learning_rate", 5e-5));
  }
  Value motion = Motion("learned", 0.08, 5.6);
  motion.Set("board_outline_b", BoardOutline());
  return std::move(Value::Object()
                       .Set("kind", "learn")
                       .Set("task", "intrinsic")
                       .Set("preset", "best")
                       .Set("episodes", 300)
                       .Set("calibrations", 1260)
                       .Set("information_evaluations", 48000)
                       .Set("best_return", 2.3184)
                       .Set("training", training)
                       .Set("motion", motion));
}

Value Table1DocumentForTest() {
  Rng rng(3);
  Value rows = Value::Array();
  Value errors = Value::Array();
  Value motions = Value::Array();
  Value coverage = Value::Array();
  const auto add = [&](const std::string& policy, double mean, double ratio, double size,
                       double path_length_m) {
    rows.Append(Row(policy, mean, ratio, path_length_m));
    motions.Append(Motion(policy, size, path_length_m));
    std::vector<double> each;
    for (int i = 0; i < 40; ++i) each.push_back(0.01 * mean * std::exp(rng.Normal(0, 0.4)));
    errors.Append(
        Value::Object().Set("policy", policy).Set("relative_error", Value::Numbers(each)));
    Value pixels = Value::Array();
    for (int i = 0; i < 1500; ++i) {
      pixels.Append(Numbers({Rounded(320 + 1500 * size * rng.Uniform(-1, 1)),
                             Rounded(240 + 1100 * size * rng.Uniform(-1, 1))}));
    }
    coverage.Append(Value::Object().Set("policy", policy).Set("pixels", pixels));
  };
  add("random", 0.46, 2.1, 0.06, 8.4);
  add("handcrafted", 0.22, 1.0, 0.12, 11.364);
  add("learned", 0.12, 0.55, 0.16, 9.8);
  add("learned at random's path", 0.14, 0.65, 0.14, 8.4);
  Value plots = Value::Object();
  plots.Set("errors", errors)
      .Set("motions", motions)
      .Set("coverage", coverage)
      .Set("resolution", Numbers({640, 480}))
      .Set("board_outline_b", BoardOutline());
  return std::move(Value::Object().Set("kind", "table1").Set("rows", rows).Set("plots", plots));
}

}  // namespace calibrato
