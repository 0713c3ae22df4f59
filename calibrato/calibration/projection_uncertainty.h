#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calibrato/calibration/bundle_adjustment.h"
#include "calibrato/calibration/camera_rig_calibration.h"
#include "calibrato/calibration/image_map.h"

// How many pixels is a point off? The covariance of the parameters alone does not answer: a shift
// of the principal point, say, is nearly the same as a turn of the camera, and whoever uses the
// camera will find its pose with the same wrong parameters. So the question is asked of a point
// that is fixed to the camera's housing, of which the calibration knows only through the boards
// that it saw. Derivation: docs/projection-uncertainty.md; the quantity is mrcal's ("mean-pcam").

namespace calibrato {

/// What a calibration knows of one camera in its housing.
///
/// The boards stood still while the lens was found, so they say where the housing is: with other
/// noise the parameters would be other ones, and the frames' poses with them. A point of the
/// housing that was at p_c would then be at p_c + dtheta x p_c + dt, the mean over the camera's
/// frames of where each board says it is.
///
/// Joint covariance of [parameters n, dtheta 3, dt 3], (n+6) x (n+6).
struct HousedCamera {
  CameraModel model;
  Eigen::MatrixXd covariance;
};

/// @param camera             Which of the state's.
/// @param options            With the noise of each camera's corners.
/// @param border_covariance  In the order of BorderLayout, scaled by the noise.
/// @pre the camera has a view
[[nodiscard]] HousedCamera HouseCamera(int camera, const BundleAdjustmentState& state,
                                       const std::vector<BundleView>& views,
                                       const BundleAdjustmentOptions& options,
                                       const Eigen::MatrixXd& border_covariance);

/// Every camera of a calibrated rig; nothing for those without a covariance. Cameras that are
/// related to the one before or after them are taken together with those; any other as if it were
/// alone.
[[nodiscard]] std::vector<std::optional<HousedCamera>> HouseCameras(
    const CameraRigProblem& problem, const CameraRigCalibration& calibration);

/// Covariance [px^2] of the pixel at which a point of the housing is seen. Nothing where it does
/// not project.
/// @param p_c  In the camera's frame [m].
[[nodiscard]] std::optional<Eigen::Matrix2d> PixelCovariance(const HousedCamera& camera,
                                                             const Eigen::Vector3d& p_c);

/// The same for a point at infinity in direction `ray_c` of any length.
[[nodiscard]] std::optional<Eigen::Matrix2d> PixelCovarianceAtInfinity(
    const HousedCamera& camera, const Eigen::Vector3d& ray_c);

/// One sigma in the worst direction [px], over the image, of points at a distance from the camera
/// (along each pixel's ray).
/// @param distance_m  > 0, or infinity.
[[nodiscard]] ImageMap ProjectionUncertainty(const HousedCamera& camera, Resolution resolution,
                                             double distance_m);

}  // namespace calibrato
