#pragma once

#include <string>
#include <vector>

#include "calibrato/base/rng.h"
#include "calibrato/calibration/camera_rig_calibration.h"
#include "calibrato/calibration/synthetic_views_for_test.h"

namespace calibrato {

/// Cameras that look at one board at the same instants.
struct SyntheticRig {
  std::vector<CameraModel> models;
  std::vector<Rigid3> T_cn_cnm1;
  Resolution resolution{640, 480};
};

/// Frames from the poses of SyntheticViews for camera 0; a camera's view is left out where a corner
/// lies outside its image. Frame k has the number k.
inline CameraRigProblem MakeRigProblem(const SyntheticRig& rig, const Board& board, int num_frames,
                                       double noise_stddev_px, Rng& rng) {
  CameraRigProblem problem;
  problem.cameras.resize(rig.models.size());
  problem.frame_of_view.resize(rig.models.size());
  const Eigen::Matrix3Xd points = BoardPoints(board);
  const Eigen::Vector3d centre = BoardCentre(board);
  for (int frame = 0; frame < num_frames; ++frame) {
    const Eigen::Vector3d tilt(rng.Uniform(-0.6, 0.6), rng.Uniform(-0.6, 0.6),
                               rng.Uniform(-0.6, 0.6));
    const Eigen::Matrix3d R = ExpSo3(tilt) * ExpSo3({3.14159265, 0.0, 0.0});
    const Eigen::Vector3d middle(rng.Uniform(-0.35, 0.35), rng.Uniform(-0.25, 0.25),
                                 rng.Uniform(0.7, 1.3));
    Rigid3 T_cn_g{R, middle - R * centre};
    for (size_t c = 0; c < rig.models.size(); ++c) {
      if (c > 0) T_cn_g = rig.T_cn_cnm1[c - 1] * T_cn_g;
      CameraProblem& camera = problem.cameras[c];
      camera.model = rig.models[c].name();
      camera.resolution = rig.resolution;
      BoardView view;
      view.name = std::to_string(frame);
      view.points_g = points;
      view.pixels.resize(2, points.cols());
      bool inside = true;
      for (Eigen::Index k = 0; k < points.cols() && inside; ++k) {
        const auto pixel = rig.models[c].Project(T_cn_g * points.col(k));
        inside = pixel && pixel->minCoeff() > 0.0 && pixel->x() < rig.resolution.width - 1 &&
                 pixel->y() < rig.resolution.height - 1;
        if (!inside) break;
        view.corner_ids.push_back(static_cast<int>(k));
        view.pixels.col(k) = *pixel + noise_stddev_px * Eigen::Vector2d(rng.Normal(), rng.Normal());
      }
      if (!inside) continue;
      camera.views.push_back(std::move(view));
      problem.frame_of_view[c].push_back(frame);
    }
  }
  return problem;
}

}  // namespace calibrato
