#include "calibrato/diagnosis/camera_diagnosis.h"

#include <cmath>
#include <cstdio>

namespace calibrato {
namespace {

constexpr double kMaxFocalSigma = 0.01;  // sigma(f) / f [-]
constexpr double kMaxHalvesSigma = 3.0;

std::string Percent(double share) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.*f %%", share < 0.1 ? 2 : 0, 100.0 * share);
  return text;
}

void AddTermination(const CameraProblem& problem, const CameraCalibration& calibration,
                    std::vector<Finding>* findings) {
  switch (calibration.termination) {
    case Termination::kConverged:
      return;
    case Termination::kIterationLimit:
      findings->push_back({Severity::kFail, "the solver did not converge",
                           "look for views whose corners are wrong, or use a model with fewer "
                           "parameters"});
      return;
    case Termination::kRankDeficient:
      findings->push_back(
          {Severity::kFail,
           "the views do not determine the camera: some parameter can take any value",
           "tilt the board by 20 to 45 degrees in several directions"});
      return;
    case Termination::kNoStart:
      if (problem.views.size() < static_cast<size_t>(kMinViews)) {
        findings->push_back(
            {Severity::kFail,
             "only " + std::to_string(problem.views.size()) + " views show the board",
             "take at least " + std::to_string(kMinViews) + ", better twenty"});
      } else {
        findings->push_back({Severity::kFail, "no focal length fits the views",
                             "check the board's rows, columns and spacing"});
      }
      return;
  }
}

void AddFocalSigma(const CameraCalibration& calibration, std::vector<Finding>* findings) {
  const Eigen::Vector2d f = calibration.model->intrinsics().head<2>();
  const double worst =
      calibration.covariance.diagonal().head<2>().cwiseSqrt().cwiseQuotient(f).maxCoeff();
  if (!(worst <= kMaxFocalSigma)) {
    findings->push_back(
        {Severity::kFail,
         "the focal length is known to " + Percent(worst) + " only (one sigma; 1 % is the limit)",
         "add views tilted by 20 to 45 degrees and at different distances"});
  }
}

void AddCoverage(const Coverage& coverage, std::vector<Finding>* findings) {
  const auto add = [&](double progress, const std::string& what, const std::string& remedy) {
    if (progress < 1.0) {
      findings->push_back({Severity::kWarn,
                           what + " (" + Percent(progress) + " of the range that is wanted)",
                           remedy});
    }
  };
  add(coverage.x, "the board did not cross the image from left to right",
      "move it to the left and right edges");
  add(coverage.y, "the board did not cross the image from top to bottom",
      "move it to the upper and lower edges");
  add(coverage.size, "the board was always small in the image", "bring it nearer");
  add(coverage.skew, "the board was hardly tilted", "tilt it by 20 to 45 degrees");
}

void AddHalves(const CameraProblem& problem, std::vector<Finding>* findings) {
  CameraProblem halves[2] = {problem, problem};
  for (CameraProblem& half : halves) half.views.clear();
  for (size_t v = 0; v < problem.views.size(); ++v) halves[v % 2].views.push_back(problem.views[v]);
  const CameraCalibration a = CalibrateCamera(halves[0]);
  const CameraCalibration b = CalibrateCamera(halves[1]);
  if (a.termination != Termination::kConverged || b.termination != Termination::kConverged) {
    findings->push_back({Severity::kInfo, "too few views to compare one half with the other",
                         "take twice as many to have the result checked against itself"});
    return;
  }
  const std::vector<std::string> names = CameraModel::ParameterNames(problem.model);
  for (Eigen::Index i = 0; i < 4; ++i) {
    const double sigma = std::sqrt(a.covariance(i, i) + b.covariance(i, i));
    const double difference = std::abs(a.model->parameters()(i) - b.model->parameters()(i));
    if (sigma > 0.0 && !(difference <= kMaxHalvesSigma * sigma)) {
      char text[128];
      std::snprintf(text, sizeof(text),
                    "the two halves of the views disagree about %s: %.2f and %.2f px, %.1f sigma",
                    names[static_cast<size_t>(i)].c_str(), a.model->parameters()(i),
                    b.model->parameters()(i), difference / sigma);
      findings->push_back(
          {Severity::kWarn, text,
           "the stated sigmas are too small for these data: look for views with "
           "large errors, a board that bends, or a lens that the model does not fit"});
    }
  }
}

}  // namespace

std::vector<Finding> DiagnoseCamera(const CameraProblem& problem,
                                    const CameraCalibration& calibration) {
  std::vector<Finding> findings;
  AddTermination(problem, calibration, &findings);
  if (calibration.covariance.size() != 0) AddFocalSigma(calibration, &findings);
  if (!problem.views.empty()) AddCoverage(calibration.coverage, &findings);
  const size_t left_out = problem.views.size() - calibration.used_views.size();
  if (calibration.model && left_out > 0) {
    findings.push_back({Severity::kInfo,
                        std::to_string(left_out) + " views had no start pose and were left out",
                        "look at their corners"});
  }
  if (calibration.termination == Termination::kConverged) AddHalves(problem, &findings);
  return findings;
}

}  // namespace calibrato
