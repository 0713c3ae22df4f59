#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>

#include "calibrato/geometry/rigid3.h"
#include "calibrato/sensors/board.h"
#include "calibrato/sensors/camera_model.h"
#include "calibrato/sensors/measurements.h"

// Frames that have not been taken: what they would say, from the pose alone.

namespace calibrato {

/// All points of a board, with no pixels measured: what a frame that sees it whole will report.
[[nodiscard]] BoardView PlannedView(const Board& board);

/// What a frame would say about the camera's parameters, its pose being unknown,
///
///     J'J - J'P (P'P)^-1 P'J,   J = d pixels / d parameters, P = d pixels / d pose,
///
/// for corner noise of 1 px: divide by the noise's variance [px^2]. Additive over frames. Nothing
/// where a point does not project or the points do not determine the pose.
[[nodiscard]] std::optional<Eigen::MatrixXd> CameraInformationOfFrame(const CameraModel& model,
                                                                      const BoardView& points,
                                                                      const Rigid3& T_c_g);

/// What a frame would say about its pose [dtheta, dt] with a known camera, P'P, for corner noise of
/// 1 px. Nothing where a point does not project.
[[nodiscard]] std::optional<Eigen::Matrix<double, 6, 6>> PoseInformationOfFrame(
    const CameraModel& model, const BoardView& points, const Rigid3& T_c_g);

/// What a frame would say about its pose and the camera's parameters together, [P J]'[P J] in this
/// order, for corner noise of 1 px. Nothing where a point does not project.
[[nodiscard]] std::optional<Eigen::MatrixXd> JointInformationOfFrame(const CameraModel& model,
                                                                     const BoardView& points,
                                                                     const Rigid3& T_c_g);

/// How far inside the image its outermost point is [px], as FramesThatCount measures: 0 at the
/// centres of the outermost pixels, negative outside. Minus infinity where a point does not
/// project.
[[nodiscard]] double MarginInImage(const CameraModel& model, Resolution resolution,
                                   const BoardView& points, const Rigid3& T_c_g);

/// The derivative of a number by a pose's perturbation [dtheta, dt], by central differences of 1e-5
/// rad and m (relative errors of about 1e-9 for what varies over tenths). Zero where a neighbouring
/// pose has no value.
using NumberOfPose = std::function<std::optional<double>(const Rigid3&)>;
[[nodiscard]] Eigen::Matrix<double, 6, 1> GradientByPose(const NumberOfPose& number,
                                                         const Rigid3& T_c_g);

}  // namespace calibrato
