// Budgets: 0.1 s for a camera solve of 200 views x 42 corners with covariance; 1 s for 2000 views:
// linear in views.

#include <benchmark/benchmark.h>

#include "calibrato/calibration/camera_calibration.h"
#include "calibrato/calibration/start_values.h"
#include "calibrato/calibration/synthetic_views_for_test.h"

namespace calibrato {
namespace {

constexpr Resolution kImage{640, 480};

CameraProblem MakeProblem(int num_views) {
  Eigen::VectorXd parameters(9);
  parameters << 585.0, 585.0, 320.5, 240.5, -0.1, 0.05, 0.001, -0.001, 0.05;
  Rng rng(1);
  CameraProblem problem;
  problem.model = "pinhole-radtan5";
  problem.resolution = kImage;
  problem.views = SyntheticViews(CameraModel("pinhole-radtan5", parameters), kImage,
                                 Checkerboard{6, 7, 0.03, 0.03}, num_views, 0.1, rng);
  return problem;
}

void BM_CalibrateCamera(benchmark::State& state) {
  const CameraProblem problem = MakeProblem(static_cast<int>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(CalibrateCamera(problem));
  state.counters["views/s"] = benchmark::Counter(
      static_cast<double>(state.range(0) * state.iterations()), benchmark::Counter::kIsRate);
}
BENCHMARK(BM_CalibrateCamera)
    ->Arg(20)
    ->Arg(200)
    ->Arg(2000)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

void BM_StartValues(benchmark::State& state) {
  const CameraProblem problem = MakeProblem(static_cast<int>(state.range(0)));
  for (auto _ : state) {
    benchmark::DoNotOptimize(FindStartValues(problem.model, kImage, problem.views));
  }
}
BENCHMARK(BM_StartValues)->Arg(20)->Arg(200)->Arg(2000)->Unit(benchmark::kMillisecond);

void BM_CameraInformation(benchmark::State& state) {
  const CameraProblem problem = MakeProblem(static_cast<int>(state.range(0)));
  const auto start = FindStartValues(problem.model, kImage, problem.views);
  for (auto _ : state) {
    benchmark::DoNotOptimize(CameraInformation(start->state, problem.views, {}));
  }
}
BENCHMARK(BM_CameraInformation)->Arg(200)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace calibrato

BENCHMARK_MAIN();
