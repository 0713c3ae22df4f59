// A lens, found again from corners that it was seen through: the library from outside.

#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>
#include <string>

#include "calibrato/base/rng.h"
#include "calibrato/calibration/camera_calibration.h"
#include "calibrato/geometry/so3.h"
#include "calibrato/sensors/board.h"

int main() {
  using calibrato::CameraModel;
  const Eigen::Vector4d truth(500.0, 501.0, 320.0, 240.0);
  const CameraModel lens("pinhole-none", truth);
  const calibrato::Board board = calibrato::Checkerboard{6, 7, 0.05, 0.05};
  const Eigen::Matrix3Xd points = BoardPoints(board);
  const Eigen::Vector3d centre = BoardCentre(board);
  calibrato::Rng rng(1);

  calibrato::CameraProblem problem;
  problem.model = "pinhole-none";
  problem.resolution = {640, 480};
  while (problem.views.size() < 20) {
    const Eigen::Vector3d turn(rng.Uniform(-0.5, 0.5), rng.Uniform(-0.5, 0.5),
                               rng.Uniform(-0.5, 0.5));
    const Eigen::Vector3d place(rng.Uniform(-0.15, 0.15), rng.Uniform(-0.1, 0.1),
                                rng.Uniform(0.5, 0.9));
    calibrato::BoardView view;
    view.name = std::to_string(problem.views.size());
    view.points_g = points;
    view.pixels.resize(2, points.cols());
    bool is_seen = true;
    for (Eigen::Index k = 0; k < points.cols(); ++k) {
      const auto pixel = lens.Project(calibrato::ExpSo3(turn) * (points.col(k) - centre) + place);
      is_seen = is_seen && pixel && pixel->x() > 0.0 && pixel->x() < 639.0 && pixel->y() > 0.0 &&
                pixel->y() < 479.0;
      if (!is_seen) break;
      const double u_noise = rng.Normal();
      view.pixels.col(k) = *pixel + 0.1 * Eigen::Vector2d(u_noise, rng.Normal());
      view.corner_ids.push_back(static_cast<int>(k));
    }
    if (is_seen) problem.views.push_back(view);
  }

  const calibrato::CameraCalibration found = CalibrateCamera(problem);
  if (!found.model) return 1;
  const Eigen::VectorXd error = found.model->parameters() - truth;
  for (Eigen::Index k = 0; k < error.size(); ++k) {
    const double sigma = std::sqrt(found.covariance(k, k));
    std::printf("%.3f +- %.3f\n", found.model->parameters()(k), sigma);
    if (!(std::abs(error(k)) < 5.0 * sigma)) return 1;
  }
  return 0;
}
