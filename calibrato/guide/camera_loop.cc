#include "calibrato/guide/camera_loop.h"

namespace calibrato {

Rigid3 PoseAt(const CameraLoop& loop, double theta) {
  const auto camera = [&](double at) {
    return LoopPoseAt(loop.base, loop.coefficients, at) * loop.T_e_c;
  };
  return camera(0.0).Inverse() * camera(theta);
}

}  // namespace calibrato
