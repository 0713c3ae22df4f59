#include "calibrato/motion/arm_carrier.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "calibrato/motion/arm_clearance.h"
#include "calibrato/motion/board_in_view.h"
#include "calibrato/motion/joint_motion.h"
#include "calibrato/motion/joint_path_checks.h"
#include "calibrato/motion/joint_path_cost.h"
#include "calibrato/motion/joint_path_refinement.h"
#include "calibrato/motion/joint_path_search.h"
#include "calibrato/motion/joint_timing.h"
#include "calibrato/motion/looped_path.h"
#include "calibrato/motion/optimal_timing.h"
#include "calibrato/motion/singularity.h"
#include "calibrato/motion/time_law.h"

namespace calibrato {
namespace {

// The least of a function of pose and last joint, over a fine grid of the last joint.
template <typename Function>
double LeastOverLastJoint(const Rigid3& T_b_e, const JointRange& range, const Function& function) {
  constexpr int kGridSize = 400;
  const double lower = range.lower[6];
  const double upper = range.upper[6];
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= kGridSize; ++i) {
    least = std::min(least, function(T_b_e, lower + (upper - lower) * i / kGridSize));
  }
  return least;
}

// True if no joint angles at all reach the pose within the limits, whatever path leads there.
bool LiesBeyondLimits(const Rigid3& T_b_e, const JointRange& range) {
  const auto least_excess = [&](const Rigid3& pose, double q7) {
    double least = std::numeric_limits<double>::infinity();
    for (const JointVector& q : PandaInverse(pose, q7))
      least = std::min(least, JointLimitExcess(q, range));
    return least;
  };
  constexpr double kGridError = 1e-3;  // [rad]
  return LeastOverLastJoint(T_b_e, range, least_excess) > kGridError;
}

Refusal OutOfReach(const Rigid3& T_b_e) {
  Refusal refusal;
  refusal.limit = "way beyond the reach of the arm";
  refusal.value = LeastOverLastJoint(T_b_e, {}, PandaShortfall);
  refusal.unit = "m";
  return refusal;
}

// At every way-point and between them.
bool FitsLimits(const JointPath& path, const JointRange& range) {
  return std::ranges::all_of(SplinesThrough(path), [&](const LoopJointSpline& spline) {
    for (int i = 1; i <= kNumWayPoints; ++i) {
      if (CheckRange(spline.RangeOnTheWayTo(i), range)) return false;
    }
    return true;
  });
}

// Walls before the joint limits, each nearer and steeper than the one before it.
using JointPathCosts = std::array<JointPathCost, 3>;
JointPathCosts PathCosts(const JointRange& range) {
  return {{{.margin = 0.1, .weight = 100.0, .range = range},
           {.margin = 0.02, .weight = 1e4, .range = range},
           {.margin = 0.002, .weight = 1e6, .range = range}}};
}

// The same with a wide berth of obstacles and singularities, at a price that outweighs any detour.
JointPathCosts CarefulPathCosts(const JointRange& range, const ClearanceCheck& clearance,
                                double clearance_m) {
  constexpr double kWideBerth = 0.03;  // [m]
  const std::vector<KeptDistance> kept = {
      {[&clearance](const JointVector& q) { return clearance.Least(q).distance_m; },
       clearance_m + kWideBerth, 1e4},
      {SingularityDistance, 2.0 * kMinSingularityDistance, 1e4}};
  JointPathCosts costs = PathCosts(range);
  for (JointPathCost& cost : costs) cost.kept_distances = kept;
  return costs;
}

// Narrower than the arm's own: its controller follows to within a fraction of a milliradian, and a
// joint that is beyond its limit stops the arm.
JointRange RangeOf(const ArmLimits& limits) {
  constexpr double kTracking = 1e-3;  // [rad]
  return {.lower = (Limits().lower.array() + kTracking).matrix().cwiseMax(limits.joint_lower),
          .upper = (Limits().upper.array() - kTracking).matrix().cwiseMin(limits.joint_upper)};
}

// The range, narrower by what the joints need beyond it.
JointRange Narrowed(const JointRange& range, const JointPath& path) {
  JointRange narrowed = range;
  for (const LoopJointSpline& spline : SplinesThrough(path)) {
    for (int i = 1; i <= kNumWayPoints; ++i) {
      const JointRange taken = spline.RangeOnTheWayTo(i);
      narrowed.lower = narrowed.lower.cwiseMax(2.0 * range.lower - taken.lower);
      narrowed.upper = narrowed.upper.cwiseMin(2.0 * range.upper - taken.upper);
    }
  }
  return narrowed;
}

// With one wall after the other, from `first_cost` on, until the path fits. Last, where it runs
// along a limit and swings beyond it between way-points, the way-points draw back by as much.
JointPath Refined(const PosePath& poses, JointPath path, const JointPathCosts& costs,
                  size_t first_cost) {
  for (size_t i = first_cost; i < costs.size(); ++i) {
    path = RefineJointPath(poses, path, costs[i]);
    if (FitsLimits(path, costs[i].range)) return path;
  }
  JointPathCost cost = costs.back();
  cost.range = Narrowed(cost.range, path);
  JointPath drawn_back = RefineJointPath(poses, path, cost);
  return FitsLimits(drawn_back, costs.back().range) ? drawn_back : path;
}

std::optional<Refusal> CheckSingularity(const JointPath& path, size_t loop, int way_point) {
  const JointVector& q = path.At(loop, way_point);
  Refusal refusal;
  refusal.limit = "distance of the " + SingularPart(q) + " from a singularity";
  refusal.value = SingularityDistance(q);
  refusal.bound = kMinSingularityDistance;
  refusal.unit = "m/rad";
  refusal.remedy = kAwayFromSingularity;
  if (refusal.value >= refusal.bound) return std::nullopt;
  return refusal;
}

// A step of the joints that is too long has its reason where its ends are nearly singular.
void NameSingularity(const JointVector& q, Refusal* step) {
  constexpr double kNear = 3.0 * kMinSingularityDistance;
  if (SingularityDistance(q) >= kNear || step->remedy == kAwayFromSingularity) return;
  step->limit += ", near a singular " + SingularPart(q);
  step->remedy = kAwayFromSingularity;
}

// At a way-point, and on the way to it.
std::optional<Refusal> CheckLimitsAndSteps(const JointPath& path, const LoopJointSpline& spline,
                                           const JointRange& range, size_t loop, int way_point) {
  std::optional<Refusal> refusal = CheckJoints(path, range, loop, way_point);
  if (refusal && refusal->bound == kMaxJointStep) {
    for (const int end : {way_point, way_point - 1}) NameSingularity(path.At(loop, end), &*refusal);
  }
  return refusal ? refusal : CheckRange(spline.RangeOnTheWayTo(way_point), range);
}

// Where no path gets along: of all ways to stand there within the limits, and where it comes from,
// the farthest from a singularity.
Refusal WithReason(const JointChoices& choices, const JointRange& range, Refusal gap) {
  if (gap.bound != kMaxJointStep) return gap;
  for (const int way_point : {gap.way_point, gap.way_point - 1}) {
    double distance = -1.0;
    const JointVector* farthest = nullptr;
    for (const JointVector& q : choices.At(static_cast<size_t>(gap.loop), way_point)) {
      if (JointLimitExcess(q, range) > 0.0 || SingularityDistance(q) <= distance) continue;
      distance = SingularityDistance(q);
      farthest = &q;
    }
    if (farthest != nullptr) NameSingularity(*farthest, &gap);
  }
  return gap;
}

// Refines candidates and keeps the quickest that fits and the one with the fewest way-points that
// do not.
class Selection {
 public:
  Selection(const Motion& motion, const PosePath& poses, const Rig& rig)
      : motion_(motion),
        poses_(poses),
        limits_(rig.arm_limits),
        range_(RangeOf(rig.arm_limits)),
        clearance_(rig) {}

