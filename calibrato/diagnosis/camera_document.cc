#include "calibrato/diagnosis/camera_document.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

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

Value CameraValue(const CameraReportCard& card) {
  const CameraCalibration& calibration = card.calibration;
  Value value = Value::Object();
  value.Set("model", card.problem.model).Set("resolution", SizeValue(card.problem.resolution));
  if (calibration.model) {
    const Eigen::VectorXd parameters = calibration.model->parameters();
    const Eigen::Index num_distortion = parameters.size() - 4;
    value.Set("intrinsics", Value::Numbers(Eigen::VectorXd(parameters.head<4>())))
        .Set("distortion", Value::Numbers(Eigen::VectorXd(parameters.tail(num_distortion))));
    if (calibration.covariance.size() != 0) {
      const Eigen::VectorXd sigma = calibration.covariance.diagonal().cwiseSqrt();
      value.Set("intrinsics_sigma", Value::Numbers(Eigen::VectorXd(sigma.head<4>())))
          .Set("distortion_sigma", Value::Numbers(Eigen::VectorXd(sigma.tail(num_distortion))));
    }
    // No corner is left out as an outlier so far: both are over the same corners.
    value.Set("reprojection_rms_px", calibration.reprojection_rms_px)
        .Set("reprojection_rms_all_px", calibration.reprojection_rms_px)
        .Set("noise_stddev_px", calibration.noise_stddev_px);
  }
  value.Set("num_views", calibration.used_views.size())
      .Set("num_corners", calibration.num_corners)
      .Set("T_cn_cnm1", Value())
      .Set("termination", TerminationName(calibration.termination))
      .Set("coverage", CoverageValue(calibration.coverage))
      .Set("information", InformationValue(calibration));
  return value;
}

Value CovarianceValue(const std::vector<CameraReportCard>& cameras) {
  Value names = Value::Array();
  Eigen::Index size = 0;
  for (const CameraReportCard& card : cameras) {
    if (card.calibration.covariance.size() == 0) continue;
    for (const std::string& name : CameraModel::ParameterNames(card.problem.model)) {
      names.Append(card.name + "." + name);
    }
    size += card.calibration.covariance.rows();
  }
  Eigen::MatrixXd whole = Eigen::MatrixXd::Zero(size, size);
  Eigen::Index start = 0;
  for (const CameraReportCard& card : cameras) {
    const Eigen::MatrixXd& block = card.calibration.covariance;
    whole.block(start, start, block.rows(), block.cols()) = block;
    start += block.rows();
  }
  Value matrix = Value::Array();
  for (Eigen::Index row = 0; row < size; ++row) {
    matrix.Append(Value::Numbers(Eigen::VectorXd(whole.row(row))));
  }
  Value value = Value::Object();
  value.Set("names", std::move(names)).Set("matrix", std::move(matrix));
  return value;
}

// Findings of several cameras say whose they are.
std::vector<Finding> AllFindings(const std::vector<CameraReportCard>& cameras) {
  std::vector<Finding> all;
  for (const CameraReportCard& card : cameras) {
    for (Finding finding : card.findings) {
      if (cameras.size() > 1) finding.what = card.name + ": " + finding.what;
      all.push_back(std::move(finding));
    }
  }
  return all;
}

// How far the lens moves a point, from the image's middle to its corner.
Value DistortionCurve(const CameraModel& model, Resolution resolution) {
  constexpr int kNumPoints = 60;
  const Eigen::Vector4d k = model.intrinsics();
  const Eigen::Vector2d corner(resolution.width - 1 - k(2), resolution.height - 1 - k(3));
  Value radius = Value::Array();
  Value shift = Value::Array();
  for (int i = 0; i <= kNumPoints; ++i) {
    const Eigen::Vector2d straight = corner * i / kNumPoints;
    const auto pixel = model.Project({straight.x() / k(0), straight.y() / k(1), 1.0});
    if (!pixel) break;
    radius.Append(Rounded(straight.norm(), 1e-2));
    shift.Append(Rounded((*pixel - k.tail<2>()).norm() - straight.norm(), 1e-3));
  }
  Value curve = Value::Object();
  curve.Set("radius_px", std::move(radius)).Set("shift_px", std::move(shift));
  return curve;
}

}  // namespace

