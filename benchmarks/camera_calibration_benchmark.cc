// Budgets: 0.1 s for a camera solve of 200 views x 42 corners with covariance; 1 s for 2000 views:
// linear in views. Beside it cv::calibrateCamera from the same corners, with as many parameters
// (its time grows with the cube of the views).

#include <benchmark/benchmark.h>

#include <opencv2/calib3d.hpp>

#include "calibrato/calibration/bundle_adjustment.h"
#include "calibrato/calibration/camera_calibration.h"
#include "calibrato/calibration/start_values.h"
#include "calibrato/calibration/synthetic_rig_for_test.h"
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

void BM_OpenCvCalibrateCamera(benchmark::State& state) {
  const CameraProblem problem = MakeProblem(static_cast<int>(state.range(0)));
  std::vector<std::vector<cv::Point3f>> points;
  std::vector<std::vector<cv::Point2f>> pixels;
  for (const BoardView& view : problem.views) {
    points.emplace_back();
    pixels.emplace_back();
    for (Eigen::Index k = 0; k < view.num_corners(); ++k) {
      points.back().emplace_back(view.points_g(0, k), view.points_g(1, k), 0.0F);
      pixels.back().emplace_back(view.pixels(0, k), view.pixels(1, k));
    }
  }
  for (auto _ : state) {
    cv::Mat K, distortion;
    std::vector<cv::Mat> rotations, translations;
    benchmark::DoNotOptimize(cv::calibrateCamera(points, pixels, {kImage.width, kImage.height}, K,
                                                 distortion, rotations, translations));
  }
}
BENCHMARK(BM_OpenCvCalibrateCamera)
    ->Arg(20)
    ->Arg(50)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->Iterations(1);

void BM_CalibrateStereoFisheye(benchmark::State& state) {
  Eigen::VectorXd parameters(8);
  parameters << 300.0, 301.0, 318.0, 241.0, 0.01, -0.005, 0.002, 0.001;
  const CameraModel lens("pinhole-equi", parameters);
  Rng rng(2);
  const CameraRigProblem problem =
      MakeRigProblem({{lens, lens}, {{Eigen::Matrix3d::Identity(), {-0.1, 0.0, 0.0}}}},
                     Checkerboard{6, 7, 0.03, 0.03}, static_cast<int>(state.range(0)), 0.1, rng);
  for (auto _ : state) benchmark::DoNotOptimize(CalibrateCameraRig(problem));
}
BENCHMARK(BM_CalibrateStereoFisheye)->Arg(200)->Unit(benchmark::kMillisecond)->UseRealTime();

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
  std::vector<Rigid3> T_c_g;
  for (const ViewInliers& view : start->views) T_c_g.push_back(view.T_c_g);
  for (auto _ : state) {
    benchmark::DoNotOptimize(CameraInformation(start->model, T_c_g, problem.views, {}));
  }
}
BENCHMARK(BM_CameraInformation)->Arg(200)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace calibrato

BENCHMARK_MAIN();
