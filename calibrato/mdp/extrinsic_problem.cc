#include "calibrato/mdp/extrinsic_problem.h"

#include <utility>

namespace calibrato {

CameraImuProblem ExtrinsicProblem(const Rig& rig, std::vector<BoardView> views, ImuStream imu) {
  CameraImuProblem problem;
  problem.cameras.push_back(
      {rig.cameras.front().model, std::move(views), IntrinsicsKnowledge::kExact, {}});
  problem.imus.push_back({std::move(imu), rig.imu_noise, ImuModelKind::kCalibrated});
  return problem;
}

}  // namespace calibrato
