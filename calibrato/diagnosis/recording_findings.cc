#include "calibrato/diagnosis/recording_findings.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "calibrato/calibration/view_selection.h"
#include "calibrato/diagnosis/image_parts.h"

namespace calibrato {
namespace {

constexpr double kLeastTilt = 10.0 / 180.0 * std::numbers::pi;  // [rad]
constexpr double kLeastDistanceRatio = 1.25;                    // Farthest over nearest [-].
constexpr double kAlwaysNear = 0.6;                             // Size in the least view [-].
constexpr double kLargeError = 3.0;                             // Over the median view's rms [-].
constexpr double kBlurred = 1.3;                                // Fast over slow views' noise [-].
constexpr size_t kNamesToList = 3;

// Rounded down: 100 % is not less than wanted.
std::string Percent(double share) { return Format("%.0f %%", std::floor(100.0 * share)); }

// Of the board's normal against the line of sight to its middle [rad].
double Tilt(const BoardView& view, const Rigid3& T_c_g) {
  const Eigen::Vector3d middle = T_c_g * Eigen::Vector3d(view.points_g.rowwise().mean());
  return std::acos(std::min(1.0, std::abs(T_c_g.R.col(2).dot(middle.normalized()))));
}

double LargestTilt(const CameraCalibration& calibration) {
  double largest = 0.0;
  for (size_t v = 0; v < calibration.used_views.size(); ++v) {
    largest = std::max(largest, Tilt(calibration.used_views[v], calibration.T_c_g[v]));
  }
  return largest;
}

void AddRange(double progress, const std::string& what, const std::string& remedy,
              std::vector<Finding>* findings) {
  if (progress >= 1.0) return;
  findings->push_back(
      {Severity::kWarn, what + " (" + Percent(progress) + " of the range that is wanted)", remedy});
}

void AddSkew(const CameraCalibration& calibration, std::vector<Finding>* findings) {
  std::string what = "the board was hardly tilted";
  const double tilt = LargestTilt(calibration);
  if (tilt < kLeastTilt) {
    what = Format(
        "all views are fronto-parallel: the board was never tilted by more than %.0f "
        "degrees",
        tilt / std::numbers::pi * 180.0);
  }
  AddRange(calibration.coverage.skew, what, "tilt the board by 20 to 45 degrees, to all four sides",
           findings);
}

void AddDistances(const CameraProblem& problem, const CameraCalibration& calibration,
                  std::vector<Finding>* findings) {
  if (calibration.used_views.size() < static_cast<size_t>(kMinViews)) return;
  double nearest = std::numeric_limits<double>::infinity();
  double farthest = 0.0;
  double least_size = 1.0;
  for (size_t v = 0; v < calibration.used_views.size(); ++v) {
    const BoardView& view = calibration.used_views[v];
    const double distance =
        (calibration.T_c_g[v] * Eigen::Vector3d(view.points_g.rowwise().mean())).norm();
    nearest = std::min(nearest, distance);
    farthest = std::max(farthest, distance);
    least_size = std::min(least_size, ViewParametersOf(view, problem.resolution).size);
  }
  if (farthest < kLeastDistanceRatio * nearest) {
    findings->push_back(
        {Severity::kInfo,
         Format("all views are from about the same distance, %.2f to %.2f m", nearest, farthest),
         "take some from half and some from twice that distance"});
  }
  if (least_size > kAlwaysNear) {
    findings->push_back(
        {Severity::kInfo,
         "the board was always near: it never fills less than " + Percent(least_size) +
             " of the image's height and width",
         "take some views from farther away, where the lens is as sharp as in use"});
  }
}

std::string Names(const std::vector<std::string>& names) {
  std::string text;
  for (size_t i = 0; i < std::min(names.size(), kNamesToList); ++i) {
    text += (i > 0 ? ", " : "") + names[i];
  }
  return names.size() > kNamesToList ? text + ", .." : text;
}

void AddLeftOut(const CameraProblem& problem, const CameraCalibration& calibration,
                std::vector<Finding>* findings) {
  if (!calibration.rejected_views.empty()) {
    std::vector<std::string> names;
    for (const RejectedView& view : calibration.rejected_views) {
      names.push_back(view.name + ": " + ViewRejectionName(view.reason));
    }
    findings->push_back({Severity::kInfo,
                         std::to_string(names.size()) + " of " +
                             std::to_string(problem.views.size()) + " views were left out (" +
                             Names(names) + ")",
                         "look at their corners: was the board found where it is?"});
  }
  if (!calibration.rejected_corners.empty()) {
    const auto count = calibration.rejected_corners.size();
    const double share = static_cast<double>(count) /
                         static_cast<double>(count + static_cast<size_t>(calibration.num_corners));
    findings->push_back(
        {Severity::kInfo,
         Format("%zu corners (%.1f %%) were left out as outliers", count, 100.0 * share),
         "look for reflections, fingers before the board, or a damaged print"});
  }
}

std::vector<double> SquaredRmsOfViews(const CameraCalibration& calibration) {
  std::vector<double> squares;
  for (const Eigen::Matrix2Xd& residuals : calibration.residuals) {
    squares.push_back(residuals.squaredNorm() / static_cast<double>(residuals.cols()));
  }
  return squares;
}

double MedianOf(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

void AddLargeErrors(const CameraCalibration& calibration, std::vector<Finding>* findings) {
  const std::vector<double> squares = SquaredRmsOfViews(calibration);
  const double limit = kLargeError * kLargeError * MedianOf(squares);
  std::vector<std::string> names;
  for (size_t v = 0; v < squares.size(); ++v) {
    if (squares[v] > limit) names.push_back(calibration.used_views[v].name);
  }
  if (names.empty()) return;
  findings->push_back({Severity::kInfo,
                       std::to_string(names.size()) + " of " + std::to_string(squares.size()) +
                           " views have more than three times the usual error (" + Names(names) +
                           ")",
                       "look at them: are they blurred, or is the board partly hidden?"});
}

// Corners of the faster half of the views against those of the slower half.
void AddBlur(const CameraCalibration& calibration, std::vector<Finding>* findings) {
  const std::vector<double> squares = SquaredRmsOfViews(calibration);
  const auto speeds = BoardSpeeds(calibration.used_views);
  std::vector<double> known;
  for (const auto& speed : speeds) {
    if (speed) known.push_back(*speed);
  }
  constexpr size_t kEnough = 20;
  if (known.size() < kEnough) return;
  const double median_speed = MedianOf(known);
  std::vector<double> fast;
  std::vector<double> slow;
  for (size_t v = 0; v < speeds.size(); ++v) {
    if (speeds[v]) (*speeds[v] > median_speed ? fast : slow).push_back(squares[v]);
  }
  if (fast.empty() || slow.empty()) return;
  const double fast_rms = std::sqrt(MedianOf(fast));
  const double slow_rms = std::sqrt(MedianOf(slow));
  if (!(fast_rms > kBlurred * slow_rms)) return;
  findings->push_back(
      {Severity::kInfo,
       Format("corners are worse while the board moves fast: %.2f px above %.0f px/s, %.2f px "
              "below",
              fast_rms, median_speed, slow_rms),
       "that is motion blur: move more slowly, with more light or a shorter exposure"});
}

}  // namespace

std::vector<Finding> FindingsOnBoardPoses(const CameraProblem& problem,
                                          const CameraCalibration& calibration) {
  std::vector<Finding> findings;
  if (calibration.used_views.empty()) return findings;
  const Coverage& coverage = calibration.coverage;
  AddRange(coverage.x, "the board did not cross the image from left to right",
           "move it to the left and right edges", &findings);
  AddRange(coverage.y, "the board did not cross the image from top to bottom",
           "move it to the upper and lower edges", &findings);
  AddRange(coverage.size, "the board was always small in the image", "bring it nearer", &findings);
  AddSkew(calibration, &findings);
  const std::vector<std::string> parts = UncoveredParts(calibration.used_views, problem.resolution);
  if (!parts.empty()) {
    findings.push_back({Severity::kInfo,
                        Enumerated(parts) + " of the image " +
                            (parts.size() == 1 ? "was" : "were") + " never covered",
                        "hold the board there, as far out as it is found"});
  }
  AddDistances(problem, calibration, &findings);
  return findings;
}

std::vector<Finding> FindingsOnCorners(const CameraProblem& problem,
                                       const CameraCalibration& calibration) {
  std::vector<Finding> findings;
  AddLeftOut(problem, calibration, &findings);
  if (calibration.used_views.empty()) return findings;
  AddLargeErrors(calibration, &findings);
  AddBlur(calibration, &findings);
  return findings;
}

}  // namespace calibrato
