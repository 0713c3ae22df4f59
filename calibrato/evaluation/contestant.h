#pragma once

#include <functional>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "calibrato/evaluation/recorded_trajectory.h"
#include "calibrato/motion/carrier.h"
#include "calibrato/motion/motion.h"
#include "calibrato/sensors/rig.h"

namespace calibrato {

/// A motion that somebody brings to be judged.
struct MotionUnderTrial {
  /// What its row is called: "learned", "fine-tuned", or a file's name. Motions of one name are
  /// members of one method: what different training seeds gave.
  std::string policy;
  std::variant<Motion, RecordedTrajectory> way;
  std::optional<Task> task;  ///< That it was made for; else it is judged in every task.
  /// Its base pose is that of the scene it was learned in: before a rig file's board it is found
  /// anew. What somebody wrote for a rig stays where it was put.
  bool aims_at_board = false;
};

/// A motion, ready to be executed.
struct ExecutableMotion {
  CarrierPath path;
  std::optional<TimedMotion> timed;  ///< Of looped motions; not of recorded trajectories.
  double path_length_m = 0.0;
  double path_length_original_m = 0.0;  ///< NaN for recorded trajectories.
  double scale = 1.0;                   ///< Below 1: shrunk to fit its carrier.
};

/// Plans it on the carrier; what does not fit is shrunk by the largest factor that fits.
/// @throws InputError if it can't be made at any scale.
[[nodiscard]] ExecutableMotion MakeExecutable(Motion motion, Carrier carrier, const Rig& scene);
[[nodiscard]] ExecutableMotion MakeExecutable(const RecordedTrajectory& trajectory,
                                              const Rig& scene);
[[nodiscard]] ExecutableMotion MakeExecutable(const MotionUnderTrial& motion, Carrier carrier,
                                              const Rig& scene);

/// The same before the board of a rig that stands elsewhere than where it was planned. Recorded
/// trajectories stay: they are relative to the board already.
/// @throws InputError if it can't be made there at any scale.
[[nodiscard]] ExecutableMotion BeforeBoard(const ExecutableMotion& motion, const Rig& rig);

/// One method under trial.
struct Contestant {
  std::string policy;
  /// The members, each tried on every rig; or, with is_drawn_afresh, a motion for each rig.
  std::vector<ExecutableMotion> motions;
  bool is_drawn_afresh = false;

  [[nodiscard]] size_t num_members() const { return is_drawn_afresh ? 1 : motions.size(); }
  [[nodiscard]] const ExecutableMotion& MotionFor(size_t member, size_t rig) const {
    return motions[is_drawn_afresh ? rig : member];
  }
  [[nodiscard]] double mean_path_length_m() const;
};

/// A random motion for every rig, planned on it.
[[nodiscard]] Contestant RandomContestant(Task task, Carrier carrier, const std::vector<Rig>& rigs,
                                          const Rng& rng);

/// One of a kind, planned before the scene's board (BasePoseBeforeBoard).
[[nodiscard]] Contestant FixedContestant(const std::string& policy, const Motion& motion,
                                         Carrier carrier, const Rig& scene);

/// What was brought for this task, one contestant a name, in the order of first appearance.
[[nodiscard]] std::vector<Contestant> BroughtContestants(
    const std::vector<MotionUnderTrial>& motions, Task task, Carrier carrier, const Rig& scene);

/// Every motion multiplied by a factor of its own so that its path has this length, as far as the
/// carrier allows. Recorded trajectories stay as they are.
/// @param scene  For each motion, the rig that it is planned on.
[[nodiscard]] Contestant AtPathLength(const Contestant& contestant, const std::string& policy,
                                      double path_length_m, Carrier carrier,
                                      const std::function<const Rig&(size_t motion)>& scene);

}  // namespace calibrato
