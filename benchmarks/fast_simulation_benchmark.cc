// Budget: 10 ms for a loop of 5 s, 50 frames of 42 corners and 1000 IMU samples, with the limits of
// the free carrier.

#include <benchmark/benchmark.h>

#include "calibrato/motion/paper_scene.h"
#include "calibrato/simulation/fast_simulation.h"
#include "calibrato/simulation/imu_simulation.h"

namespace calibrato {
namespace {

Motion OneLoop() {
  Motion motion = HandcraftedMotion(Task::kExtrinsic);
  motion.loops.resize(1);
  return motion;
}

Rig BlurredRig() {
  Rig rig = PaperRig();
  rig.exposure_s = 0.005;
  return rig;
}

void BM_PlanOnFreeCarrier(benchmark::State& state) {
  const Rig rig = BlurredRig();
  const Motion motion = OneLoop();
  for (auto _ : state) benchmark::DoNotOptimize(PlanMotion(motion, rig));
}
BENCHMARK(BM_PlanOnFreeCarrier)->Unit(benchmark::kMillisecond);

void BM_SimulateFrames(benchmark::State& state) {
  const Rig rig = BlurredRig();
  const auto motion = std::get<TimedMotion>(PlanMotion(OneLoop(), rig));
  Rng rng(1);
  for (auto _ : state) benchmark::DoNotOptimize(SimulateFrames(rig, motion, Time(), rng));
}
BENCHMARK(BM_SimulateFrames)->Unit(benchmark::kMillisecond);

void BM_SimulateImu(benchmark::State& state) {
  Rig rig = BlurredRig();
  rig.imu_disturbances.low_pass_hz = state.range(0) != 0 ? 40.0 : 0.0;
  const auto motion = std::get<TimedMotion>(PlanMotion(OneLoop(), rig));
  Rng rng(1);
  size_t num_samples = 0;
  for (auto _ : state) num_samples = SimulateImu(rig, motion, Time(), rng).stream.gyro.size();
  state.counters["samples"] = static_cast<double>(num_samples);
}
BENCHMARK(BM_SimulateImu)->ArgName("low_pass")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

void BM_WholeLoop(benchmark::State& state) {
  const Rig rig = BlurredRig();
  const Motion motion = OneLoop();
  Rng rng(1);
  for (auto _ : state) {
    const auto timed = std::get<TimedMotion>(PlanMotion(motion, rig));
    benchmark::DoNotOptimize(SimulateFrames(rig, timed, Time(), rng));
    benchmark::DoNotOptimize(SimulateImu(rig, timed, Time(), rng));
  }
}
BENCHMARK(BM_WholeLoop)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace calibrato

BENCHMARK_MAIN();
