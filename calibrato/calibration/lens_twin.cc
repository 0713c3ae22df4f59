#include "calibrato/calibration/lens_twin.h"

#include <cmath>

#include "calibrato/calibration/bundle_adjustment.h"
#include "calibrato/calibration/view_fit.h"

namespace calibrato {
namespace {

constexpr int kColumns = 16;
constexpr int kRows = 12;

}  // namespace

double CentralFocalLength(const CameraModel& lens) {
  constexpr double kAngle = 1e-3;  // [rad]
  const auto pixel = lens.Project({std::sin(kAngle), 0.0, std::cos(kAngle)});
  const auto middle = lens.Project({0.0, 0.0, 1.0});
  return pixel && middle ? (*pixel - *middle).norm() / kAngle : lens.focal_and_centre()(0);
}

std::optional<CameraModel> FindLensTwin(const CameraModel& lens, Resolution resolution,
                                        const CameraModel& start, const std::vector<bool>& fixed) {
  BoardView rays;
  rays.points_g.resize(3, kColumns * kRows);
  rays.pixels.resize(2, kColumns * kRows);
  Eigen::Index n = 0;
  for (int k = 0; k < kColumns * kRows; ++k) {
    const Eigen::Vector2d pixel((k % kColumns + 0.5) * resolution.width / kColumns,
                                (k / kColumns + 0.5) * resolution.height / kRows);
    const auto ray = lens.Unproject(pixel);
    if (!ray || !start.Project(*ray)) continue;
    rays.points_g.col(n) = ray->normalized();
    rays.pixels.col(n) = pixel;
    ++n;
  }
  if (2 * n < kColumns * kRows) return std::nullopt;
  rays.points_g.conservativeResize(Eigen::NoChange, n);
  rays.pixels.conservativeResize(Eigen::NoChange, n);
  const std::vector<BoardView> views = {rays};
  BundleAdjustmentOptions options;
  options.max_iterations = 60;
  options.cost_tolerance = 1e-6;
  // Left free, the shape would often flow to that of the lens itself.
  options.fixed_parameters = {fixed};
  options.fixed_parameters[0].resize(static_cast<size_t>(start.num_parameters()), false);
  options.fixed_parameters[0][0] = true;
  const CameraModel twin =
      AdjustBundle({{start}, {}, {Rigid3()}, {}}, ViewsOfOneCamera(views), options)
          .state.models.front();
  const Eigen::VectorXd parameters = lens.parameters();
  if ((twin.parameters() - parameters).norm() < 1e-2 * parameters.norm()) return std::nullopt;
  return twin;
}

}  // namespace calibrato
