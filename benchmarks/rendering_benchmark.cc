// Budget (design): 15 ms for a board at 640 x 480 with distortion and noise, on one core; 60 ms
// with blur.

#include <benchmark/benchmark.h>

#include "calibrato/geometry/rpy.h"
#include "calibrato/rendering/render_board.h"

namespace calibrato {
namespace {

Camera Lens() {
  Eigen::VectorXd parameters(8);
  parameters << 420.0, 418.5, 322.3, 238.6, -0.25, 0.06, 4e-4, -3e-4;
  return {CameraModel("pinhole-radtan", parameters), {640, 480}, "", std::nullopt};
}

Camera Fisheye() {
  Eigen::VectorXd parameters(8);
  parameters << 190.0, 191.0, 321.2, 239.1, 0.01, -0.01, 0.0, 0.0;
  return {CameraModel("pinhole-equi", parameters), {640, 480}, "", std::nullopt};
}

void Render(benchmark::State& state, const Board& board, const Camera& camera, double blur_px) {
  const BoardPattern pattern = PatternOf(board);
  Rigid3 T_c_g;  // filling the image
  Eigen::Matrix3d facing;
  facing << 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0;
  T_c_g.R = RotationFromRpy({0.2, 0.3, 0.1}) * facing;
  T_c_g.t = Eigen::Vector3d(0.0, 0.0, 0.9 * pattern.sheet.sizes().maxCoeff()) -
            T_c_g.R * BoardCentre(board);
  Scene scene;
  scene.blur_px = blur_px;
  scene.vignetting = 0.2;
  Rng rng(1);
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        Digitised(RenderBoard(pattern, camera, T_c_g, scene), {1.0, 0.02}, rng));
  }
}

const Board kCheckerboard = Checkerboard{6, 7, 0.06, 0.06};
const Board kAprilGrid = AprilGrid{6, 6, 0.088, 0.3};
const Board kCharuco = Charuco{9, 12, 0.06, 0.045, "DICT_5X5_100"};
const Board kCircles = CircleGrid{11, 4, 0.04, true};

BENCHMARK_CAPTURE(Render, checkerboard, kCheckerboard, Lens(), 0.0)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Render, checkerboard_fisheye, kCheckerboard, Fisheye(), 0.0)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Render, aprilgrid, kAprilGrid, Lens(), 0.0)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Render, aprilgrid_fisheye, kAprilGrid, Fisheye(), 0.0)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Render, charuco, kCharuco, Lens(), 0.0)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Render, circles, kCircles, Lens(), 0.0)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Render, checkerboard_blur_07, kCheckerboard, Lens(), 0.7)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Render, checkerboard_blur_10, kCheckerboard, Lens(), 1.0)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace calibrato

BENCHMARK_MAIN();