  void Try(const JointPath& candidate, const JointPathCosts& costs, size_t first_cost) {
    JointPath path = Refined(poses_, candidate, costs, first_cost);
    const size_t num_loops = motion_.loops.size();
    const std::vector<LoopJointSpline> splines = SplinesThrough(path);
    std::optional<Refusal> refusal = CheckWayPoints(num_loops, [&](size_t loop, int i) {
      return CheckLimitsAndSteps(path, splines[loop], range_, loop, i);
    });
    if (!refusal) {
      // Only of a path that the joints can go.
      refusal = CheckWayPoints(num_loops, [&](size_t loop, int i) {
        std::optional<Refusal> at_way_point =
            CheckLastJointTurn(splines[loop], path.start, 6, limits_, i);
        if (!at_way_point) at_way_point = CheckSingularity(path, loop, i);
        return at_way_point ? at_way_point
                            : CheckClearance(splines[loop], clearance_, limits_.clearance_m, i);
      });
      joints_fit_ = true;
    }
    if (!refusal) {
      TimedMotion timed = TimedAlong(motion_, path, Limits());
      if (!quickest_ || timed.duration_s() < quickest_->duration_s()) quickest_ = std::move(timed);
    } else if (!fewest_bad_ || refusal->num_bad_way_points < fewest_bad_->num_bad_way_points) {
      fewest_bad_ = std::move(refusal);
      fewest_bad_path_ = std::move(path);
    }
  }

