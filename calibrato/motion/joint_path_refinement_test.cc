#include "calibrato/motion/joint_path_refinement.h"

#include <gtest/gtest.h>

#include <numbers>

#include "calibrato/motion/joint_path_search.h"
#include "calibrato/motion/motion.h"
#include "calibrato/motion/singularity.h"

namespace calibrato {
namespace {

PosePath ExtrinsicHandcraftedPoses() {
  const Motion motion = HandcraftedMotion(Task::kExtrinsic);
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

double Cost(const JointPath& path, const JointPathCost& path_cost) {
  double cost = path_cost.Wall(path.start);
  for (size_t loop = 0; loop < path.loops.size(); ++loop) {
    for (int i = 1; i <= kNumWayPoints; ++i) {
      cost += JointPathCost::Step(path.At(loop, i) - path.At(loop, i - 1));
      if (i < kNumWayPoints) cost += path_cost.Wall(path.At(loop, i));
    }
  }
  return cost;
}

TEST(RefineJointPath, LowersTheCostToALocalMinimumAndKeepsThePoses) {
  const PosePath poses = ExtrinsicHandcraftedPoses();
  const JointPathCost path_cost;
  const auto search = SearchJointPaths(JointChoicesAlong(poses), path_cost);
  const JointPath& found = std::get<std::vector<JointPath>>(search).at(0);
  const JointPath refined = RefineJointPath(poses, found, path_cost);
  const double least = Cost(refined, path_cost);
  EXPECT_LT(least, Cost(found, path_cost));
  for (size_t loop = 0; loop < poses.loops.size(); ++loop) {
    for (int i = 0; i < kNumWayPoints; ++i) {
      EXPECT_LT(PandaPose(refined.At(loop, i), nullptr).DifferenceTo(poses.At(loop, i)).norm(),
                1e-9);
    }
  }
  // Moved along its redundancy, the start or any other way-point makes the path dearer.
  const auto moved = [](const Rigid3& T_b_e, const JointVector& q, double step) {
    JointJacobian J;
    (void)PandaPose(q, &J);
    return PandaInverseNear(T_b_e, q + step * PandaNullDirection(J)).value();
  };
  for (const double step : {-0.1, 0.1}) {
    JointPath other = refined;
    other.start = moved(poses.start, refined.start, step);
    EXPECT_GT(Cost(other, path_cost), least);
    for (const int i : {0, 20, 60}) {
      other = refined;
      other.loops[1][i] = moved(poses.loops[1][i], refined.loops[1][i], step);
      EXPECT_GT(Cost(other, path_cost), least);
    }
  }
}

TEST(RefineJointPath, LeadsOutOfAWallWhereThereIsRoom) {
  // All way-points stand still, in a wall of the last joint that the redundancy can leave.
  const Rigid3 base = LoopPoseAt(BasePose(), LoopCoefficients::Zero(), 0.0);
  std::optional<JointVector> inside;
  for (const JointVector& q : PandaInverse(base, 1.0)) {
    if (JointLimitExcess(q) < -0.2) inside = q;
  }
  ASSERT_TRUE(inside.has_value());
  PosePath poses;
  poses.start = base;
  poses.loops.emplace_back().fill(base);
  JointPath path;
  path.start = *inside;
  path.loops.emplace_back().fill(*inside);
  // A wall so thick that the path stands in it.
  const JointPathCost path_cost{.margin = -JointLimitExcess(*inside) + 0.05, .weight = 100.0};
  const JointPath refined = RefineJointPath(poses, path, path_cost);
  EXPECT_LT(path_cost.Wall(refined.start), 0.5 * path_cost.Wall(*inside));
}

TEST(RefineJointPath, LeadsAwayFromASingularity) {
  // All way-points stand near a singular shoulder; the redundancy turns the elbow out of it.
  JointVector near;
  near << 0.2, 0.03, 0.5 * std::numbers::pi, -2.0, 0.3, 1.8, 0.7;
  ASSERT_LT(SingularityDistance(near), 0.5 * kMinSingularityDistance);
  PosePath poses;
  poses.start = PandaPose(near, nullptr);
  poses.loops.emplace_back().fill(poses.start);
  JointPath path;
  path.start = near;
  path.loops.emplace_back().fill(near);
  JointPathCost path_cost;
  path_cost.kept_distances = {{SingularityDistance, 2.0 * kMinSingularityDistance, 1e4}};
  const JointPath refined = RefineJointPath(poses, path, path_cost);
  for (int i = 0; i < kNumWayPoints; ++i) {
    EXPECT_GT(SingularityDistance(refined.At(0, i)), kMinSingularityDistance);
    EXPECT_LT(PandaPose(refined.At(0, i), nullptr).DifferenceTo(poses.start).norm(), 1e-9);
  }
}

}  // namespace
}  // namespace calibrato
