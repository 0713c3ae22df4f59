// How far detected corners of rendered images lie from the truth, by motion blur, distance and
// tilt, and the corner noise of fidelity `fast` that fits it best.
//
//   corner_noise_of_images NUM_IMAGES SEED > corner_noise.csv
//
// One image a row; the fit on stderr.

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <numbers>
#include <optional>
#include <vector>

#include "calibrato/detection/detect.h"
#include "calibrato/geometry/so3.h"
#include "calibrato/motion/paper_scene.h"
#include "calibrato/simulation/fast_simulation.h"
#include "calibrato/simulation/rendered_camera.h"

namespace calibrato {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

struct Measurement {
  double distance_m = 0.0;
  double tilt = 0.0;        ///< [rad]
  double blur_px = 0.0;     ///< Mean way of the corners during the exposure.
  double spacing_px = 0.0;  ///< Mean distance of neighbouring corners.
  bool is_found = false;
  double squares = 0.0;  ///< Of errors of both coordinates [px^2].
  int num_coordinates = 0;
};

constexpr double kExposure = 0.005;  // [s]

Rig MakeRig() {
  Rig rig = PaperRig();
  rig.exposure_s = kExposure;
  rig.image_disturbances.read_noise = 1.5;
  rig.image_disturbances.shot_noise = 0.02;
  rig.image_disturbances.defocus_px = 0.5;
  return rig;
}

// The room of models/panda.xml, above its table.
bool IsInTheRoom(const Vector3d& p_w) {
  return p_w.x() < 1.4 && std::abs(p_w.y()) < 2.3 && p_w.z() > 0.2 && p_w.z() < 2.1;
}

// Where the board is seen, and how it moves.
struct Scenario {
  Rigid3 T_c_g;
  Vector3d velocity_c;          // of the board in the camera [m/s]
  Vector3d angular_velocity_c;  // [rad/s]
};

Scenario Draw(const Rig& rig, double blur_px, Measurement* measurement, Rng& rng) {
  const Vector3d centre_g = BoardCentre(rig.board);
  const double f = rig.cameras[0].model.focal_and_centre()[0];
  for (;;) {
    Scenario scenario;
    measurement->distance_m = rng.Uniform(0.7, 2.2);
    measurement->tilt = rng.Uniform(0.0, std::numbers::pi / 3.0);
    const double axis = rng.Uniform(0.0, 2.0 * std::numbers::pi);
    const double roll = rng.Uniform(-0.5, 0.5);
    Eigen::Matrix3d facing;  // x of the board down, y to the right, z towards the camera
    facing << 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0;
    const Vector3d tilt_axis(std::cos(axis), std::sin(axis), 0.0);
    scenario.T_c_g.R =
        ExpSo3(Vector3d(0.0, 0.0, roll)) * ExpSo3(Vector3d(measurement->tilt * tilt_axis)) * facing;
    const Vector2d pixel(rng.Uniform(200.0, 440.0), rng.Uniform(160.0, 320.0));
    scenario.T_c_g.t = measurement->distance_m * *rig.cameras[0].model.Unproject(pixel) -
                       scenario.T_c_g.R * centre_g;
    const double direction = rng.Uniform(0.0, 2.0 * std::numbers::pi);
    const double speed = blur_px / kExposure / f;  // of the line of sight [rad/s]
    // Half by turning, half by shifting, on average.
    const double share = rng.Uniform();
    scenario.velocity_c = (1.0 - share) * speed * measurement->distance_m *
                          Vector3d(std::cos(direction), std::sin(direction), 0.0);
    scenario.angular_velocity_c =
        share * speed * Vector3d(-std::sin(direction), std::cos(direction), 0.0);
    const Rigid3 T_w_c = rig.T_w_g * scenario.T_c_g.Inverse();
    const Eigen::Matrix3Xd points_g = BoardPoints(rig.board);
    const bool is_whole = [&] {
      for (Eigen::Index k = 0; k < points_g.cols(); ++k) {
        const auto p = rig.cameras[0].model.Project(scenario.T_c_g * points_g.col(k));
        if (!p || p->x() < 25.0 || p->y() < 25.0 || p->x() > 614.0 || p->y() > 454.0) return false;
      }
      return true;
    }();
    if (IsInTheRoom(T_w_c.t) && is_whole) return scenario;
  }
}

Measurement Measure(const Rig& rig, const RenderedCamera& camera, double blur_px, Rng& rng) {
  Measurement measurement;
  const Scenario scenario = Draw(rig, blur_px, &measurement, rng);
  CarrierPath path;
  path.duration_s = 1.0;
  path.at = [&](double t_s) {
    Eigen::Matrix<double, 6, 1> way;
    way << t_s * scenario.angular_velocity_c, t_s * scenario.velocity_c;
    const Rigid3 turned{ExpSo3(Vector3d(way.head<3>())), way.tail<3>()};
    const Rigid3 T_w_c = rig.T_w_g * (turned * scenario.T_c_g).Inverse();
    CarrierState state;
    state.T_b_e = ArmBaseInWorld().Inverse() * T_w_c * rig.T_e_c0.Inverse();
    return state;
  };
  const std::optional<BoardView> view = DetectBoard(camera.Take(path, 0.0, rng), rig.board);
  const Eigen::Matrix3Xd points_g = BoardPoints(rig.board);
  const CameraModel& lens = rig.cameras[0].model;
  const Rigid3 first = BoardInCamera(rig, path.at(-0.5 * kExposure).T_b_e);
  const Rigid3 last = BoardInCamera(rig, path.at(0.5 * kExposure).T_b_e);
  for (Eigen::Index k = 0; k < points_g.cols(); ++k) {
    measurement.blur_px +=
        (*lens.Project(last * points_g.col(k)) - *lens.Project(first * points_g.col(k))).norm() /
        static_cast<double>(points_g.cols());
  }
  const auto neighbours = NeighbouringPoints(rig.board);
  for (const auto& [a, b] : neighbours) {
    measurement.spacing_px += (*lens.Project(scenario.T_c_g * points_g.col(a)) -
                               *lens.Project(scenario.T_c_g * points_g.col(b)))
                                  .norm() /
                              static_cast<double>(neighbours.size());
  }
  measurement.is_found = view.has_value();
  if (!view) return measurement;
  for (Eigen::Index k = 0; k < view->pixels.cols(); ++k) {
    const Vector2d truth = *lens.Project(scenario.T_c_g * points_g.col(view->corner_ids[k]));
    measurement.squares += (view->pixels.col(k) - truth).squaredNorm();
    measurement.num_coordinates += 2;
  }
  return measurement;
}

// Maximum likelihood of CornerNoise::Stddev, over a grid that is refined.
CornerNoise Fitted(const std::vector<Measurement>& measurements) {
  const auto cost = [&](const CornerNoise& noise) {
    double sum = 0.0;
    for (const Measurement& m : measurements) {
      if (!m.is_found) continue;
      const double variance = std::pow(noise.Stddev(m.blur_px), 2);
      sum += m.num_coordinates * std::log(variance) + m.squares / variance;
    }
    return sum;
  };
  CornerNoise best{.stddev_px = 0.01, .blur_factor = 0.003, .blur_knee_px = 6.0};
  double least = cost(best);
  double step = 1.0;  // of the logarithms
  constexpr int kNumRounds = 60;
  for (int round = 0; round < kNumRounds; ++round, step *= 0.85) {
    const CornerNoise centre = best;
    for (int i = 0; i < 27; ++i) {
      CornerNoise tried = centre;
      tried.stddev_px *= std::exp(step * (i % 3 - 1));
      tried.blur_factor *= std::exp(step * (i / 3 % 3 - 1));
      tried.blur_knee_px *= std::exp(step * (i / 9 - 1));
      const double c = cost(tried);
      if (c < least) {
        least = c;
        best = tried;
      }
    }
  }
  return best;
}

// A logistic regression of which boards were found.
struct LossFit {
  Eigen::VectorXd weights;  // the first is of the constant
  double log_likelihood = 0.0;
};

// Newton's method on the likelihood, which is concave.
LossFit FittedLoss(const std::vector<Measurement>& measurements,
                   const std::function<Eigen::VectorXd(const Measurement&)>& features) {
  const Eigen::Index n = features(measurements.front()).size();
  LossFit fit{Eigen::VectorXd::Zero(n), 0.0};
  constexpr int kNumSteps = 50;
  for (int step = 0; step < kNumSteps; ++step) {
    Eigen::MatrixXd hessian = 1e-9 * Eigen::MatrixXd::Identity(n, n);
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(n);
    fit.log_likelihood = 0.0;
    for (const Measurement& m : measurements) {
      const Eigen::VectorXd x = features(m);
      const double p = 1.0 / (1.0 + std::exp(-fit.weights.dot(x)));
      gradient += ((m.is_found ? 1.0 : 0.0) - p) * x;
      hessian += p * (1.0 - p) * x * x.transpose();
      fit.log_likelihood += std::log(std::max(m.is_found ? p : 1.0 - p, 1e-300));
    }
    fit.weights += hessian.ldlt().solve(gradient);
  }
  return fit;
}

void PrintLossFits(std::vector<Measurement> measurements) {
  // Sharper boards are all found, and say nothing.
  std::erase_if(measurements, [](const Measurement& m) { return m.blur_px < 5.0; });
  const auto print = [&](const char* name, auto features) {
    const LossFit fit = FittedLoss(measurements, features);
    std::fprintf(stderr, "loss by %s: log-likelihood %.2f, half at %.3f, slope %.3f\n", name,
                 fit.log_likelihood, -fit.weights[0] / fit.weights[1], -1.0 / fit.weights[1]);
  };
  print("blur [px]", [](const Measurement& m) { return Vector2d(1.0, m.blur_px); });
  print("smear", [](const Measurement& m) { return Vector2d(1.0, m.blur_px / m.spacing_px); });
  print("blur and squares [px], at squares of 0 px",
        [](const Measurement& m) { return Vector3d(1.0, m.blur_px, m.spacing_px); });
}

// Measured over predicted standard deviation in classes of one of the measurements.
template <typename Key>
void PrintClasses(const char* name, const std::vector<double>& edges, const CornerNoise& noise,
                  const std::vector<Measurement>& measurements, const Key& key) {
  for (size_t i = 0; i + 1 < edges.size(); ++i) {
    double measured = 0.0;
    double predicted = 0.0;
    double n = 0.0;
    int num_images = 0;
    int num_found = 0;
    for (const Measurement& m : measurements) {
      if (!(key(m) >= edges[i] && key(m) < edges[i + 1])) continue;
      ++num_images;
      if (!m.is_found) continue;
      ++num_found;
      measured += m.squares;
      n += m.num_coordinates;
      predicted += m.num_coordinates * std::pow(noise.Stddev(m.blur_px), 2);
    }
    std::fprintf(stderr,
                 "%s %.2f to %.2f: found %d of %d, measured %.4f px, predicted %.4f, ratio %.3f\n",
                 name, edges[i], edges[i + 1], num_found, num_images, std::sqrt(measured / n),
                 std::sqrt(predicted / n), std::sqrt(measured / predicted));
  }
}

int Run(int num_images, uint64_t seed) {
  const Rig rig = MakeRig();
  const RenderedCamera camera(rig);
  std::vector<Measurement> measurements;
  std::printf("distance_m,tilt_rad,blur_px,spacing_px,found,rms_px\n");
  for (int i = 0; i < num_images; ++i) {
    Rng rng = Rng(seed).Stream("image", static_cast<uint64_t>(i));
    const double blur_px = i % 4 == 0 ? 0.0 : rng.Uniform(0.0, 14.0);
    const Measurement m = Measure(rig, camera, blur_px, rng);
    measurements.push_back(m);
    std::printf("%.4f,%.4f,%.4f,%.3f,%d,%.5f\n", m.distance_m, m.tilt, m.blur_px, m.spacing_px,
                m.is_found ? 1 : 0, m.is_found ? std::sqrt(m.squares / m.num_coordinates) : 0.0);
  }
  const CornerNoise noise = Fitted(measurements);
  std::fprintf(stderr, "stddev_px %.5f, blur_factor %.5f, blur_knee_px %.3f\n", noise.stddev_px,
               noise.blur_factor, noise.blur_knee_px);
  PrintClasses("blur [px]", {0.0, 0.01, 2.0, 4.0, 6.0, 8.0, 10.0, 12.0, 16.0, 30.0}, noise,
               measurements, [](const Measurement& m) { return m.blur_px; });
  PrintClasses("smear", {0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1.5}, noise, measurements,
               [](const Measurement& m) { return m.blur_px / m.spacing_px; });
  PrintLossFits(measurements);
  std::erase_if(measurements, [](const Measurement& m) { return m.blur_px > 6.0; });
  std::fprintf(stderr, "of images with a blur of up to 6 px:\n");
  PrintClasses("tilt [rad]", {0.0, 0.25, 0.5, 0.75, 1.05}, noise, measurements,
               [](const Measurement& m) { return m.tilt; });
  PrintClasses("distance [m]", {0.7, 1.0, 1.3, 1.6, 1.9, 2.2}, noise, measurements,
               [](const Measurement& m) { return m.distance_m; });
  return 0;
}

}  // namespace
}  // namespace calibrato

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: corner_noise_of_images NUM_IMAGES SEED\n");
    return 2;
  }
  return calibrato::Run(std::atoi(argv[1]), std::strtoull(argv[2], nullptr, 10));
}
