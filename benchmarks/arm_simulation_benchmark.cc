// Budgets: physical simulation 50 times real time; a rendered image of 640 x 480 with blur and the
// room 60 ms.

#include <benchmark/benchmark.h>

#include <variant>

#include "calibrato/motion/paper_scene.h"
#include "calibrato/simulation/arm_execution.h"
#include "calibrato/simulation/rendered_camera.h"

namespace calibrato {
namespace {

TimedMotion Handcrafted() {
  Motion motion = HandcraftedMotion(Task::kExtrinsic);
  motion.carrier = Carrier::kArm;
  return std::get<TimedMotion>(PlanMotion(motion, PaperRig()));
}

void BM_PlanOnArm(benchmark::State& state) {
  Motion motion = HandcraftedMotion(Task::kExtrinsic);
  motion.carrier = Carrier::kArm;
  const Rig rig = PaperRig();
  for (auto _ : state) benchmark::DoNotOptimize(PlanMotion(motion, rig));
}
BENCHMARK(BM_PlanOnArm)->Unit(benchmark::kMillisecond);

void BM_ExecuteOnArm(benchmark::State& state) {
  const Rig rig = PaperRig();
  const TimedMotion motion = Handcrafted();
  const ArmScene scene(rig);
  Rng rng(1);
  for (auto _ : state) benchmark::DoNotOptimize(ExecuteOnArm(scene, rig, motion, rng));
  state.counters["times_real_time"] =
      benchmark::Counter(motion.duration_s(), benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK(BM_ExecuteOnArm)->Unit(benchmark::kMillisecond);

void BM_TakeImage(benchmark::State& state) {
  Rig rig = PaperRig();
  rig.exposure_s = state.range(0) != 0 ? 0.005 : 0.0;
  rig.image_disturbances.read_noise = 1.5;
  rig.image_disturbances.shot_noise = 0.02;
  const CarrierPath path = PlannedPath(Handcrafted());
  const RenderedCamera camera(rig);
  Rng rng(1);
  int k = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(camera.Take(path, 0.1 * static_cast<double>(k++ % 150), rng));
  }
}
BENCHMARK(BM_TakeImage)
    ->ArgName("blur")
    ->Arg(0)
    ->Arg(1)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->MeasureProcessCPUTime();

}  // namespace
}  // namespace calibrato

BENCHMARK_MAIN();
