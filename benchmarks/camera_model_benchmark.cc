// Nanoseconds a projection with both Jacobians, a projection alone and an unprojection, by model:
// the first is the inner loop of every calibration.

#include <benchmark/benchmark.h>

#include <map>
#include <vector>

#include "calibrato/base/rng.h"
#include "calibrato/sensors/camera_model.h"

namespace calibrato {
namespace {

constexpr size_t kNumPoints = 1024;

// A lens of each model with a horizontal field of view near 90 degrees.
CameraModel Lens(std::string_view name) {
  const std::map<std::string_view, std::vector<double>> parameters = {
      {"pinhole-none", {320.0, 320.0, 319.5, 239.5}},
      {"pinhole-radtan", {320.0, 320.0, 319.5, 239.5, -0.1, 0.05, 0.001, -0.001}},
      {"pinhole-radtan5", {320.0, 320.0, 319.5, 239.5, -0.1, 0.05, 0.001, -0.001, 0.02}},
      {"pinhole-equi", {400.0, 400.0, 319.5, 239.5, 0.01, -0.01, 0.005, -0.001}},
      {"pinhole-fov", {400.0, 400.0, 319.5, 239.5, 0.9}},
      {"omni-none", {0.9, 700.0, 700.0, 319.5, 239.5}},
      {"omni-radtan", {0.9, 700.0, 700.0, 319.5, 239.5, -0.1, 0.05, 0.001, -0.001}},
      {"ds-none", {-0.2, 0.6, 320.0, 320.0, 319.5, 239.5}},
      {"eucm-none", {0.6, 1.1, 400.0, 400.0, 319.5, 239.5}}};
  const std::vector<double>& values = parameters.at(name);
  return {name, Eigen::Map<const Eigen::VectorXd>(values.data(),
                                                  static_cast<Eigen::Index>(values.size()))};
}

std::vector<Eigen::Vector2d> Pixels() {
  Rng rng(1);
  std::vector<Eigen::Vector2d> pixels(kNumPoints);
  for (Eigen::Vector2d& pixel : pixels) {
    pixel << rng.Uniform(0.0, 639.0), rng.Uniform(0.0, 479.0);
  }
  return pixels;
}

std::vector<Eigen::Vector3d> PointsInView(const CameraModel& model) {
  std::vector<Eigen::Vector3d> points;
  for (const Eigen::Vector2d& pixel : Pixels()) points.push_back(1.4 * *model.Unproject(pixel));
  return points;
}

void PerItem(benchmark::State& state) {
  state.SetItemsProcessed(state.iterations() * static_cast<int64_t>(kNumPoints));
}

void ProjectWithJacobians(benchmark::State& state, std::string_view name) {
  const CameraModel model = Lens(name);
  const std::vector<Eigen::Vector3d> points = PointsInView(model);
  std::visit(
      [&](const auto& lens) {
        using Model = std::decay_t<decltype(lens)>;
        Eigen::Vector2d pixel;
        typename Model::JacobianPoint J_point;
        typename Model::JacobianParameters J_parameters;
        for (auto _ : state) {
          for (const Eigen::Vector3d& p_c : points) {
            benchmark::DoNotOptimize(lens.Project(p_c, &pixel, &J_point, &J_parameters));
            benchmark::ClobberMemory();
          }
        }
      },
      model.variant());
  PerItem(state);
}

void Project(benchmark::State& state, std::string_view name) {
  const CameraModel model = Lens(name);
  const std::vector<Eigen::Vector3d> points = PointsInView(model);
  std::visit(
      [&](const auto& lens) {
        Eigen::Vector2d pixel;
        for (auto _ : state) {
          for (const Eigen::Vector3d& p_c : points) {
            benchmark::DoNotOptimize(lens.Project(p_c, &pixel, nullptr, nullptr));
            benchmark::ClobberMemory();
          }
        }
      },
      model.variant());
  PerItem(state);
}

void Unproject(benchmark::State& state, std::string_view name) {
  const CameraModel model = Lens(name);
  const std::vector<Eigen::Vector2d> pixels = Pixels();
  for (auto _ : state) {
    for (const Eigen::Vector2d& pixel : pixels) benchmark::DoNotOptimize(model.Unproject(pixel));
  }
  PerItem(state);
}

// A solver makes a model anew in every iteration.
void Construct(benchmark::State& state, std::string_view name) {
  const CameraModel model = Lens(name);
  const Eigen::VectorXd parameters = model.parameters();
  for (auto _ : state) benchmark::DoNotOptimize(CameraModel(name, parameters));
}

}  // namespace
}  // namespace calibrato

int main(int argc, char** argv) {
  for (const std::string_view name : calibrato::kCameraModelNames) {
    const std::string suffix = "/" + std::string(name);
    benchmark::RegisterBenchmark(("ProjectWithJacobians" + suffix).c_str(),
                                 calibrato::ProjectWithJacobians, name);
    benchmark::RegisterBenchmark(("Project" + suffix).c_str(), calibrato::Project, name);
    benchmark::RegisterBenchmark(("Unproject" + suffix).c_str(), calibrato::Unproject, name);
    benchmark::RegisterBenchmark(("Construct" + suffix).c_str(), calibrato::Construct, name);
  }
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
}
