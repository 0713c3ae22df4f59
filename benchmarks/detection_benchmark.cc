// Time to find a board in an image of 640 x 480, by board, on one core; decoding not included. The
// budget is 3.75 ms for a checkerboard: 800 images in 1.5 s on two cores.

#include <benchmark/benchmark.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <vector>

#include "calibrato/detection/detect.h"
#include "calibrato/rendering/render_board.h"

namespace calibrato {
namespace {

std::vector<GreyImage> ImagesOf(const Board& board) {
  constexpr int kNumImages = 16;
  Eigen::VectorXd parameters(8);
  parameters << 500.0, 500.0, 319.5, 239.5, -0.28, 0.08, 0.0005, -0.0003;
  const Camera camera{CameraModel("pinhole-radtan", parameters), {640, 480}, "", std::nullopt};
  const Eigen::Matrix3Xd points_g = BoardPoints(board);
  const double size = (points_g.rowwise().maxCoeff() - points_g.rowwise().minCoeff()).norm();
  const BoardPattern pattern = PatternOf(board);
  Scene scene;
  scene.blur_px = 0.6;
  Rng rng(1);
  std::vector<GreyImage> images;
  for (int k = 0; k < kNumImages; ++k) {
    const Eigen::Matrix3d R_c_g =
        (Eigen::AngleAxisd(rng.Uniform(0.0, 0.7), Eigen::Vector3d(std::cos(k), std::sin(k), 0.0)) *
         Eigen::AngleAxisd(rng.Uniform(-0.5, 0.5), Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()))
            .toRotationMatrix();
    const Eigen::Vector3d centre(0.0, 0.0, size * rng.Uniform(1.2, 2.0));
    const Rigid3 T_c_g(R_c_g, centre - R_c_g * BoardCentre(board));
    images.push_back(Digitised(RenderBoard(pattern, camera, T_c_g, scene), {2.0, 0.0}, rng));
  }
  return images;
}

void BM_Detect(benchmark::State& state, const Board& board) {
  const std::vector<GreyImage> images = ImagesOf(board);
  size_t k = 0;
  int num_found = 0;
  for (auto _ : state) {
    num_found += DetectBoard(images[k++ % images.size()], board).has_value() ? 1 : 0;
  }
  state.counters["found"] =
      static_cast<double>(num_found) / static_cast<double>(state.iterations());
}

// The search that finds nothing tries every reduction.
void BM_DetectNothing(benchmark::State& state) {
  const std::vector<GreyImage> images = ImagesOf(AprilGrid{6, 6, 0.088, 0.3});
  size_t k = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        DetectBoard(images[k++ % images.size()], Checkerboard{6, 7, 0.06, 0.06}));
  }
}

// A wall of so many discs, with no board before it: each of them may be where one begins.
void BM_DetectInAWallOfDiscs(benchmark::State& state) {
  constexpr double kSpacing = 10.0;  // [px]
  const auto side = static_cast<int>(kSpacing * std::sqrt(static_cast<double>(state.range(0))));
  GreyImage image{{side, side}, {}};
  for (int v = 0; v < side; ++v) {
    for (int u = 0; u < side; ++u) {
      const double du = std::remainder(u + 0.02 * v, kSpacing);
      const double dv = std::remainder(v - 0.02 * u, kSpacing);
      image.pixels.push_back(du * du + dv * dv < 9.0 ? 40 : 220);
    }
  }
  for (auto _ : state) {
    benchmark::DoNotOptimize(DetectBoard(image, CircleGrid{7, 4, 0.03, true}));
  }
  state.SetComplexityN(state.range(0));
}

BENCHMARK_CAPTURE(BM_Detect, Checkerboard, Checkerboard{6, 7, 0.06, 0.06})
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(BM_Detect, AprilGrid, AprilGrid{6, 6, 0.088, 0.3})->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(BM_Detect, CircleGrid, CircleGrid{6, 7, 0.06, false})
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(BM_Detect, AsymmetricCircleGrid, CircleGrid{11, 4, 0.03, true})
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(BM_Detect, Charuco, Charuco{6, 8, 0.06, 0.045, "DICT_5X5_100"})
    ->Unit(benchmark::kMillisecond);
BENCHMARK(BM_DetectNothing)->Unit(benchmark::kMillisecond);
BENCHMARK(BM_DetectInAWallOfDiscs)
    ->RangeMultiplier(2)
    ->Range(1 << 10, 1 << 14)
    ->Complexity()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace calibrato

BENCHMARK_MAIN();
