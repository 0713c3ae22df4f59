#include "calibrato/motion/arm_carrier.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "calibrato/motion/board_in_view.h"
#include "calibrato/motion/joint_path_cost.h"
#include "calibrato/motion/joint_path_refinement.h"
#include "calibrato/motion/joint_path_search.h"
#include "calibrato/motion/joint_timing.h"
#include "calibrato/motion/looped_path.h"

namespace calibrato {
namespace {

PosePath PosesAlong(const Motion& motion) {
  PosePath poses;
  poses.start = LoopPoseAt(motion.base_pose, LoopCoefficients::Zero(), 0.0);
  for (const Loop& loop : motion.loops) {
    PosePath::Loop& loop_poses = poses.loops.emplace_back();
    for (int i = 1; i < kNumWayPoints; ++i) {
      loop_poses[i - 1] = LoopPoseAt(motion.base_pose, loop.coefficients, WayPointPhase(i));
    }
  }
  return poses;
}

// The least of a function of pose and last joint, over a fine grid of the last joint.
template <typename Function>
double LeastOverLastJoint(const Rigid3& T_b_e, const Function& function) {
  constexpr int kGridSize = 400;
  const double lower = Limits().lower[6];
  const double upper = Limits().upper[6];
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= kGridSize; ++i) {
    least = std::min(least, function(T_b_e, lower + (upper - lower) * i / kGridSize));
  }
  return least;
}

// True if no joint angles at all reach the pose within the limits, whatever path leads there.
bool LiesBeyondLimits(const Rigid3& T_b_e) {
  const auto least_excess = [](const Rigid3& pose, double q7) {
    double least = std::numeric_limits<double>::infinity();
    for (const JointVector& q : PandaInverse(pose, q7))
      least = std::min(least, JointLimitExcess(q));
    return least;
  };
  constexpr double kGridError = 1e-3;  // [rad]
  return LeastOverLastJoint(T_b_e, least_excess) > kGridError;
}

Refusal OutOfReach(const Rigid3& T_b_e) {
  Refusal refusal;
  refusal.limit = "way beyond the reach of the arm";
  refusal.value = LeastOverLastJoint(T_b_e, PandaShortfall);
  refusal.unit = "m";
  return refusal;
}

std::optional<Refusal> CheckJoints(const JointPath& path, size_t loop, int way_point) {
  const JointVector& q = path.At(loop, way_point);
  const JointVector& before = path.At(loop, way_point - 1);
  Refusal refusal;
  refusal.unit = "rad";
  for (int i = 0; i < q.size(); ++i) {
    const std::string joint = "joint " + std::to_string(i + 1);
    refusal.value = q[i];
    refusal.limit = joint + " lower limit";
    refusal.bound = Limits().lower[i];
    if (!(q[i] >= refusal.bound)) return refusal;
    refusal.limit = joint + " upper limit";
    refusal.bound = Limits().upper[i];
    if (!(q[i] <= refusal.bound)) return refusal;
    refusal.limit = joint + " step between way-points";
    refusal.value = std::abs(q[i] - before[i]);
    refusal.bound = kMaxJointStep;
    if (!(refusal.value <= refusal.bound)) return refusal;
  }
  return std::nullopt;
}

// The first of the way-points that `check` refuses, with the number of them.
template <typename Check>
std::optional<Refusal> CheckWayPoints(size_t num_loops, const Check& check) {
  std::optional<Refusal> first;
  int num_bad_way_points = 0;
  for (size_t loop = 0; loop < num_loops; ++loop) {
    for (int i = 1; i <= kNumWayPoints; ++i) {
      std::optional<Refusal> refusal = check(loop, i);
      if (!refusal) continue;
      ++num_bad_way_points;
      if (first) continue;
      first = std::move(refusal);
      first->loop = static_cast<int>(loop);
      first->way_point = i;
    }
  }
  if (first) {
    first->num_bad_way_points = num_bad_way_points;
    first->num_way_points = kNumWayPoints * static_cast<int>(num_loops);
  }
  return first;
}

bool FitsLimits(const JointPath& path) {
  const auto fits = [](const JointVector& q) { return JointLimitExcess(q) <= 0.0; };
  return fits(path.start) && std::ranges::all_of(path.loops, [&](const JointPath::Loop& loop) {
           return std::ranges::all_of(loop, fits);
         });
}

// Walls before the joint limits, each nearer and steeper than the one before it.
constexpr std::array<JointPathCost, 3> kPathCosts = {{{.margin = 0.1, .weight = 100.0},
                                                      {.margin = 0.02, .weight = 1e4},
                                                      {.margin = 0.002, .weight = 1e6}}};

// With one wall after the other, from `first_cost` on, until the path fits.
JointPath Refined(const PosePath& poses, JointPath path, size_t first_cost) {
  for (size_t i = first_cost; i < kPathCosts.size(); ++i) {
    path = RefineJointPath(poses, path, kPathCosts[i]);
    if (FitsLimits(path)) break;
  }
  return path;
}

TimedMotion Timed(const Motion& motion, const JointPath& path) {
  TimedMotion timed;
  timed.motion = motion;
  for (size_t loop = 0; loop < motion.loops.size(); ++loop) {
    const double duration_s = motion.loops[loop].duration_s;
    timed.loop_duration_s.push_back(duration_s * SmallestStretch(path, loop, duration_s));
  }
  timed.joint_path = TimedJointPath(path, timed.loop_duration_s);
  return timed;
}

// Refines candidates and keeps the quickest that fits and the one with the fewest way-points that
// do not.
class Selection {
 public:
  Selection(const Motion& motion, const PosePath& poses) : motion_(motion), poses_(poses) {}

