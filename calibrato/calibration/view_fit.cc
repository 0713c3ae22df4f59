#include "calibrato/calibration/view_fit.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>
#include <variant>

namespace calibrato {
namespace {

template <typename Model>
bool Linearise(const Model& model, const BoardView& view, const Rigid3& T_cn_g,
               const ViewRowsOptions& options, ViewRows* result) {
  const int num_parameters = options.parameters ? Model::kNumParameters : 0;
  const int num_bending = options.shapes != nullptr ? 3 : 0;
  const Eigen::Index num_corners = view.num_corners();
  Eigen::MatrixXd& rows = result->rows;
  rows.resize(2 * num_corners, 6 + num_parameters + num_bending + 1);
  result->cost_px2 = 0.0;
  Eigen::Vector2d pixel;
  typename Model::JacobianPoint J_point;
  typename Model::JacobianParameters J_parameters;
  for (Eigen::Index k = 0; k < num_corners; ++k) {
    Eigen::Vector3d point_g = view.points_g.col(k);
    Eigen::Vector3d shapes;
    if (num_bending != 0) {
      shapes = options.shapes->At(point_g);
      point_g.z() += shapes.dot(options.bending.coefficients);
    }
    const Eigen::Vector3d turned = T_cn_g.R * point_g;
    if (!model.Project(turned + T_cn_g.t, &pixel, &J_point,
                       options.parameters ? &J_parameters : nullptr)) {
      return false;
    }
    const Eigen::Vector2d residual = pixel - view.pixels.col(k);
    double weight = 1.0;
    const double squared_error = residual.squaredNorm();
    if (options.loss_scale_px > 0.0) {
      const double squared_scale = options.loss_scale_px * options.loss_scale_px;
      const double ratio = squared_error / squared_scale;
      result->cost_px2 += squared_scale * std::log1p(ratio);
      weight = 1.0 / std::sqrt(1.0 + ratio);
    } else {
      result->cost_px2 += squared_error;
    }
    for (int axis = 0; axis < 2; ++axis) {
      const Eigen::Index row = 2 * k + axis;
      const double a = J_point(axis, 0), b = J_point(axis, 1), c = J_point(axis, 2);
      // -J [turned]x, written out.
      rows(row, 0) = weight * (turned.y() * c - turned.z() * b);
      rows(row, 1) = weight * (turned.z() * a - turned.x() * c);
      rows(row, 2) = weight * (turned.x() * b - turned.y() * a);
      rows(row, 3) = weight * a;
      rows(row, 4) = weight * b;
      rows(row, 5) = weight * c;
      for (int i = 0; i < num_parameters; ++i) rows(row, 6 + i) = weight * J_parameters(axis, i);
      if (num_bending != 0) {
        const double out = a * T_cn_g.R(0, 2) + b * T_cn_g.R(1, 2) + c * T_cn_g.R(2, 2);
        for (int i = 0; i < 3; ++i) rows(row, 6 + num_parameters + i) = weight * out * shapes(i);
      }
      rows(row, rows.cols() - 1) = weight * residual(axis);
    }
  }
  return true;
}

}  // namespace

bool LineariseView(const CameraModel& model, const BoardView& view, const Rigid3& T_cn_g,
                   const ViewRowsOptions& options, ViewRows* result) {
  return std::visit([&](const auto& m) { return Linearise(m, view, T_cn_g, options, result); },
                    model.variant());
}

Rigid3 RefinedPose(const CameraModel& model, const BoardView& view, const Rigid3& T_c_g_start,
                   int max_iterations, double loss_scale_px) {
  using Vector6d = Eigen::Matrix<double, 6, 1>;
  using Matrix6d = Eigen::Matrix<double, 6, 6>;
  ViewRowsOptions options;
  options.parameters = false;
  options.loss_scale_px = loss_scale_px;
  ViewRows now;
  ViewRows next;
  Rigid3 T_c_g = T_c_g_start;
  if (!LineariseView(model, view, T_c_g, options, &now)) return T_c_g;
  double damping = 1e-4;
  for (int i = 0; i < max_iterations; ++i) {
    const auto J = now.rows.leftCols<6>();
    Matrix6d A = J.transpose() * J;
    A.diagonal() *= 1.0 + damping;
    const Vector6d step = -A.ldlt().solve(Vector6d(J.transpose() * now.rows.col(6)));
    const Rigid3 next_T_c_g = T_c_g.Perturbed(step);
    if (LineariseView(model, view, next_T_c_g, options, &next) && next.cost_px2 < now.cost_px2) {
      const bool done = next.cost_px2 > (1.0 - 1e-9) * now.cost_px2;
      T_c_g = next_T_c_g;
      std::swap(now, next);
      damping *= 0.1;
      if (done) break;
    } else {
      damping *= 10.0;
      if (damping > 1e8) break;
    }
  }
  return T_c_g;
}

Eigen::Matrix2Xd ReprojectionResiduals(const CameraModel& model, const BoardView& view,
                                       const Rigid3& T_c_g) {
  Eigen::Matrix2Xd residuals(2, view.num_corners());
  for (Eigen::Index k = 0; k < view.num_corners(); ++k) {
    const auto pixel = model.Project(T_c_g * view.points_g.col(k));
    residuals.col(k) = pixel ? Eigen::Vector2d(*pixel - view.pixels.col(k))
                             : Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
  }
  return residuals;
}

}  // namespace calibrato
