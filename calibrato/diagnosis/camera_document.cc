#include "calibrato/diagnosis/camera_document.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "calibrato/calibration/projection_uncertainty.h"
#include "calibrato/diagnosis/camera_drawings.h"
#include "calibrato/diagnosis/checks_document.h"
#include "calibrato/geometry/so3.h"
#include "calibrato/sensors/board_symmetry.h"
#include "calibrato/sensors/camera_chain.h"

namespace calibrato {
namespace {

constexpr size_t kMaxPlottedViews = 200;

// Two decimals of a pixel are enough to draw, and keep the page small.
double Rounded(double x, double step) { return std::round(x / step) * step; }

Value Pair(double a, double b) {
  Value pair = Value::Array();
  pair.Append(a).Append(b);
  return pair;
}

Value PixelPairs(const Eigen::Matrix2Xd& pixels) {
  Value pairs = Value::Array();
  for (Eigen::Index k = 0; k < pixels.cols(); ++k) {
    pairs.Append(Pair(Rounded(pixels(0, k), 1e-3), Rounded(pixels(1, k), 1e-3)));
  }
  return pairs;
}

Value SizeValue(Resolution resolution) {
  Value size = Value::Array();
  size.Append(resolution.width).Append(resolution.height);
  return size;
}

Value CoverageValue(const Coverage& coverage) {
  Value value = Value::Object();
  value.Set("x", coverage.x)
      .Set("y", coverage.y)
      .Set("size", coverage.size)
      .Set("skew", coverage.skew);
  return value;
}

Value InformationValue(const CameraCalibration& calibration) {
  if (calibration.covariance.size() == 0) return {};
  Value value = Value::Object();
  value.Set("a_optimality", calibration.information.a_optimality)
      .Set("d_optimality", calibration.information.d_optimality)
      .Set("e_optimality", calibration.information.e_optimality)
      .Set("eigenvalues", Value::Numbers(calibration.information.eigenvalues));
  return value;
}

Value DetectionRejectedValue(const RejectionCounts& counts) {
  Value value = Value::Object();
  value.Set("corners_near_border", counts.corners_near_border)
      .Set("corners_of_bad_fit", counts.corners_of_bad_fit)
      .Set("tags_not_on_board", counts.tags_not_on_board)
      .Set("tags_of_another_family", counts.tags_of_another_family)
      .Set("tags_seen_twice", counts.tags_seen_twice)
      .Set("images_with_two_boards", counts.images_with_two_boards)
      .Set("images_with_mirrored_board", counts.images_with_mirrored_board)
      .Set("images_with_other_layout", counts.images_with_other_layout);
  return value;
}

// What was left out of one camera's data, and why.
Value RejectedValue(const CameraReportCard& card, const CameraCalibration& calibration) {
  Value corners = Value::Array();
  for (const RejectedCorner& corner : calibration.rejected_corners) {
    Value entry = Value::Object();
    entry.Set("view", corner.view)
        .Set("corner_id", corner.corner_id)
        .Set("residual_px", Value::Numbers(Eigen::VectorXd(corner.residual)));
    corners.Append(std::move(entry));
  }
  Value views = Value::Array();
  for (const RejectedView& view : calibration.rejected_views) {
    Value entry = Value::Object();
    entry.Set("name", view.name)
        .Set("reason", ViewRejectionName(view.reason))
        .Set("num_corners", view.num_corners);
    if (std::isfinite(view.rms_px)) entry.Set("rms_px", view.rms_px);
    views.Append(std::move(entry));
  }
  Value value = Value::Object();
  value.Set("num_corners", calibration.rejected_corners.size())
      .Set("corners", std::move(corners))
      .Set("views", std::move(views))
      .Set("images_without_board", card.images_without_board.size())
      .Set("detection", DetectionRejectedValue(card.detection_rejected));
  return value;
}

Value CameraValue(const CameraRigReport& report, size_t c,
                  const std::optional<HousedCamera>& housed) {
  const CameraCalibration& calibration = report.calibration.cameras[c];
  const CameraProblem& problem = report.problem.cameras[c];
  Value value = Value::Object();
  value.Set("model", problem.model).Set("resolution", SizeValue(problem.resolution));
  if (calibration.model) {
    const Eigen::VectorXd intrinsics = calibration.model->intrinsics();
    const Eigen::VectorXd distortion = calibration.model->distortion();
    value.Set("intrinsics", Value::Numbers(intrinsics))
        .Set("distortion", Value::Numbers(distortion));
    if (calibration.covariance.size() != 0) {
      const Eigen::VectorXd sigma = calibration.covariance.diagonal().cwiseSqrt();
      value.Set("intrinsics_sigma", Value::Numbers(Eigen::VectorXd(sigma.head(intrinsics.size()))))
          .Set("distortion_sigma", Value::Numbers(Eigen::VectorXd(sigma.tail(distortion.size()))));
    }
    value.Set("reprojection_rms_px", calibration.reprojection_rms_px)
        .Set("reprojection_rms_all_px", calibration.reprojection_rms_all_px)
        .Set("noise_stddev_px", calibration.noise_stddev_px);
  }
  value.Set("num_views", calibration.used_views.size()).Set("num_corners", calibration.num_corners);
  value.Set("rejected", RejectedValue(report.cameras[c], calibration));
  const bool related = c > 0 && report.calibration.T_cn_cnm1[c - 1].has_value();
  value.Set("T_cn_cnm1", related ? ToValue(*report.calibration.T_cn_cnm1[c - 1]) : Value());
  if (c > 0) {
    value.Set("num_shared_frames", report.calibration.num_shared_frames[c - 1]);
    if (const auto& earlier = report.calibration.earlier_relations[c - 1]) {
      value.Set("earlier_relation", Value::Object()
                                        .Set("camera", "cam" + std::to_string(earlier->camera))
                                        .Set("T_cn_camera", ToValue(earlier->T_cn_camera)));
    }
  }
  value.Set("termination", TerminationName(calibration.termination))
      .Set("coverage", CoverageValue(calibration.coverage))
      .Set("information", InformationValue(calibration))
      .Set("projection_uncertainty",
           ProjectionUncertaintyValue(housed, calibration, problem.resolution))
      .Set("checks", ChecksValue(report.cameras[c].diagnosis));
  return value;
}

Value CovarianceValue(const CameraRigCalibration& calibration) {
  Value names = Value::Array();
  for (const std::string& name : calibration.covariance_names) names.Append(name);
  Value matrix = Value::Array();
  for (Eigen::Index row = 0; row < calibration.covariance.rows(); ++row) {
    matrix.Append(Value::Numbers(Eigen::VectorXd(calibration.covariance.row(row))));
  }
  Value value = Value::Object();
  value.Set("names", std::move(names)).Set("matrix", std::move(matrix));
  return value;
}

Value BendingValue(const EstimatedBending& bending) {
  Value value = Value::Object();
  value.Set("coefficients_per_m", Value::Numbers(Eigen::VectorXd(bending.bending.coefficients)))
      .Set("sigma_per_m",
           Value::Numbers(Eigen::VectorXd(bending.covariance.diagonal().cwiseSqrt())))
      .Set("depth_m", bending.depth_m);
  return value;
}

// Findings of several cameras say whose they are; the worst come first.
std::vector<Finding> AllFindings(const CameraRigReport& report) {
  std::vector<Finding> all = report.findings;
  for (const CameraReportCard& card : report.cameras) {
    for (Finding finding : card.diagnosis.findings) {
      if (report.cameras.size() > 1) finding.what = card.name + ": " + finding.what;
      all.push_back(std::move(finding));
    }
  }
  std::stable_sort(all.begin(), all.end(), [](const Finding& a, const Finding& b) {
    return static_cast<int>(a.severity) > static_cast<int>(b.severity);
  });
  return all;
}

// "  from cam0: 0.10000 0.00000 0.00000 m, turned by 0.01000 rad (13 shared frames)"
std::string RelationText(const CameraRigCalibration& calibration, size_t c) {
  const std::optional<EarlierRelation>& earlier = calibration.earlier_relations[c - 1];
  const std::optional<Rigid3>& neighbour = calibration.T_cn_cnm1[c - 1];
  if (!earlier && !neighbour) return "";
  const Rigid3& T = neighbour ? *neighbour : earlier->T_cn_camera;
  std::string text = Format("  from cam%zu: %.5f %.5f %.5f m, turned by %.5f rad",
                            neighbour ? c - 1 : static_cast<size_t>(earlier->camera), T.t.x(),
                            T.t.y(), T.t.z(), LogSo3(T.R).norm());
  if (neighbour) text += Format(" (%d shared frames)", calibration.num_shared_frames[c - 1]);
  return text + "\n";
}

// "  left out: 3 corners; 1 view: left07.jpg (does not fit)"
std::string RejectedText(const CameraCalibration& calibration) {
  std::vector<std::string> parts;
  if (!calibration.rejected_corners.empty()) {
    parts.push_back(std::to_string(calibration.rejected_corners.size()) + " corners");
  }
  for (const RejectedView& view : calibration.rejected_views) {
    parts.push_back("view " + view.name + " (" + ViewRejectionName(view.reason) + ")");
  }
  if (parts.empty()) return "";
  std::string text = "  left out:";
  constexpr size_t kMaxNamed = 8;
  for (size_t i = 0; i < std::min(parts.size(), kMaxNamed); ++i) {
    text += (i == 0 ? " " : ", ") + parts[i];
  }
  if (parts.size() > kMaxNamed) {
    text += " and " + std::to_string(parts.size() - kMaxNamed) + " more views";
  }
  return text + "\n";
}

std::string Listed(const std::vector<std::string>& names) {
  std::string text;
  for (size_t i = 0; i < names.size(); ++i) {
    if (i > 0) text += i + 1 == names.size() ? " and " : ", ";
    text += names[i];
  }
  return text;
}

// A camera that is not related to the one before it. What kept one from being calibrated is said
// elsewhere.
void AddRelation(const CameraRigCalibration& calibration, size_t n,
                 std::vector<Finding>* findings) {
  if (calibration.T_cn_cnm1[n - 1] || !calibration.cameras[n].model) return;
  const std::string before = "cam" + std::to_string(n - 1);
  const std::string name = "cam" + std::to_string(n);
  const bool is_calibrated = calibration.cameras[n - 1].model.has_value();
  const std::string why =
      is_calibrated ? before + " and " + name + " share no frame in which both saw the board"
                    : before + " could not be calibrated";
  if (const std::optional<EarlierRelation>& earlier = calibration.earlier_relations[n - 1]) {
    const std::string other = "cam" + std::to_string(earlier->camera);
    findings->push_back({Severity::kInfo,
                         why + ": the place of " + name + " is given from " + other +
                             " instead (earlier_relation in result.json)",
                         ""});
    return;
  }
  findings->push_back(
      {Severity::kWarn, why + ": where " + name + " is from " + before + " is not known",
       is_calibrated ? "show the board where their images overlap; are their clocks the same?"
                     : "mend what is wrong with " + before});
}

}  // namespace

std::vector<Finding> RigFindings(const CameraRigCalibration& calibration,
                                 const std::optional<Board>& board) {
  std::vector<Finding> findings;
  for (size_t n = 1; n < calibration.cameras.size(); ++n) AddRelation(calibration, n, &findings);
  for (const std::vector<int>& group : calibration.groups_of_unknown_side) {
    std::vector<std::string> names;
    for (const int camera : group) names.push_back("cam" + std::to_string(camera));
    findings.push_back(
        {Severity::kWarn,
         "the board looks the same from several sides, and the frames that " + Listed(names) +
             " share do not tell from which each of them saw it: taken is where the cameras are "
             "turned least against each other",
         "show them the board together in several poses" +
             (board ? ", or " + SidedBoardAdvice(*board) : std::string())});
  }
  if (calibration.num_separated_views > 0) {
    findings.push_back(
        {Severity::kInfo,
         std::to_string(calibration.num_separated_views) +
             " views do not fit the other cameras' of their frame and count for their camera alone",
         "are the cameras triggered together, and rigidly mounted?"});
  }
  if (calibration.bending) {
    const EstimatedBending& bending = *calibration.bending;
    const Eigen::Vector3d& a = bending.bending.coefficients;
    // The 99.9 % point of chi-square with 3 degrees of freedom.
    if (a.dot(bending.covariance.inverse() * a) > 16.27) {
      char what[96];
      std::snprintf(what, sizeof(what),
                    "the board is not flat: %.2f mm from its lowest to its "
                    "highest point",
                    1e3 * bending.depth_m);
      findings.push_back({Severity::kWarn, what,
                          "the result allows for it; glue the board to "
                          "something flat all the same"});
    }
  }
  return findings;
}

Verdict VerdictOf(const CameraRigReport& report) { return VerdictOf(AllFindings(report)); }

Value CameraResult(const CameraRigReport& report) {
  const auto housed = HouseCameras(report.problem, report.calibration);
  Value list = Value::Array();
  Coverage least{1.0, 1.0, 1.0, 1.0};
  bool is_any = false;
  const CameraCalibration* weakest = &report.calibration.cameras.front();
  for (size_t c = 0; c < report.cameras.size(); ++c) {
    const CameraCalibration& calibration = report.calibration.cameras[c];
    list.Append(CameraValue(report, c, housed[c]));
    if (!calibration.model) continue;
    is_any = true;
    least.x = std::min(least.x, calibration.coverage.x);
    least.y = std::min(least.y, calibration.coverage.y);
    least.size = std::min(least.size, calibration.coverage.size);
    least.skew = std::min(least.skew, calibration.coverage.skew);
    if (calibration.information.a_optimality > weakest->information.a_optimality) {
      weakest = &calibration;
    }
  }
  Value result = Value::Object();
  result.Set("kind", "camera")
      .Set("termination", TerminationName(report.calibration.termination))
      .Set("verdict", VerdictName(VerdictOf(report)))
      .Set("findings", ToValue(AllFindings(report)))
      .Set("cameras", std::move(list))
      .Set("covariance", CovarianceValue(report.calibration))
      .Set("coverage", CoverageValue(is_any ? least : Coverage()))
      .Set("information", InformationValue(*weakest));
  if (report.calibration.bending) {
    result.Set("board_bending", BendingValue(*report.calibration.bending));
  }
  return result;
}

Value CameraPlots(const CameraRigReport& report, size_t camera) {
  const CameraCalibration& calibration = report.calibration.cameras[camera];
  const Resolution resolution = report.problem.cameras[camera].resolution;
  Value views = Value::Array();
  const size_t num_views = calibration.used_views.size();
  const size_t stride = (num_views + kMaxPlottedViews - 1) / kMaxPlottedViews;
  for (size_t v = 0; v < num_views; v += stride) {
    const BoardView& view = calibration.used_views[v];
    const Eigen::Matrix2Xd& residuals = calibration.residuals[v];
    Value entry = Value::Object();
    entry.Set("name", view.name)
        .Set("rms_px", std::sqrt(residuals.squaredNorm() / static_cast<double>(view.num_corners())))
        .Set("pixels", PixelPairs(view.pixels))
        .Set("residuals", PixelPairs(residuals))
        .Set("T_c_g", ToValue(calibration.T_c_g[v]));
    views.Append(std::move(entry));
  }
  Value plots = Value::Object();
  plots.Set("resolution", SizeValue(resolution))
      .Set("noise_stddev_px", calibration.noise_stddev_px)
      .Set("views", std::move(views));
  Value points = Value::Array();
  if (!calibration.used_views.empty()) {
    const Eigen::Matrix3Xd& points_g = calibration.used_views.front().points_g;
    for (Eigen::Index k = 0; k < points_g.cols(); ++k) {
      points.Append(Value::Numbers(Eigen::Vector3d(points_g.col(k))));
    }
  }
  Value without = Value::Array();
  for (const std::string& name : report.cameras[camera].images_without_board) without.Append(name);
  plots.Set("board_points_g", std::move(points))
      .Set("images_without_board", std::move(without))
      .Set("rejected_corners", RejectedCornerMarks(calibration.rejected_corners));
  if (calibration.model) {
    plots.Set("distortion_curve", DistortionCurve(*calibration.model, resolution))
        .Set("lens_curve", LensCurve(*calibration.model, resolution))
        .Set("straightened_view", StraightenedView(*calibration.model, calibration.used_views));
  }
  return plots;
}

std::string CameraText(const CameraRigReport& report) {
  std::string text;
  char line[256];
  for (size_t c = 0; c < report.cameras.size(); ++c) {
    const CameraCalibration& calibration = report.calibration.cameras[c];
    const std::string& model = report.problem.cameras[c].model;
    std::snprintf(line, sizeof(line), "%s  %s  %zu views, %d corners, rms %.3f px, %s\n",
                  report.cameras[c].name.c_str(), model.c_str(), calibration.used_views.size(),
                  calibration.num_corners, calibration.reprojection_rms_px,
                  std::string(TerminationName(calibration.termination)).c_str());
    text += line;
    text += RejectedText(calibration);
    if (!calibration.model) continue;
    const std::vector<std::string> names = CameraModel::ParameterNames(model);
    const Eigen::VectorXd parameters = calibration.model->parameters();
    const int focal_index = CameraModel::FocalIndex(model);
    for (Eigen::Index i = 0; i < parameters.size(); ++i) {
      const char* name = names[static_cast<size_t>(i)].c_str();
      const char* unit = i >= focal_index && i < focal_index + 4 ? "px" : "";
      if (calibration.covariance.size() == 0) {
        std::snprintf(line, sizeof(line), "  %-5s %12.5f %s\n", name, parameters(i), unit);
      } else if (calibration.covariance(i, i) == 0.0) {
        std::snprintf(line, sizeof(line), "  %-5s %12.5f %s  held\n", name, parameters(i), unit);
      } else {
        std::snprintf(line, sizeof(line), "  %-5s %12.5f +- %.5f %s\n", name, parameters(i),
                      std::sqrt(calibration.covariance(i, i)), unit);
      }
      text += line;
    }
    if (c > 0) text += RelationText(report.calibration, c);
  }
  const std::vector<Finding> findings = AllFindings(report);
  text += "verdict: " + std::string(VerdictName(VerdictOf(findings))) + "\n";
  for (const Finding& finding : findings) {
    text += "  - " + finding.what;
    if (!finding.remedy.empty()) text += "; " + finding.remedy;
    text += "\n";
  }
  return text;
}

}  // namespace calibrato
