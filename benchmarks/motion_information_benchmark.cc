// Budgets: information of a candidate motion without a solve 10 ms, with its gradient 40 ms, each
// task with its own number of loops (4 intrinsic, 3 extrinsic), on one thread.

#include <benchmark/benchmark.h>

#include "calibrato/mdp/motion_information.h"
#include "calibrato/simulation/rig_distribution.h"

namespace calibrato {
namespace {

// @param state.range(0)  0: intrinsic task, 1: extrinsic. @param state.range(1)  1: with gradient.
void BM_MotionInformation(benchmark::State& state) {
  const Task task = state.range(0) == 0 ? Task::kIntrinsic : Task::kExtrinsic;
  Rng rng(1);
  const Rig rig = DrawRig(RigDistribution::kPaper, rng);
  const Motion motion = HandcraftedMotion(task);
  MotionInformationOptions options;
  options.want_gradient = state.range(1) == 1;
  for (auto _ : state) {
    benchmark::DoNotOptimize(task == Task::kIntrinsic
                                 ? ExpectIntrinsicInformation(rig, motion, options)
                                 : ExpectExtrinsicInformation(rig, motion, options));
  }
}
BENCHMARK(BM_MotionInformation)
    ->ArgNames({"extrinsic", "gradient"})
    ->ArgsProduct({{0, 1}, {0, 1}})
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace calibrato

BENCHMARK_MAIN();
