#include "calibrato/evaluation/contestant.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "calibrato/base/parallel.h"
#include "calibrato/mdp/design_setting.h"

namespace calibrato {
namespace {

ExecutableMotion Planned(TimedMotion timed) {
  ExecutableMotion planned;
  planned.path = PlannedPath(timed);
  planned.path_length_m = PathLength(timed.motion);
  planned.path_length_original_m = PathLengthOriginal(timed.motion);
  planned.scale = timed.scale;
  planned.timed = std::move(timed);
  return planned;
}

Motion Aimed(Motion motion, const Rig& scene) {
  motion.base_pose = BasePoseBeforeBoard(scene, motion.base_pose);
  return motion;
}

}  // namespace

ExecutableMotion MakeExecutable(Motion motion, Carrier carrier, const Rig& scene) {
  motion.carrier = carrier;
  return Planned(PlanScaledToFit(motion, scene));
}

ExecutableMotion MakeExecutable(const RecordedTrajectory& trajectory, const Rig& scene) {
  ExecutableMotion planned;
  planned.path = PathAlong(trajectory, scene);
  planned.path_length_m = PathLength(planned.path);
  planned.path_length_original_m = std::numeric_limits<double>::quiet_NaN();
  return planned;
}

ExecutableMotion MakeExecutable(const MotionUnderTrial& motion, Carrier carrier, const Rig& scene) {
  if (const auto* looped = std::get_if<Motion>(&motion.way)) {
    return MakeExecutable(motion.aims_at_board ? Aimed(*looped, scene) : *looped, carrier, scene);
  }
  return MakeExecutable(std::get<RecordedTrajectory>(motion.way), scene);
}

ExecutableMotion BeforeBoard(const ExecutableMotion& motion, const Rig& rig) {
  return motion.timed ? Planned(BeforeBoard(*motion.timed, rig)) : motion;
}

double Contestant::mean_path_length_m() const {
  double sum = 0.0;
  for (const ExecutableMotion& motion : motions) sum += motion.path_length_m;
  return sum / static_cast<double>(motions.size());
}

Contestant RandomContestant(Task task, Carrier carrier, const std::vector<Rig>& rigs,
                            const Rng& rng) {
  Contestant random{"random", {}, true};
  random.motions = ParallelMap<ExecutableMotion>(rigs.size(), [&](size_t i) {
    Rng draws = rng.Stream("evaluation motion", i);
    return MakeExecutable(Aimed(RandomMotion(task, draws), rigs[i]), carrier, rigs[i]);
  });
  return random;
}

Contestant FixedContestant(const std::string& policy, const Motion& motion, Carrier carrier,
                           const Rig& scene) {
  return {policy, {MakeExecutable(Aimed(motion, scene), carrier, scene)}, false};
}

std::vector<Contestant> BroughtContestants(const std::vector<MotionUnderTrial>& motions, Task task,
                                           Carrier carrier, const Rig& scene) {
  std::vector<Contestant> contestants;
  for (const MotionUnderTrial& motion : motions) {
    if (motion.task && *motion.task != task) continue;
    auto same = std::find_if(contestants.begin(), contestants.end(), [&](const Contestant& other) {
      return other.policy == motion.policy;
    });
    if (same == contestants.end()) {
      contestants.push_back({motion.policy, {}, false});
      same = contestants.end() - 1;
    }
    same->motions.push_back(MakeExecutable(motion, carrier, scene));
  }
  return contestants;
}

Contestant AtPathLength(const Contestant& contestant, const std::string& policy,
                        double path_length_m, Carrier carrier,
                        const std::function<const Rig&(size_t motion)>& scene) {
  Contestant scaled = contestant;
  scaled.policy = policy;
  scaled.motions = ParallelMap<ExecutableMotion>(contestant.motions.size(), [&](size_t i) {
    const ExecutableMotion& planned = contestant.motions[i];
    if (!planned.timed || !(planned.path_length_m > 0.0)) return planned;
    Motion motion = planned.timed->motion;
    for (Loop& loop : motion.loops) loop.coefficients *= path_length_m / planned.path_length_m;
    return MakeExecutable(std::move(motion), carrier, scene(i));
  });
  return scaled;
}

}  // namespace calibrato