Verdict VerdictOf(const std::vector<CameraReportCard>& cameras) {
  return VerdictOf(AllFindings(cameras));
}

Value CameraResult(const std::vector<CameraReportCard>& cameras) {
  Value list = Value::Array();
  Coverage least{1.0, 1.0, 1.0, 1.0};
  const CameraReportCard* weakest = &cameras.front();
  const CameraReportCard* unfinished = nullptr;
  for (const CameraReportCard& card : cameras) {
    const CameraCalibration& calibration = card.calibration;
    list.Append(CameraValue(card));
    least.x = std::min(least.x, calibration.coverage.x);
    least.y = std::min(least.y, calibration.coverage.y);
    least.size = std::min(least.size, calibration.coverage.size);
    least.skew = std::min(least.skew, calibration.coverage.skew);
    if (calibration.information.a_optimality > weakest->calibration.information.a_optimality) {
      weakest = &card;
    }
    if (calibration.termination != Termination::kConverged) unfinished = &card;
  }
  const Termination termination =
      unfinished != nullptr ? unfinished->calibration.termination : Termination::kConverged;
  Value result = Value::Object();
  result.Set("kind", "camera")
      .Set("termination", TerminationName(termination))
      .Set("verdict", VerdictName(VerdictOf(cameras)))
      .Set("findings", ToValue(AllFindings(cameras)))
      .Set("cameras", std::move(list))
      .Set("covariance", CovarianceValue(cameras))
      .Set("coverage", CoverageValue(least))
      .Set("information", InformationValue(weakest->calibration));
  return result;
}

Value CameraPlots(const CameraReportCard& camera) {
  const CameraCalibration& calibration = camera.calibration;
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
  plots.Set("resolution", SizeValue(camera.problem.resolution))
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
  for (const std::string& name : camera.images_without_board) without.Append(name);
  plots.Set("board_points_g", std::move(points)).Set("images_without_board", std::move(without));
  if (calibration.model) {
    plots.Set("distortion_curve", DistortionCurve(*calibration.model, camera.problem.resolution));
  }
  return plots;
}

std::string CameraText(const std::vector<CameraReportCard>& cameras) {
  std::string text;
  char line[256];
  for (const CameraReportCard& card : cameras) {
    const CameraCalibration& calibration = card.calibration;
    std::snprintf(line, sizeof(line), "%s  %s  %zu views, %d corners, rms %.3f px, %s\n",
                  card.name.c_str(), card.problem.model.c_str(), calibration.used_views.size(),
                  calibration.num_corners, calibration.reprojection_rms_px,
                  std::string(TerminationName(calibration.termination)).c_str());
    text += line;
    if (!calibration.model) continue;
    const std::vector<std::string> names = CameraModel::ParameterNames(card.problem.model);
    const Eigen::VectorXd parameters = calibration.model->parameters();
    for (Eigen::Index i = 0; i < parameters.size(); ++i) {
      const char* name = names[static_cast<size_t>(i)].c_str();
      const char* unit = i < 4 ? "px" : "";
      if (calibration.covariance.size() == 0) {
        std::snprintf(line, sizeof(line), "  %-3s %12.5f %s\n", name, parameters(i), unit);
      } else if (calibration.covariance(i, i) == 0.0) {
        std::snprintf(line, sizeof(line), "  %-3s %12.5f %s  held\n", name, parameters(i), unit);
      } else {
        std::snprintf(line, sizeof(line), "  %-3s %12.5f +- %.5f %s\n", name, parameters(i),
                      std::sqrt(calibration.covariance(i, i)), unit);
      }
      text += line;
    }
  }
  const std::vector<Finding> findings = AllFindings(cameras);
  text += "verdict: " + std::string(VerdictName(VerdictOf(findings))) + "\n";
  for (const Finding& finding : findings) {
    text += "  - " + finding.what;
    if (!finding.remedy.empty()) text += "; " + finding.remedy;
    text += "\n";
  }
  return text;
}

}  // namespace calibrato
