#include "calibrato/mdp/design_setting.h"

#include <string>
#include <utility>
#include <variant>

#include "calibrato/mdp/frames_that_count.h"
#include "calibrato/motion/paper_scene.h"

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

std::vector<Rig> BelievedRigs(RigDistribution distribution, int num_draws, const Rng& rng) {
  std::vector<Rig> rigs = {AsEstimated(PaperRig())};
  for (int i = 0; i < num_draws; ++i) {
    Rng draw = rng.Stream("believed rig", static_cast<uint64_t>(i));
    rigs.push_back(AsEstimated(DrawRig(distribution, draw)));
  }
  return rigs;
}

MotionBudget BudgetOf(const Motion& motion, const Rig& rig) {
  auto planned = PlanMotion(motion, rig);
  const TimedMotion timed = std::holds_alternative<TimedMotion>(planned)
                                ? std::get<TimedMotion>(std::move(planned))
                                : PlanScaledToFit(motion, rig);
  return {PathLength(timed.motion), timed.duration_s()};
}

}  // namespace calibrato
