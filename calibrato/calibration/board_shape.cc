#include "calibrato/calibration/board_shape.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <functional>
#include <vector>

#include "calibrato/calibration/information.h"
#include "calibrato/calibration/view_fit.h"

namespace calibrato {
namespace {

// What a shape's unknowns do to a point of the board: 3 x m.
using Displacements = std::function<Eigen::Matrix3Xd(const Eigen::Vector3d& point_g)>;

struct ShapeStep {
  Eigen::VectorXd shape;
  Eigen::MatrixXd covariance;
  double noise_stddev_px = 0.0;
};

// The normal equations of [parameters n | shape m | residual 1] with each view's pose eliminated.
std::optional<Eigen::MatrixXd> ReducedNormal(const CameraCalibration& calibration,
                                             Eigen::Index num_shape,
                                             const Displacements& displacements) {
  const CameraModel& model = *calibration.model;
  const Eigen::Index n = model.num_parameters();
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(n + num_shape + 1, n + num_shape + 1);
  ViewRows linearised;
  for (size_t v = 0; v < calibration.used_views.size(); ++v) {
    const BoardView& view = calibration.used_views[v];
    const Rigid3& T_c_g = calibration.T_c_g[v];
    if (!LineariseView(model, view, T_c_g, {}, &linearised)) return std::nullopt;
    const Eigen::MatrixXd& rows = linearised.rows;
    const auto pose = rows.leftCols<6>();
    Eigen::MatrixXd rest(rows.rows(), sum.cols());
    rest.leftCols(n) = rows.middleCols(6, n);
    for (Eigen::Index k = 0; k < view.num_corners(); ++k) {
      // A shift of the point turns into one in the camera, where the pose's shift has its columns.
      rest.block(2 * k, n, 2, num_shape) = rows.block<2, 3>(2 * k, 3) * T_c_g.R *
                                           displacements(Eigen::Vector3d(view.points_g.col(k)));
    }
    rest.rightCols<1>() = rows.rightCols<1>();
    const Eigen::Matrix<double, 6, 6> A = pose.transpose() * pose;
    const Eigen::MatrixXd B = pose.transpose() * rest;
    sum += rest.transpose() * rest - B.transpose() * A.ldlt().solve(B);
  }
  return sum;
}

std::optional<ShapeStep> StepTo(const CameraCalibration& calibration, std::vector<bool> fixed,
                                Eigen::Index num_shape, const Displacements& displacements) {
  if (!calibration.model || calibration.covariance.size() == 0) return std::nullopt;
  const auto normal = ReducedNormal(calibration, num_shape, displacements);
  if (!normal) return std::nullopt;
  const Eigen::Index n = calibration.model->num_parameters();
  fixed.resize(static_cast<size_t>(n + num_shape), false);
  const auto covariance =
      CovarianceFromInformation(normal->topLeftCorner(n + num_shape, n + num_shape), fixed);
  if (!covariance) return std::nullopt;
  const Eigen::VectorXd gradient = normal->topRightCorner(n + num_shape, 1);
  const double squared_error = (*normal)(n + num_shape, n + num_shape);
  const double decrease = gradient.dot(*covariance * gradient);

  double num_free = 0.0;
  for (const bool held : fixed) num_free += held ? 0.0 : 1.0;
  const double degrees = 2.0 * calibration.num_corners - num_free -
                         6.0 * static_cast<double>(calibration.used_views.size());
  const double variance = (squared_error - decrease) / degrees;
  if (!(degrees > 0.0) || !(variance > 0.0)) return std::nullopt;
  ShapeStep step;
  step.shape = -(*covariance * gradient).tail(num_shape);
  step.noise_stddev_px = std::sqrt(variance);
  step.covariance = variance * covariance->bottomRightCorner(num_shape, num_shape);
  return step;
}

constexpr Eigen::Index kNumBending = 3;
constexpr Eigen::Index kNumStretch = 2;

}  // namespace

std::optional<BoardShape> EstimateBoardShape(const CameraCalibration& calibration,
                                             const std::vector<bool>& fixed) {
  std::vector<const BoardView*> views;
  for (const BoardView& view : calibration.used_views) views.push_back(&view);
  const BendingShapes shapes(views);
  const auto bending_only = [&](const Eigen::Vector3d& point_g) {
    Eigen::Matrix3Xd displaced = Eigen::Matrix3Xd::Zero(3, kNumBending);
    displaced.row(2) = shapes.At(point_g).transpose();
    return displaced;
  };
  const auto both = [&](const Eigen::Vector3d& point_g) {
    Eigen::Matrix3Xd displaced = Eigen::Matrix3Xd::Zero(3, kNumBending + kNumStretch);
    displaced.leftCols(kNumBending) = bending_only(point_g);
    displaced(1, kNumBending) = point_g.y();
    displaced(0, kNumBending + 1) = point_g.y();
    return displaced;
  };
  auto step = StepTo(calibration, fixed, kNumBending + kNumStretch, both);
  const bool has_stretch = step.has_value();
  if (!has_stretch) step = StepTo(calibration, fixed, kNumBending, bending_only);
  if (!step) return std::nullopt;
  BoardShape shape;
  shape.noise_stddev_px = step->noise_stddev_px;
  shape.bending.bending.coefficients = step->shape.head<kNumBending>();
  shape.bending.depth_m = shapes.Depth(shape.bending.bending);
  shape.bending.significance = SignificanceOf(
      step->shape.head<kNumBending>(), step->covariance.topLeftCorner<kNumBending, kNumBending>());
  if (has_stretch) {
    const Eigen::Matrix2d covariance = step->covariance.bottomRightCorner<2, 2>();
    const Eigen::Vector2d stretch = step->shape.tail<2>();
    shape.stretch =
        BoardStretchEstimate{stretch(0), stretch(1), std::sqrt(covariance(0, 0)),
                             std::sqrt(covariance(1, 1)), SignificanceOf(stretch, covariance)};
  }
  return shape;
}

}  // namespace calibrato
