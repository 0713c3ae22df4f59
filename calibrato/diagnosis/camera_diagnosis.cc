#include "calibrato/diagnosis/camera_diagnosis.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "calibrato/diagnosis/better_model.h"
#include "calibrato/diagnosis/recording_findings.h"

namespace calibrato {
namespace {

constexpr double kMaxFocalSigma = 0.01;  // sigma(f) / f [-]
constexpr double kMaxHalvesSigma = 3.0;  // Of one parameter.
constexpr double kHeldOutWorse = 1.2;    // Over the expected noise [-], chance apart.
constexpr double kNotSquare = 0.01;      // |fu / fv - 1| [-]
// Correlation of neighbours' residuals: the share of their variance that is not noise [-].
constexpr double kSystematicWarn = 0.3;
constexpr double kSystematicInfo = 0.1;
constexpr double kSystematicSigmas = 6.0;
// The noise of real corners is neither quite Gaussian nor quite independent: what is said of board
// and lens has to be far beyond chance, and large enough to matter.
constexpr double kBeyondDoubt = 1e-6;
constexpr double kBentDepth = 3e-4;  // Of the board's diagonal [-].
constexpr double kStretched = 2e-3;  // [-], [rad]

// "only 2 of 8 views fit one lens: 2 left out as 'too few corners', 4 left out as 'does not fit'"
Finding TooFewFit(const CameraProblem& problem, const CameraCalibration& calibration) {
  const auto count = [&](ViewRejection reason) {
    return std::count_if(calibration.rejected_views.begin(), calibration.rejected_views.end(),
                         [reason](const RejectedView& view) { return view.reason == reason; });
  };
  std::string reasons;
  for (const ViewRejection reason :
       {ViewRejection::kTooFewCorners, ViewRejection::kNoPose, ViewRejection::kDoesNotFit}) {
    if (count(reason) == 0) continue;
    reasons += (reasons.empty() ? "" : ", ") + std::to_string(count(reason)) + " left out as '" +
               ViewRejectionName(reason) + "'";
  }
  return {Severity::kFail,
          "only " + std::to_string(problem.views.size() - calibration.rejected_views.size()) +
              " of " + std::to_string(problem.views.size()) + " views fit one lens: " + reasons,
          "look at their corners: was the board found where it is? Are its rows, columns and "
          "spacing right? Take at least " +
              std::to_string(kMinViews) + " good views, better twenty"};
}

void AddTermination(const CameraProblem& problem, const CameraCalibration& calibration,
                    std::vector<Finding>* findings) {
  switch (calibration.termination) {
    case Termination::kConverged:
    case Termination::kNotTried:
      return;
    case Termination::kIterationLimit:
    case Termination::kNoStepHelps:
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
      } else if (!calibration.rejected_views.empty()) {
        findings->push_back(TooFewFit(problem, calibration));
      } else {
        findings->push_back({Severity::kFail, "no focal length fits the views",
                             "check the board's rows, columns and spacing"});
      }
      return;
  }
}

void AddFocalLengths(const CameraCalibration& calibration, std::vector<Finding>* findings) {
  const int focal = CameraModel::FocalIndex(calibration.model->name());
  const Eigen::Vector2d f = calibration.model->focal_and_centre().head<2>();
  const Eigen::Matrix2d relative_covariance = f.cwiseInverse().asDiagonal() *
                                              calibration.covariance.block<2, 2>(focal, focal) *
                                              f.cwiseInverse().asDiagonal();
  const double worst = std::sqrt(relative_covariance.diagonal().maxCoeff());
  if (!(worst <= kMaxFocalSigma)) {
    findings->push_back(
        {Severity::kFail,
         Format("the focal length is known to %.2g %% only (one sigma; 1 %% is the limit)",
                100.0 * worst),
         "add views tilted by 20 to 45 degrees and at different distances"});
    return;
  }
  const Eigen::Vector2d ratio(1.0, -1.0);
  const double difference = f.x() / f.y() - 1.0;
  const double sigma = std::sqrt(ratio.dot(relative_covariance * ratio));
  if (std::abs(difference) > kNotSquare + kMaxHalvesSigma * sigma) {
    findings->push_back(
        {Severity::kInfo,
         Format("fu is %.1f %% %s than fv, but nearly all cameras have square pixels",
                100.0 * std::abs(difference), difference > 0.0 ? "longer" : "shorter"),
         "measure the board: are its rows as far apart as its target file says, and its columns? "
         "was the image squeezed?"});
  }
}

// sigma(f) / f of the fit in which nothing was held at its estimate; infinite where the views leave
// something undetermined.
double FreeFocalSigma(const CameraCalibration& calibration) {
  const Eigen::VectorXd& sigmas = calibration.free_fit->sigmas;
  if (sigmas.size() == 0) return std::numeric_limits<double>::infinity();
  const int focal = CameraModel::FocalIndex(calibration.model->name());
  const Eigen::Vector2d f = calibration.model->focal_and_centre().head<2>();
  return sigmas.segment<2>(focal).cwiseQuotient(f).maxCoeff();
}

// A value from views that do not have it: every other sigma would take it for true.
void AddVagueEstimate(const CameraCalibration& calibration, const std::string& name,
                      std::vector<Finding>* findings) {
  const double sigma = FreeFocalSigma(calibration);
  if (sigma <= kMaxFocalSigma) return;
  const std::string free = name + " is held at what these views say, but where it is free, ";
  findings->push_back(
      {Severity::kFail,
       std::isfinite(sigma)
           ? free + Format("the focal length is known to %.2g %% only (one sigma; 1 %% is the "
                           "limit)",
                           100.0 * sigma)
           : free + "the views do not determine the camera",
       "give its value, as --fix " + name + "=VALUE; or add views tilted by 20 to 45 degrees"});
}

// What is held without a value of its own.
void AddHeld(const CameraProblem& problem, const CameraCalibration& calibration,
             std::vector<Finding>* findings) {
  const std::vector<std::string> names = CameraModel::ParameterNames(problem.model);
  const std::vector<bool> at_estimate = HeldAtTheirEstimate(problem);
  for (size_t i = 0; i < problem.fixed.size(); ++i) {
    if (calibration.free_fit && at_estimate[i]) AddVagueEstimate(calibration, names[i], findings);
    const auto index = static_cast<Eigen::Index>(i);
    if (!problem.fixed[i] || !std::isnan(problem.known(index))) continue;
    findings->push_back(
        {Severity::kInfo,
         names[i] + " is held at " + Format("%.5g, ", calibration.model->parameters()(index)) +
             (at_estimate[i] ? "which these views say themselves: the other sigmas take it for true"
                             : "the middle of the image"),
         "to hold a value that you know, write --fix " + names[i] + "=VALUE"});
  }
}

void AddHalves(const CameraCalibration& calibration, const SplitCheck& split,
               std::vector<Finding>* findings) {
  const std::vector<std::string> names = CameraModel::ParameterNames(calibration.model->name());
  const int focal = CameraModel::FocalIndex(calibration.model->name());
  for (Eigen::Index i = focal; i < focal + 4; ++i) {
    const double a = split.parameters[0](i);
    const double b = split.parameters[1](i);
    const double sigma = split.sigma(i);
    if (sigma > 0.0 && !(std::abs(a - b) <= kMaxHalvesSigma * sigma)) {
      findings->push_back(
          {Severity::kWarn,
           Format("the two halves of the views disagree about %s: %.2f and %.2f px, %.1f sigma",
                  names[static_cast<size_t>(i)].c_str(), a, b, std::abs(a - b) / sigma),
           "the stated sigmas are too small for these data: look for views with large errors, a "
           "board that bends, or a lens that the model does not fit"});
    }
  }
  const double chance = 4.0 / std::sqrt(static_cast<double>(split.degrees));
  if (!std::isfinite(split.held_out_stddev_px)) {
    findings->push_back({Severity::kWarn,
                         "half of the views gives a lens that does not even see where the corners "
                         "of the other half are",
                         "take more views all over the image, or use a model with fewer "
                         "parameters"});
  } else if (!(split.held_out_stddev_px <=
               (kHeldOutWorse + chance) * split.expected_held_out_stddev_px)) {
    findings->push_back(
        {Severity::kWarn,
         Format("half of the views predicts the other half badly: %.2f px where %.2f px were to "
                "be expected",
                split.held_out_stddev_px, split.expected_held_out_stddev_px),
         "take more views all over the image, or use a model with fewer parameters"});
  }
}

bool IsSmooth(const ResidualField& field) {
  return field.neighbour_correlation >
         std::max(kSystematicInfo, kSystematicSigmas * field.correlation_sigma);
}

void AddLens(const CameraProblem& problem, const CameraCalibration& calibration,
             const ResidualField& field, const std::optional<BetterModel>& better,
             std::vector<Finding>* findings) {
  const double share = field.neighbour_correlation;
  findings->push_back(
      {share > kSystematicWarn ? Severity::kWarn : Severity::kInfo,
       problem.model + " does not fit this lens: " +
           Format("%.2f px of the residuals are not noise (%.0f %% of their variance)",
                  field.systematic_rms_px, 100.0 * share),
       better
           ? "use --model " + better->name +
                 Format(", which leaves %.3f px of noise instead of %.3f", better->noise_stddev_px,
                        calibration.noise_stddev_px)
           : "no other model fits better: is there a rolling shutter, or glass before the lens?"});
}

double Diagonal(const CameraCalibration& calibration) {
  Eigen::Vector3d low = calibration.used_views.front().points_g.col(0);
  Eigen::Vector3d high = low;
  for (const BoardView& view : calibration.used_views) {
    low = low.cwiseMin(view.points_g.rowwise().minCoeff());
    high = high.cwiseMax(view.points_g.rowwise().maxCoeff());
  }
  return (high - low).norm();
}

void AddBending(const BoardBendingEstimate& bending, double diagonal,
                std::vector<Finding>* findings) {
  if (!(bending.depth_m > kBentDepth * diagonal)) return;
  findings->push_back({Severity::kWarn,
                       Format("the board is not flat: it bends by %.1f mm over %.0f mm",
                              1e3 * bending.depth_m, 1e3 * diagonal),
                       "glue the print to glass or to a stiff plate, and calibrate again"});
}

void AddStretch(const BoardStretchEstimate& stretch, std::vector<Finding>* findings) {
  if (std::abs(stretch.stretch) > kStretched) {
    findings->push_back(
        {Severity::kWarn,
         Format("the board is not as its target file says: along y its points are %.1f %% %s "
                "apart, beside those along x",
                100.0 * std::abs(stretch.stretch), stretch.stretch > 0.0 ? "further" : "less far"),
         "measure the distances in both directions and correct the target file; a printer may "
         "have scaled the page"});
  }
  if (std::abs(stretch.shear) > kStretched) {
    findings->push_back({Severity::kWarn,
                         Format("the board's rows and columns are off a right angle by %.1f mrad",
                                1e3 * std::abs(stretch.shear)),
                         "print it again, or glue it on without pulling it askew"});
  }
}

// The statistic of what is beyond doubt; else 0.
double Doubtless(const Significance& significance) {
  return significance.probability < kBeyondDoubt ? significance.statistic : 0.0;
}

// A large bend leaves some stretch as well, and the other way round, since the estimate is one
// linear step: the one that explains more is named, and the other shows when that is mended.
void AddBoard(const CameraCalibration& calibration, const BoardShape& shape,
              std::vector<Finding>* findings) {
  const double by_stretch = shape.stretch ? Doubtless(shape.stretch->significance) : 0.0;
  if (Doubtless(shape.bending.significance) > by_stretch) {
    AddBending(shape.bending, Diagonal(calibration), findings);
  } else if (by_stretch > 0.0) {
    AddStretch(*shape.stretch, findings);
  }
}

// Residuals that are not noise are the lens's or the board's. Each can pass for the other to some
// degree: the one that leaves less noise is named.
void AddBoardOrLens(const CameraProblem& problem, const CameraCalibration& calibration,
                    const CameraDiagnosis& diagnosis, std::vector<Finding>* findings) {
  const std::optional<BoardShape>& shape = diagnosis.board_shape;
  const ResidualField& field = *diagnosis.residual_field;
  const bool is_board =
      shape && (Doubtless(shape->bending.significance) > 0.0 ||
                (shape->stretch && Doubtless(shape->stretch->significance) > 0.0));
  if (!is_board && !IsSmooth(field)) return;
  const std::optional<BetterModel> better = FindBetterModel(problem, calibration);
  const bool is_lens = better && !(is_board && shape->noise_stddev_px < better->noise_stddev_px);
  const size_t num_before = findings->size();
  if (is_board && !is_lens) AddBoard(calibration, *shape, findings);
  if (findings->size() == num_before && (is_lens || IsSmooth(field))) {
    AddLens(problem, calibration, field, better, findings);
  }
}

void Append(std::vector<Finding> more, std::vector<Finding>* findings) {
  findings->insert(findings->end(), more.begin(), more.end());
}

}  // namespace

