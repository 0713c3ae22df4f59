#include "calibrato/evaluation/contest.h"

#include "calibrato/base/input_error.h"
#include "calibrato/base/parallel.h"
#include "calibrato/base/progress.h"
#include "calibrato/motion/paper_scene.h"
#include "calibrato/simulation/headless_gl.h"

namespace calibrato {
namespace {

// Keeps the rigs of trials apart from those of training under the same seed.
constexpr const char* kRigPurpose = "evaluation rig";
constexpr const char* kNoisePurpose = "evaluation noise";

// A hand has no dynamics either, whatever the others move on.
void CheckTrajectories(const ContestSetting& setting, const std::vector<Contestant>& contestants) {
  if (setting.fidelity != Fidelity::kPhysical) return;
  for (const Contestant& contestant : contestants) {
    for (const ExecutableMotion& motion : contestant.motions) {
      if (motion.timed) continue;
      throw InputError({"fidelity physical is that of an arm", contestant.policy,
                        "a recorded trajectory is carried by hand, and has no dynamics",
                        "leave it out, or use --fidelity fast or rendered"});
    }
  }
}

Trial TrialOf(const ContestSetting& setting, const Rig& rig, const ExecutableMotion& motion,
              const Rng& noise) {
  try {
    return RunTrial(setting.task, rig, MotionOnRig(setting, motion, rig), setting.fidelity, noise);
  } catch (const InputError& error) {
    Trial failed;
    failed.failure = error.what();
    failed.path_length_m = motion.path_length_m;
    failed.path_length_original_m = motion.path_length_original_m;
    failed.motion_s = motion.path.duration_s;
    return failed;
  }
}

}  // namespace

void CheckFidelity(const ContestSetting& setting) {
  if (setting.fidelity == Fidelity::kPhysical && setting.carrier != Carrier::kArm) {
    throw InputError({"fidelity physical is that of an arm", "",
                      "the carrier '" + CarrierName(setting.carrier) + "' has no dynamics",
                      "use --carrier arm, or --fidelity fast"});
  }
  if (setting.fidelity == Fidelity::kRendered) const HeadlessGl opens;
}

std::vector<Rig> RigsUnderTrial(const ContestSetting& setting) {
  const auto num_rigs = static_cast<size_t>(setting.num_rigs);
  if (setting.fixed_rig) return std::vector<Rig>(num_rigs, *setting.fixed_rig);
  const Rng rng(setting.seed);
  return ParallelMap<Rig>(num_rigs, [&](size_t i) {
    Rng draws = rng.Stream(kRigPurpose, i);
    return DrawRig(setting.rigs, draws);
  });
}

Rng NoiseOf(const ContestSetting& setting, size_t rig) {
  return Rng(setting.seed).Stream(kNoisePurpose, rig);
}

Rig PlanningScene(const ContestSetting& setting) {
  return setting.fixed_rig ? *setting.fixed_rig : PaperRig();
}

std::string RigsName(const ContestSetting& setting) {
  return setting.fixed_rig ? "file" : RigDistributionName(setting.rigs);
}

ExecutableMotion MotionOnRig(const ContestSetting& setting, const ExecutableMotion& motion,
                             const Rig& rig) {
  const bool stands_where_planned = setting.fixed_rig || IsPapersScene(setting.rigs);
  return stands_where_planned ? motion : BeforeBoard(motion, rig);
}

ContestTrials RunContest(const ContestSetting& setting, const std::vector<Rig>& rigs,
                         const std::vector<Contestant>& contestants) {
  CheckFidelity(setting);
  CheckTrajectories(setting, contestants);
  Progress progress("evaluating", static_cast<int64_t>(rigs.size()));
  // Of one rig: all members of all contestants, one after the other.
  const auto of_rigs = ParallelMap<std::vector<Trial>>(rigs.size(), [&](size_t i) {
    const Rng noise = NoiseOf(setting, i);
    std::vector<Trial> trials;
    for (const Contestant& contestant : contestants) {
      for (size_t m = 0; m < contestant.num_members(); ++m) {
        trials.push_back(TrialOf(setting, rigs[i], contestant.MotionFor(m, i), noise));
      }
    }
    progress.Advance();
    return trials;
  });
  ContestTrials contest;
  size_t next = 0;
  for (const Contestant& contestant : contestants) {
    std::vector<std::vector<Trial>>& members = contest.emplace_back();
    for (size_t m = 0; m < contestant.num_members(); ++m, ++next) {
      std::vector<Trial>& trials = members.emplace_back();
      for (const std::vector<Trial>& of_rig : of_rigs) trials.push_back(of_rig[next]);
    }
  }
  return contest;
}

Figures FiguresOf(const std::vector<std::vector<Trial>>& trials, double Trial::*figure) {
  Figures figures;
  for (const std::vector<Trial>& member : trials) {
    std::vector<double>& values = figures.emplace_back();
    for (const Trial& trial : member) values.push_back(trial.*figure);
  }
  return figures;
}

int NumFailures(const std::vector<std::vector<Trial>>& trials) {
  int count = 0;
  for (const std::vector<Trial>& member : trials) {
    for (const Trial& trial : member) count += trial.failure.empty() ? 0 : 1;
  }
  return count;
}

}  // namespace calibrato
