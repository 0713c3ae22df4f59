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
                       .Set("axis_b", axes));
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
  line.Set("episode", episode).Set("kind", kind).Set("return", Rounded(total));
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
  } else {
    line.Set("dynamics_loss", Value()).Set("reward_loss", Value()).Set("predicted_return", Value());
  }
  return line;
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
      .Set("num_corners", 25 * 42);
  Value finding = Value::Object();
  finding.Set("severity", "warn")
      .Set("what", "the board's size varies little: 0.31 of the wanted range of 0.4")
      .Set("remedy", "add a few views with the board filling the image, at half the distance");
  Value plots = Value::Object();
  plots.Set("resolution", Numbers({640, 480}))
      .Set("noise_stddev_px", 0.1)
      .Set("views", views)
      .Set("board_points_g", points)
      .Set("images_without_board", Value::Array().Append("left97.jpg").Append("left98.jpg"))
      .Set("distortion_curve", Distortion());
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
                       .Set("cameras", Value::Array().Append(camera))
                       .Set("covariance", CameraCovariance())
                       .Set("coverage", coverage)
                       .Set("information", information)
                       .Set("plots", plots));
}

Value LearnDocumentForTest() {
  Rng rng(2);
  Value training = Value::Array();
  for (int episode = 0; episode < 300; ++episode) {
    const double progress = episode < 30 ? 0.0 : 1 - std::exp(-(episode - 30) / 90.0);
    training.Append(TrainingLine(episode, episode < 30 ? "random" : "training", progress, &rng));
    if (episode % 20 == 19) training.Append(TrainingLine(episode, "test", progress, &rng));
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
  Value plots = Value::Object();
  plots.Set("errors", errors)
      .Set("motions", motions)
      .Set("coverage", coverage)
      .Set("resolution", Numbers({640, 480}))
      .Set("board_outline_b", BoardOutline());
  return std::move(Value::Object().Set("kind", "table1").Set("rows", rows).Set("plots", plots));
}

}  // namespace calibrato
