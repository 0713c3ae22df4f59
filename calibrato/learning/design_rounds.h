#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "calibrato/base/value.h"
#include "calibrato/learning/trusted_limits.h"
#include "calibrato/mdp/motion_judgement.h"
#include "calibrato/motion/carrier.h"

// What a run with preset `best` (design_learner.h) knows, and its files.

namespace calibrato {

/// One design and what came of it.
struct DesignRound {
  Trust trust = Trust::Ones();
  TimedMotion motion;
  double expected_loss = 0.0;  ///< Of the motion as planned on its carrier, at full trust.
  std::vector<MotionJudgement> judgements;  ///< One an episode.
};

/// Mean of the losses that the solver stated after it saw the data.
[[nodiscard]] double StatedLoss(const DesignRound& round);
/// Half the logarithm of how much larger errors were than stated. That ratio, the pooled NEES over
/// its dimension, is believed to be 1 as firmly as if four more rigs had said so.
[[nodiscard]] double Overconfidence(const DesignRound& round);
/// What a round says of its design [of a sigma's logarithm]: the sum of both.
[[nodiscard]] double RealisedLoss(const DesignRound& round);

/// A judgement on its way between processes.
[[nodiscard]] Value ToValue(const MotionJudgement& judgement);
/// @throws InputError
[[nodiscard]] MotionJudgement JudgementFromValue(const Value& value);

/// All that a run knows: what it will do next follows from it.
struct DesignProgress {
  std::vector<DesignRound> rounds;
  int64_t num_information_evaluations = 0;
};

/// checkpoint.json, and training.jsonl with one line an episode.
/// @param run  What the course of learning depends on, by name.
/// @throws InputError if they can't be written.
void WriteDesignProgress(const std::string& folder, const Value& run,
                         const DesignProgress& progress, Task task);

/// The content of checkpoint.json. @throws InputError that names the file if it is missing.
[[nodiscard]] std::string ReadDesignCheckpoint(const std::string& folder);
/// @param folder  Where the checkpoint stood, for errors.
/// @throws InputError that names the file: damaged, or of another run, and in what.
[[nodiscard]] DesignProgress DesignProgressFromText(const std::string& checkpoint,
                                                    const std::string& folder, const Value& run);

/// policy.yaml (format version, run) and motion.yaml. @throws InputError if they can't be written.
void WriteDesignPolicy(const std::string& folder, const Value& run, const Motion& motion);

}  // namespace calibrato
