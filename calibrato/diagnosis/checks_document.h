#pragma once

#include <optional>

#include "calibrato/base/value.h"
#include "calibrato/calibration/image_map.h"
#include "calibrato/calibration/projection_uncertainty.h"
#include "calibrato/diagnosis/camera_diagnosis.h"

namespace calibrato {

/// {"median_px", "worst_px", "values_px": [[row], ..]}: from the first pixel to the last; null
/// where the quantity does not exist.
[[nodiscard]] Value ToValue(const ImageMap& map);

/// One sigma in the worst direction over the image, of points at the boards' median distance and at
/// infinity:
///     {"distance_m", "at_distance": map, "at_infinity": map}
/// null without a covariance.
[[nodiscard]] Value ProjectionUncertaintyValue(const std::optional<HousedCamera>& camera,
                                               const CameraCalibration& calibration,
                                               Resolution resolution);

/// What the findings rest on, null where it could not be had:
///     {"split": {"first", "second", "sigma", "probability", "in_sample_stddev_px",
///                "held_out_stddev_px", "expected_held_out_stddev_px"},
///      "residual_field": {"mean_u_px", "mean_v_px", "num_corners", "systematic_rms_px",
///                         "neighbour_correlation", "correlation_sigma"},
///      "bending": {"coefficients_per_m": [xx, xy, yy], "depth_m", "probability"},
///      "stretch": {"stretch", "stretch_sigma", "shear_rad", "shear_sigma_rad", "probability"}}
[[nodiscard]] Value ChecksValue(const CameraDiagnosis& diagnosis);

}  // namespace calibrato
