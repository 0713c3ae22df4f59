#pragma once

#include <atomic>
#include <cstdint>
#include <string>

#include "calibrato/learning/learn_options.h"
#include "calibrato/learning/team.h"
#include "calibrato/mdp/environment.h"
#include "calibrato/motion/motion.h"

namespace calibrato {

/// How a training run ended.
enum class LearnTermination {
  kDone,             ///< All episodes; the policy is written.
  kInterrupted,      ///< On request; the checkpoint is written, no policy.
  kDiverged,         ///< A number was not finite, again and again; the last checkpoint stands.
  kNothingExecuted,  ///< The carrier refused every action of every test: no motion, no policy.
};
[[nodiscard]] std::string LearnTerminationName(LearnTermination termination);  ///< "done", ..

struct LearnResult {
  Task task = Task::kIntrinsic;
  std::string preset;
  int num_episodes = 0;          ///< Random and training episodes, without tests.
  int64_t num_calibrations = 0;  ///< One for each action that was executed, tests included.
  int64_t num_information_evaluations = 0;  ///< Candidate motions judged without calibrating.
  int num_rollbacks = 0;     ///< How often it diverged and went back to its last checkpoint.
  double best_return = 0.0;  ///< The highest of any episode, tests included.
  /// Wall time of what processes divide among them: the rest is each one's own [s].
  double divided_s = 0.0;
  LearnTermination termination = LearnTermination::kDone;
  /// For people, one line: "training diverged at episode 37, dynamics loss not finite: ...".
  std::string termination_text;
  Motion motion;  ///< Of the test with the highest return; no loops unless done.
};

/// Model-based heuristic reinforcement learning (paper, Algorithm 1).
///
/// After some random episodes, every step of every episode trains the agent on the replay memory,
/// plans, executes the first action of the plan and stores what came of it. An action that
/// the carrier refuses is stored as well: the environment's penalty teaches to avoid it. A test
/// episode, every so often and at the end, always meets the same rig and noise, takes the best
/// particle, and leaves networks and memories as they are. Episodes are played in rounds
/// (LearnOptions::round), and stages follow each other (LearnOptions::stages).
///
/// Where a number is not finite, training goes back to the last checkpoint and on with half the
/// learning rate, and says so in a line of training.jsonl of kind "rollback".
///
/// Writes into `folder`, which is made if it is missing:
///
///     training.jsonl  one line an episode, as it ends
///     checkpoint.bin  the whole state, at the start, after every round and on interruption
///     policy-NAME/    see policy.h, at the end of each stage but the last
///     policy/         at the end of the last
///
/// The same options give the same bytes in all of them, for any number of threads and processes,
/// and whether or not the run was interrupted, killed at any moment, and resumed. A finished run
/// can be resumed with more episodes: with rounds of one episode, or where its episodes fill whole
/// rounds, that is the run that had been longer from the start.
///
/// @param environment  Of which further ones are cloned for rounds of several episodes.
/// @param interrupt  May be null. Once true, in any process, the run stops after the running round.
/// @param team  Null: this process alone. Else all of them call this with the same options, divide
///     the episodes of each round among them, and have the same result; the first writes.
/// @throws InputError if an option is out of range, the folder can't be written, or the checkpoint
///     to resume from is missing, damaged, or of other options (which it names).
[[nodiscard]] LearnResult Learn(const LearnOptions& options, Environment& environment,
                                const std::string& folder,
                                const std::atomic<bool>* interrupt = nullptr, Team* team = nullptr);

}  // namespace calibrato