CameraDiagnosis DiagnoseCamera(const CameraProblem& problem, const CameraCalibration& calibration) {
  CameraDiagnosis diagnosis;
  std::vector<Finding>& findings = diagnosis.findings;
  AddTermination(problem, calibration, &findings);
  if (calibration.model) AddHeld(problem, calibration, &findings);
  if (calibration.covariance.size() != 0) AddFocalLengths(calibration, &findings);
  Append(FindingsOnBoardPoses(problem, calibration), &findings);
  Append(FindingsOnCorners(problem, calibration), &findings);
  if (calibration.termination == Termination::kConverged) {
    diagnosis.split = CheckSplit(calibration, problem.fixed);
    if (diagnosis.split) {
      AddHalves(calibration, *diagnosis.split, &findings);
    } else {
      findings.push_back({Severity::kInfo, "too few views to compare one half with the other",
                          "take twice as many to have the result checked against itself"});
    }
    diagnosis.board_shape = EstimateBoardShape(calibration, problem.fixed);
    diagnosis.residual_field = ResidualFieldOf(calibration, problem.resolution);
    AddBoardOrLens(problem, calibration, diagnosis, &findings);
  }
  std::stable_sort(findings.begin(), findings.end(), [](const Finding& a, const Finding& b) {
    return static_cast<int>(a.severity) > static_cast<int>(b.severity);
  });
  return diagnosis;
}

}  // namespace calibrato