  const std::optional<TimedMotion>& quickest() const { return quickest_; }
  // Whether some candidate kept all joint limits, so that only where it led was wrong.
  bool joints_fit() const { return joints_fit_; }
  const ClearanceCheck& clearance() const { return clearance_; }
  // @pre no candidate fits
  const Refusal& fewest_bad() const { return *fewest_bad_; }
  // For the way-points alone that would be bad on any path. @pre no candidate fits
  std::optional<Refusal> BadOnAnyPath() const {
    return CheckWayPoints(motion_.loops.size(), [&](size_t loop, int i) {
      std::optional<Refusal> refusal = CheckJoints(fewest_bad_path_, range_, loop, i);
      if (refusal && !LiesBeyondLimits(poses_.At(loop, i), range_)) refusal.reset();
      return refusal;
    });
  }

 private:
  const Motion& motion_;
  const PosePath& poses_;
  const ArmLimits& limits_;
  JointRange range_;
  ClearanceCheck clearance_;
  std::optional<TimedMotion> quickest_;
  bool joints_fit_ = false;
  std::optional<Refusal> fewest_bad_;
  JointPath fewest_bad_path_;
};

}  // namespace

std::variant<TimedMotion, Refusal> PlanOnArm(const Motion& motion, const Rig& rig) {
  const PosePath poses = PosesAlong(motion);
  const size_t num_loops = motion.loops.size();
  const JointRange range = RangeOf(rig.arm_limits);
  const JointChoices choices = JointChoicesAlong(poses, range);
  const auto check_pose = [&](size_t loop, int way_point) -> std::optional<Refusal> {
    const Rigid3& T_b_e = poses.At(loop, way_point);
    if (choices.At(loop, way_point).empty()) return OutOfReach(T_b_e);
    return CheckBoardInView(T_b_e, rig);
  };
  if (std::optional<Refusal> refusal = CheckWayPoints(num_loops, check_pose)) return *refusal;

  Selection selection(motion, poses, rig);
  const auto try_paths = [&](const JointChoices& from, const JointPathCosts& costs,
                             size_t first_cost) {
    std::variant<std::vector<JointPath>, Refusal> search =
        SearchJointPaths(from, costs[first_cost]);
    if (auto* refusal = std::get_if<Refusal>(&search)) {
      refusal->num_way_points = kNumWayPoints * static_cast<int>(num_loops);
      return std::optional(*std::move(refusal));
    }
    for (const JointPath& path : std::get<std::vector<JointPath>>(search)) {
      selection.Try(path, costs, first_cost);
    }
    return std::optional<Refusal>();
  };
  const JointPathCosts costs = PathCosts(range);
  if (const std::optional<Refusal> gap = try_paths(choices, costs, 0)) {
    return WithReason(choices, range, *gap);
  }
  if (selection.quickest()) return *selection.quickest();
  if (selection.joints_fit()) {
    const JointPathCosts careful =
        CarefulPathCosts(range, selection.clearance(), rig.arm_limits.clearance_m);
    (void)try_paths(choices, careful, 0);
  } else {
    if (const std::optional<Refusal> refusal = selection.BadOnAnyPath()) return *refusal;
    // Every way-point alone can be reached. A soft wall on a coarse grid may have led astray.
    (void)try_paths(FinerWhereTight(poses, choices, range), costs, 1);
  }
  if (selection.quickest()) return *selection.quickest();
  return selection.fewest_bad();
}

}  // namespace calibrato
