#pragma once

#include <string>
#include <vector>

#include "calibrato/base/value.h"

namespace calibrato {

/// One HTML page from result documents, in their order: the verdict first, then tables and
/// interactive plots. The page holds all it needs (plotly included, once) and asks for nothing from
/// anywhere. It computes nothing: every number comes in.
///
/// A document is an object with a "kind": the content of a result.json, and what is to be drawn.
/// Every other member is optional; what is missing or null is said in words. Long lists are best
/// rounded by whoever makes them: the page takes each number as long as it comes.
///
/// "camera": camera result.json with, for each camera, "projection_uncertainty" and "checks"
/// (diagnosis/checks_document.h) and "rejected" (docs/formats.md); and "plots" of camera 0,
/// "plots_cam1" of camera 1 ..:
///     {"resolution": [width, height],      [px]
///      "noise_stddev_px",
///      "views": [{"name", "rms_px", "pixels": [[u, v]..], "residuals": [[du, dv]..],
///                 "T_c_g": four rows of four}..],
///      "board_points_g": [[x, y, z]..],    [m]
///      "images_without_board": [name..],
///      "rejected_corners": [{"view", "pixel": [u, v], "residual": [du, dv]}..],
///      "distortion_curve": {"radius_px": [..], "shift_px": [..]},
///      "lens_curve": {"angle_rad": [..], "radius_px": [..]},   drawn instead beyond 1 rad
///      "straightened_view": {"name", "pixels": [[u, v]..], "straightened": [[u, v]..],
///                            "lines": [[indices]..]}, or with "image" and "straightened_image",
///                            data URIs, instead of the three}
///
/// "camera-imu": camera-imu result.json, and "plots" (diagnosis/camera_imu_plots.h).
///
/// "check": check result.json, and "plots" (diagnosis/check_document.h).
///
/// "diff": as `calibrato diff` prints it (diagnosis/comparison_document.h).
///
/// "noise": as `calibrato noise` prints it (diagnosis/noise_document.h).
///
/// "dry-run": what `calibrato export` prints of a motion, and
///     {"joints": evaluation/joint_drawing.h, "motion": one of the motions below,
///      "board_outline_b"}
///
/// "learn": learn result.json, and "training": the lines of training.jsonl, and "motion": one of
/// the motions below, or an array of them; it may carry a "board_outline_b" of its own.
///
/// "table1": evaluate's result.json, and "plots":
///     {"errors": [{"policy", "relative_error": [one a rig]}..],
///      "motions": [{"policy", "path_length_m", "motion_s",
///                   "loops": [[[x, y, z]..]..],  the camera in frame b, a polyline a loop [m]
///                   "xyz_b": [[x, y, z]..],      instead of loops
///                   "axis_b": [..],              optical axes, see below
///                   "played": {..}}..],          evaluation/motion_drawing.h
///      "coverage": [{"policy", "pixels": [[u, v]..]}..],
///      "resolution": [width, height],
///      "board_outline_b": [[x, y, z] four times]}
/// where errors, motions and coverage may carry the task, carrier and fidelity of their rows. An
/// optical axis is [x, y, z, dx, dy, dz], a point and a unit vector; or [dx, dy, dz], and then the
/// axes belong to points spread evenly along the whole motion.
///
/// "table6": the same.
///
/// "figure4", "figure5", "figure7", "pareto", "rivals": evaluate's result.json, and "plots":
///     {"columns": [{"key", "name", "unit", "interval_key"}..],    of the rows
///      "charts": [evaluation/chart.h ..]}
///
/// "evaluation": nothing but its kind; what `evaluate all` made follows it.
///
/// A document of any other kind is named, and its numbers are listed as they came.
///
/// @throws InputError if a document is not an object with a text "kind".
[[nodiscard]] std::string ReportHtml(const std::string& title, const std::vector<Value>& documents);

}  // namespace calibrato
