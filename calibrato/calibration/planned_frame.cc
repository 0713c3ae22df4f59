#include "calibrato/calibration/planned_frame.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <limits>
#include <numeric>

#include "calibrato/calibration/view_fit.h"

namespace calibrato {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

BoardView PlannedView(const Board& board) {
  BoardView view;
  view.points_g = BoardPoints(board);
  view.pixels = Eigen::Matrix2Xd::Zero(2, view.points_g.cols());
  view.corner_ids.resize(static_cast<size_t>(view.points_g.cols()));
  std::iota(view.corner_ids.begin(), view.corner_ids.end(), 0);
  return view;
}

std::optional<Eigen::MatrixXd> CameraInformationOfFrame(const CameraModel& model,
                                                        const BoardView& points,
                                                        const Rigid3& T_c_g) {
  ViewRows view;
  if (!LineariseView(model, points, T_c_g, {}, &view)) return std::nullopt;
  const int num_parameters = model.num_parameters();
  const auto P = view.rows.leftCols<6>();
  const auto J = view.rows.middleCols(6, num_parameters);
  const Eigen::LLT<Matrix6d> PtP(Matrix6d(P.transpose() * P));
  if (PtP.info() != Eigen::Success) return std::nullopt;
  // L^-1 P'J: its square is what the unknown pose takes away.
  Eigen::MatrixXd taken = P.transpose() * J;
  PtP.matrixL().solveInPlace(taken);
  Eigen::MatrixXd information = J.transpose() * J;
  information.noalias() -= taken.transpose() * taken;
  return information;
}

std::optional<Matrix6d> PoseInformationOfFrame(const CameraModel& model, const BoardView& points,
                                               const Rigid3& T_c_g) {
  ViewRowsOptions options;
  options.parameters = false;
  ViewRows view;
  if (!LineariseView(model, points, T_c_g, options, &view)) return std::nullopt;
  const auto P = view.rows.leftCols<6>();
  return Matrix6d(P.transpose() * P);
}

std::optional<Eigen::MatrixXd> JointInformationOfFrame(const CameraModel& model,
                                                       const BoardView& points,
                                                       const Rigid3& T_c_g) {
  ViewRows view;
  if (!LineariseView(model, points, T_c_g, {}, &view)) return std::nullopt;
  const auto rows = view.rows.leftCols(6 + model.num_parameters());
  return Eigen::MatrixXd(rows.transpose() * rows);
}

double MarginInImage(const CameraModel& model, Resolution resolution, const BoardView& points,
                     const Rigid3& T_c_g) {
  double margin = std::numeric_limits<double>::infinity();
  for (Eigen::Index k = 0; k < points.num_corners(); ++k) {
    const std::optional<Eigen::Vector2d> pixel = model.Project(T_c_g * points.points_g.col(k));
    if (!pixel) return -std::numeric_limits<double>::infinity();
    margin = std::min({margin, pixel->x(), pixel->y(), resolution.width - 1.0 - pixel->x(),
                       resolution.height - 1.0 - pixel->y()});
  }
  return margin;
}

Vector6d GradientByPose(const NumberOfPose& number, const Rigid3& T_c_g) {
  constexpr double kStep = 1e-5;
  Vector6d gradient;
  for (int k = 0; k < 6; ++k) {
    const Vector6d step = kStep * Vector6d::Unit(k);
    const std::optional<double> high = number(T_c_g.Perturbed(step));
    const std::optional<double> low = number(T_c_g.Perturbed(-step));
    if (!high || !low) return Vector6d::Zero();
    gradient(k) = (*high - *low) / (2.0 * kStep);
  }
  return gradient;
}

}  // namespace calibrato