  void Try(const JointPath& candidate, size_t first_cost) {
    JointPath path = Refined(poses_, candidate, first_cost);
    const auto check = [&](size_t loop, int i) { return CheckJoints(path, loop, i); };
    std::optional<Refusal> refusal = CheckWayPoints(motion_.loops.size(), check);
    if (!refusal) {
      TimedMotion timed = Timed(motion_, path);
      if (!quickest_ || timed.duration_s() < quickest_->duration_s()) quickest_ = std::move(timed);
    } else if (!fewest_bad_ || refusal->num_bad_way_points < fewest_bad_->num_bad_way_points) {
      fewest_bad_ = std::move(refusal);
      fewest_bad_path_ = std::move(path);
    }
  }

  const std::optional<TimedMotion>& quickest() const { return quickest_; }
  // @pre no candidate fits
  const Refusal& fewest_bad() const { return *fewest_bad_; }
  // For the way-points alone that would be bad on any path. @pre no candidate fits
  std::optional<Refusal> BadOnAnyPath() const {
    return CheckWayPoints(motion_.loops.size(), [&](size_t loop, int i) {
      std::optional<Refusal> refusal = CheckJoints(fewest_bad_path_, loop, i);
      if (refusal && !LiesBeyondLimits(poses_.At(loop, i))) refusal.reset();
      return refusal;
    });
  }

 private:
  const Motion& motion_;
  const PosePath& poses_;
  std::optional<TimedMotion> quickest_;
  std::optional<Refusal> fewest_bad_;
  JointPath fewest_bad_path_;
};

}  // namespace

std::variant<TimedMotion, Refusal> PlanOnArm(const Motion& motion, const Rig& rig) {
  const PosePath poses = PosesAlong(motion);
  const size_t num_loops = motion.loops.size();
  const JointChoices choices = JointChoicesAlong(poses);
  const auto check_pose = [&](size_t loop, int way_point) -> std::optional<Refusal> {
    const Rigid3& T_b_e = poses.At(loop, way_point);
    if (choices.At(loop, way_point).empty()) return OutOfReach(T_b_e);
    return CheckBoardInView(T_b_e, rig);
  };
  if (std::optional<Refusal> refusal = CheckWayPoints(num_loops, check_pose)) return *refusal;

  Selection selection(motion, poses);
  const auto try_paths = [&](const JointChoices& from, size_t first_cost) {
    std::variant<std::vector<JointPath>, Refusal> search =
        SearchJointPaths(from, kPathCosts[first_cost]);
    if (auto* refusal = std::get_if<Refusal>(&search)) {
      refusal->num_way_points = kNumWayPoints * static_cast<int>(num_loops);
      return std::optional(*std::move(refusal));
    }
    for (const JointPath& path : std::get<std::vector<JointPath>>(search)) {
      selection.Try(path, first_cost);
    }
    return std::optional<Refusal>();
  };
  if (const std::optional<Refusal> gap = try_paths(choices, 0)) return *gap;
  if (selection.quickest()) return *selection.quickest();
  if (const std::optional<Refusal> refusal = selection.BadOnAnyPath()) return *refusal;
  // Every way-point alone can be reached. A soft wall on a coarse grid may have led astray.
  (void)try_paths(FinerWhereTight(poses, choices), 1);
  if (selection.quickest()) return *selection.quickest();
  return selection.fewest_bad();
}

}  // namespace calibrato
