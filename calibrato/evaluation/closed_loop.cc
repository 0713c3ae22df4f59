#include "calibrato/evaluation/closed_loop.h"

#include <algorithm>
#include <utility>
#include <variant>

#include "calibrato/base/input_error.h"
#include "calibrato/mdp/calibration_status.h"
#include "calibrato/mdp/design_setting.h"
#include "calibrato/mdp/frames_that_count.h"
#include "calibrato/mdp/motion_design.h"
#include "calibrato/simulation/rig_distribution.h"

namespace calibrato {
namespace {

constexpr int kMaxIterations = 50;

// With the durations that the carrier needs.
Motion AsExecuted(const TimedMotion& timed) {
  Motion motion = timed.motion;
  for (size_t i = 0; i < motion.loops.size(); ++i) {
    motion.loops[i].duration_s = timed.loop_duration_s[i];
  }
  return motion;
}

ExecutableMotion Begin(const Motion& start, Carrier carrier, const Rig& rig) {
  Motion motion = start;
  motion.base_pose = BasePoseBeforeBoard(rig, motion.base_pose);
  return MakeExecutable(std::move(motion), carrier, rig);
}

ExecutableMotion FirstLoops(const Motion& motion, size_t num_loops, Carrier carrier,
                            const Rig& rig) {
  Motion first = motion;
  first.loops.resize(num_loops);
  return MakeExecutable(std::move(first), carrier, rig);
}

// What is left designed for the rig that is believed. @return Nothing if nothing better was found.
std::optional<MotionDesign> DesignRest(MotionDesignProblem problem, const Motion& motion,
                                       Rig believed, int num_executed, int max_evaluations) {
  problem.num_loops = static_cast<int>(motion.loops.size());
  problem.num_fixed_loops = num_executed;
  problem.base_pose = motion.base_pose;
  problem.rigs = {std::move(believed)};
  return DesignMotion(problem, motion, {max_evaluations});
}

}  // namespace

std::optional<ExecutableMotion> WithRestThatFits(Motion motion, size_t num_executed,
                                                 Carrier carrier, const Rig& rig) {
  constexpr int kMaxAttempts = 40;
  constexpr double kShrink = 0.97;
  motion.carrier = carrier;
  for (int attempt = 0; attempt < kMaxAttempts; ++attempt) {
    if (std::holds_alternative<TimedMotion>(PlanMotion(motion, rig))) {
      return MakeExecutable(std::move(motion), carrier, rig);
    }
    for (size_t i = num_executed; i < motion.loops.size(); ++i) {
      motion.loops[i].coefficients *= kShrink;
    }
  }
  return std::nullopt;
}

std::optional<Rig> BelievedAfter(Task task, const Rig& rig, const TrialRecording& recording) {
  Rig believed = AsEstimated(rig);
  believed.time_offset_i_c = Duration();
  const Camera& truth = rig.cameras.front();
  if (task != Task::kExtrinsic) {
    const IntrinsicStatus status =
        CalibrateIntrinsics(FramesThatCount(recording.views, truth.resolution, rig.board), truth,
                            DesignCriterion::kA, kMaxIterations);
    if (!status.model) return std::nullopt;
    believed.cameras.front().model = *status.model;
    return believed;
  }
  ExtrinsicSolve solve;
  solve.max_iterations = kMaxIterations;
  const std::optional<ExtrinsicStatus> status =
      CalibrateExtrinsics(rig, recording.views, recording.imu, rig.T_c0_i, solve);
  if (!status) return std::nullopt;
  believed.T_c0_i = status->estimate;
  return believed;
}

MotionForRig PlayClosedLoop(const MotionDesignProblem& problem, const Motion& start,
                            Carrier carrier, Fidelity fidelity, const Rig& rig, const Rng& noise,
                            const ClosedLoopOptions& options) {
  MotionForRig played{Begin(start, carrier, rig), 0, 0};
  const size_t num_loops = played.motion.timed->motion.loops.size();
  for (size_t done = 1; done < num_loops; ++done) {
    const Motion motion = AsExecuted(*played.motion.timed);
    std::optional<Rig> believed;
    try {
      believed =
          BelievedAfter(problem.task, rig,
                        RecordForTrial(problem.task, rig, FirstLoops(motion, done, carrier, rig),
                                       fidelity, noise));
    } catch (const InputError&) {
      // What can't be recorded can't be answered; the trial of the whole motion says why.
    }
    if (!believed) continue;
    ++played.num_designs;
    const std::optional<MotionDesign> rest = DesignRest(
        problem, motion, *believed, static_cast<int>(done), options.evaluations_per_design);
    if (!rest) continue;
    played.num_information_evaluations += rest->num_information_evaluations;
    const auto fitting = WithRestThatFits(rest->motion, done, carrier, rig);
    if (fitting) played.motion = *fitting;
  }
  return played;
}

MotionForRig DesignForTruth(const MotionDesignProblem& problem, const Motion& start,
                            Carrier carrier, const Rig& rig, int max_evaluations) {
  MotionForRig made{Begin(start, carrier, rig), 0, 1};
  const std::optional<MotionDesign> design =
      DesignRest(problem, AsExecuted(*made.motion.timed), AsEstimated(rig), 0, max_evaluations);
  if (!design) return made;
  made.num_information_evaluations = design->num_information_evaluations;
  made.motion = MakeExecutable(design->motion, carrier, rig);
  return made;
}

}  // namespace calibrato
