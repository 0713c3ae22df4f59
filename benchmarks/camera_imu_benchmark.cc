// Budgets: 0.3 s for 40 s of 20 Hz images (42 corners each) with a 200 Hz IMU, from no guess to
// convergence with the covariance, on two cores; linear in the recording's length; 0.05 s for 5 s
// more with the rest as a prior; 10 ms for the information of 15 s at 10 Hz without a solve.

#include <benchmark/benchmark.h>

#include "calibrato/calibration/camera_imu_calibration.h"
#include "calibrato/calibration/synthetic_camera_imu_for_test.h"

namespace calibrato {
namespace {

CameraImuProblem MakeProblem(double duration_s, double camera_rate_hz) {
  SyntheticCameraImu truth;
  truth.duration_s = duration_s;
  truth.camera_rate_hz = camera_rate_hz;
  Rng rng(1);
  return truth.Problem(rng);
}

// @param state.range(0)  Length of the recording [s].
void BM_CalibrateCameraImu(benchmark::State& state) {
  const CameraImuProblem problem = MakeProblem(static_cast<double>(state.range(0)), 20.0);
  double spacing = 0.0;
  int iterations = 0;
  for (auto _ : state) {
    const CameraImuCalibration result = CalibrateCameraImu(problem);
    spacing = result.knot_spacing_s;
    iterations = result.num_iterations;
  }
  state.counters["knot_spacing_ms"] = 1e3 * spacing;
  state.counters["iterations"] = iterations;
}
BENCHMARK(BM_CalibrateCameraImu)
    ->Arg(15)
    ->Arg(40)
    ->Arg(60)
    ->Arg(240)
    ->Arg(600)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

void BM_OneMoreLoop(benchmark::State& state) {
  CameraImuProblem problem = MakeProblem(5.0, 20.0);
  CameraImuOptions options;
  options.knot_spacing_s = 0.07;
  const CameraImuCalibration first = CalibrateCameraImu(problem, options);
  problem.prior = CalibrationPrior{*first.state, first.information.information_matrix};
  for (auto _ : state) benchmark::DoNotOptimize(CalibrateCameraImu(problem, options));
}
BENCHMARK(BM_OneMoreLoop)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();

void BM_InformationAt(benchmark::State& state) {
  CameraImuProblem problem = MakeProblem(15.0, 10.0);
  CameraImuOptions options;
  options.knot_spacing_s = 0.1;
  const CameraImuCalibration solved = CalibrateCameraImu(problem, options);
  problem.corner_noise_px = 0.1;
  for (auto _ : state) benchmark::DoNotOptimize(InformationAt(problem, *solved.state));
}
BENCHMARK(BM_InformationAt)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();

}  // namespace
}  // namespace calibrato

BENCHMARK_MAIN();
