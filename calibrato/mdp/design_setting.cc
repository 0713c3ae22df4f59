#include "calibrato/mdp/design_setting.h"

#include <string>
#include <utility>

#include "calibrato/mdp/frames_that_count.h"

namespace calibrato {

Rig AsEstimated(Rig rig) {
  CameraModel& model = rig.cameras.front().model;
  const std::string name = IntrinsicTaskModel(model);
  if (name == model.name()) return rig;
  // Pinholes' parameters begin alike: fu fv pu pv, k1 k2 p1 p2.
  Eigen::VectorXd parameters = Eigen::VectorXd::Zero(9);
  parameters.head(model.num_parameters()) = model.parameters();
  model = CameraModel(name, parameters);
  return rig;
}

std::vector<Rig> BelievedRigs(RigDistribution distribution, int num_draws, const Rng& rng,
                              const Rig& nominal) {
  std::vector<Rig> rigs = {AsEstimated(nominal)};
  const Eigen::Vector3d middle_w = rigs.front().T_w_g * BoardCentre(rigs.front().board);
  for (int i = 0; i < num_draws; ++i) {
    Rng draw = rng.Stream("believed rig", static_cast<uint64_t>(i));
    Rig rig = AsEstimated(DrawRig(distribution, draw));
    rig.T_e_c0 = rigs.front().T_e_c0;
    rig.T_w_g.t = middle_w - rig.T_w_g.R * BoardCentre(rig.board);
    rigs.push_back(std::move(rig));
  }
  return rigs;
}

TimedMotion BeforeBoard(const TimedMotion& motion, const Rig& rig) {
  Motion moved = motion.motion;
  moved.base_pose = BasePoseBeforeBoard(rig, moved.base_pose);
  TimedMotion timed = PlanScaledToFit(moved, rig);
  timed.scale *= motion.scale;
  return timed;
}

MotionBudget BudgetOf(const Motion& motion, const Rig& rig) {
  const TimedMotion timed = PlanScaledToFit(motion, rig);
  return {PathLength(timed.motion), timed.duration_s()};
}

}  // namespace calibrato
