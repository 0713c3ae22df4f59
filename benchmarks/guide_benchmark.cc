// From the arrival of a frame of 640 x 480 with a checkerboard to what the page is told, while the
// solver's thread works on what was recorded before. The budget is 100 ms on two cores.

#include <benchmark/benchmark.h>

#include <Eigen/Geometry>
#include <numbers>

#include "calibrato/base/value.h"
#include "calibrato/calibration/planned_frame.h"
#include "calibrato/calibration/synthetic_camera_imu_for_test.h"
#include "calibrato/guide/gesture_choice.h"
#include "calibrato/guide/guide_document.h"
#include "calibrato/guide/guide_session.h"
#include "calibrato/rendering/render_board.h"

namespace calibrato {
namespace {

GuideProblem ProblemOf(const SyntheticCameraImu& truth) {
  GuideProblem problem;
  problem.points = PlannedView(truth.board);
  problem.resolution = truth.resolution;
  problem.imu = truth.imu_noise;
  problem.wanted = {1e-6, 1e-6, 1e-6, 1e-9};  // Never reached.
  return problem;
}

GuideData DataOf(const SyntheticCameraImu& truth) {
  Rng rng(4);
  const CameraImuProblem problem = truth.Problem(rng);
  return {problem.cameras[0].views, problem.imus[0].stream};
}

void FrameToHint(benchmark::State& state) {
  SyntheticCameraImu truth;
  truth.duration_s = 30.0;
  const Camera camera{truth.model, truth.resolution, "", std::nullopt};
  const GreyImage image = Digitised(RenderBoard(
      PatternOf(truth.board), camera, truth.T_c_i[0] * truth.PoseAt(1.0).Inverse(), Scene{}));
  const GuideData data = DataOf(truth);
  GuideSession session(truth.board, ProblemOf(truth), {});
  for (const VectorSample& sample : data.imu.gyro) session.AddGyro(sample);
  for (const VectorSample& sample : data.imu.accel) session.AddAccel(sample);
  for (const BoardView& view : data.views) session.AddView(view.stamp, view);
  Time stamp = data.views.back().stamp;
  for (auto _ : state) {
    stamp = stamp + Duration::FromSeconds(0.05);
    session.AddFrame(stamp, image);
    benchmark::DoNotOptimize(ToJsonLine(GuideDocument(session.Snapshot(), {}, truth.resolution)));
  }
}
BENCHMARK(FrameToHint)->Unit(benchmark::kMillisecond)->UseRealTime();

// The solve and the choice of the next gestures, for so many seconds of 20 Hz frames and 200 Hz
// IMU.
void EstimateAndPlan(benchmark::State& state) {
  SyntheticCameraImu truth;
  truth.duration_s = static_cast<double>(state.range(0));
  const GuideData data = DataOf(truth);
  const GuideProblem problem = ProblemOf(truth);
  const Rigid3 T_g_c = FacingBoard(problem.points, truth.PoseAt(0.0) * truth.T_c_i[0].Inverse());
  for (auto _ : state) {
    const LiveEstimate estimate = EstimateSoFar(problem, data);
    const auto gestures =
        GesturesFor({estimate.camera, problem.resolution, problem.points, T_g_c, {}});
    benchmark::DoNotOptimize(PlanGestures(problem, estimate, gestures, {}));
  }
}
BENCHMARK(EstimateAndPlan)->Arg(10)->Arg(60)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace calibrato

BENCHMARK_MAIN();
