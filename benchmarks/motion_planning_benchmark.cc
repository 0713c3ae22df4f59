// Planning one loop on the arm: 0.1 s at the most. A learner plans thousands.

#include <benchmark/benchmark.h>

#include <variant>
#include <vector>

#include "calibrato/motion/carrier.h"
#include "calibrato/motion/paper_scene.h"

namespace calibrato {
namespace {

// Loops of random motions, one each.
std::vector<Motion> RandomLoops(Timing timing) {
  Rng rng(1);
  std::vector<Motion> motions;
  for (int i = 0; i < 5; ++i) {
    Motion several = RandomMotion(Task::kIntrinsic, rng);
    several.carrier = Carrier::kArm;
    several.timing = timing;
    for (const Loop& loop : several.loops) {
      Motion one = several;
      one.loops = {loop};
      motions.push_back(one);
    }
  }
  return motions;
}

void BM_PlanOneLoopOnArm(benchmark::State& state) {
  const Rig rig = PaperRig();
  const auto motions = RandomLoops(state.range(0) != 0 ? Timing::kOptimal : Timing::kQuintic);
  size_t i = 0;
  int64_t num_planned = 0;
  for (auto _ : state) {
    const auto plan = PlanMotion(motions[i++ % motions.size()], rig);
    num_planned += std::holds_alternative<TimedMotion>(plan) ? 1 : 0;
  }
  state.counters["planned"] =
      static_cast<double>(num_planned) / static_cast<double>(state.iterations());
}

BENCHMARK(BM_PlanOneLoopOnArm)->ArgName("optimal")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace calibrato

BENCHMARK_MAIN();
