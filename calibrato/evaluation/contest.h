#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "calibrato/base/rng.h"
#include "calibrato/evaluation/contestant.h"
#include "calibrato/evaluation/statistics.h"
#include "calibrato/evaluation/trial.h"
#include "calibrato/simulation/rig_distribution.h"

namespace calibrato {

/// Where motions are judged. Every method is tried on the same rigs, none of which training draws,
/// with the same noise.
struct ContestSetting {
  Task task = Task::kIntrinsic;
  Carrier carrier = Carrier::kFree;
  Fidelity fidelity = Fidelity::kFast;
  RigDistribution rigs = RigDistribution::kPaper;
  /// Every trial on this one instead, with noise of its own.
  std::optional<Rig> fixed_rig;
  int num_rigs = 500;  ///< 2 to 1e6
  uint64_t seed = 1;
};

/// The rigs of the setting.
[[nodiscard]] std::vector<Rig> RigsUnderTrial(const ContestSetting& setting);

/// The noise of a rig's trials: whatever the motion.
[[nodiscard]] Rng NoiseOf(const ContestSetting& setting, size_t rig);

/// The scene in which motions are planned that are the same for all rigs.
[[nodiscard]] Rig PlanningScene(const ContestSetting& setting);

/// "paper", or "file".
[[nodiscard]] std::string RigsName(const ContestSetting& setting);

/// The motion as one rig makes it: planned anew before boards that stand elsewhere than where it
/// was planned.
/// @throws InputError if it fits there at no scale.
[[nodiscard]] ExecutableMotion MotionOnRig(const ContestSetting& setting,
                                           const ExecutableMotion& motion, const Rig& rig);

/// trials[contestant][member][rig].
using ContestTrials = std::vector<std::vector<std::vector<Trial>>>;

/// What fails here fails for every trial.
/// @throws InputError for a fidelity that the carrier or the machine does not have.
void CheckFidelity(const ContestSetting& setting);

/// @throws InputError as CheckFidelity does.
[[nodiscard]] ContestTrials RunContest(const ContestSetting& setting, const std::vector<Rig>& rigs,
                                       const std::vector<Contestant>& contestants);

/// One figure of all trials of a method.
[[nodiscard]] Figures FiguresOf(const std::vector<std::vector<Trial>>& trials,
                                double Trial::*figure);

/// How many trials failed.
[[nodiscard]] int NumFailures(const std::vector<std::vector<Trial>>& trials);

}  // namespace calibrato
