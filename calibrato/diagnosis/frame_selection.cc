#include "calibrato/diagnosis/frame_selection.h"

#include <cmath>
#include <cstdio>
#include <optional>
#include <set>
#include <utility>

#include "calibrato/base/input_error.h"
#include "calibrato/calibration/view_selection.h"

namespace calibrato {
namespace {

std::vector<size_t> AllOf(const CameraProblem& camera) {
  std::vector<size_t> all(camera.views.size());
  for (size_t v = 0; v < all.size(); ++v) all[v] = v;
  return all;
}

// The views that tell most of the camera, and what is to be said of the rest.
std::vector<size_t> InformativeViews(const CameraProblem& camera, const std::string& name,
                                     std::vector<Finding>* findings) {
  const CameraCalibration calibration = CalibrateCamera(camera);
  if (calibration.covariance.size() == 0) return AllOf(camera);
  const std::vector<BoardView>& used = calibration.used_views;
  const int focal = CameraModel::FocalIndex(camera.model);
  const InformationSelection selection = SelectByInformation(
      InformationOfViews(calibration, camera.fixed), {focal, focal + 1, focal + 2, focal + 3});
  std::vector<size_t> kept;
  for (const size_t v : selection.kept) kept.push_back(calibration.used_view_indices[v]);
  if (kept.size() < static_cast<size_t>(kMinViews)) return AllOf(camera);
  std::string what = name + ": the first " + std::to_string(selection.num_enough) + " of " +
                     std::to_string(used.size()) + " views";
  if (const auto time = TimeOfFirst(selection.num_enough, used)) {
    char seconds[32];
    std::snprintf(seconds, sizeof(seconds), " (%.1f s)", time->seconds());
    what += seconds;
  }
  what += " knew as much as the " + std::to_string(kept.size()) + " that were kept";
  findings->push_back({Severity::kInfo, what, ""});
  return kept;
}

// What repeated views do to the covariance, where they are many.
std::optional<Finding> OnRepeatedViews(const CameraProblem& camera, const std::string& name) {
  constexpr double kWorthAWord = 0.05;
  const auto all = static_cast<double>(camera.views.size());
  const auto distinct = static_cast<double>(SelectDistinct(camera.views).size());
  const double repeated = (all - distinct) / all;
  if (!(repeated > kWorthAWord)) return std::nullopt;
  char text[200];
  std::snprintf(text, sizeof(text),
                "%s: %.0f of %.0f views repeat another, and their corners' errors with it: sigmas "
                "may be up to %.0f %% too small",
                name.c_str(), all - distinct, all, 100.0 * (1.0 - std::sqrt(distinct / all)));
  return Finding{Severity::kInfo, text, "leave them out with --select distinct"};
}

void Keep(const std::set<int>& frames, CameraRigProblem* problem) {
  for (size_t c = 0; c < problem->cameras.size(); ++c) {
    std::vector<BoardView> views;
    std::vector<int> frame_of_view;
    for (size_t v = 0; v < problem->cameras[c].views.size(); ++v) {
      const int frame = problem->frame_of_view[c][v];
      if (!frames.contains(frame)) continue;
      views.push_back(std::move(problem->cameras[c].views[v]));
      frame_of_view.push_back(frame);
    }
    problem->cameras[c].views = std::move(views);
    problem->frame_of_view[c] = std::move(frame_of_view);
  }
}

}  // namespace

FrameSelection FrameSelectionFromName(const std::string& name) {
  if (name == "all") return FrameSelection::kAll;
  if (name == "distinct") return FrameSelection::kDistinct;
  if (name == "coverage") return FrameSelection::kCoverage;
  if (name == "information") return FrameSelection::kInformation;
  throw InputError(
      {"unknown selection '" + name + "'", "", "", "use all, distinct, coverage or information"});
}

std::vector<Finding> SelectFrames(FrameSelection selection, CameraRigProblem* problem) {
  std::vector<Finding> findings;
  if (selection == FrameSelection::kAll) {
    for (size_t c = 0; c < problem->cameras.size(); ++c) {
      if (auto finding = OnRepeatedViews(problem->cameras[c], "cam" + std::to_string(c))) {
        findings.push_back(*std::move(finding));
      }
    }
    return findings;
  }
  std::set<int> all;
  std::set<int> kept;
  for (size_t c = 0; c < problem->cameras.size(); ++c) {
    const CameraProblem& camera = problem->cameras[c];
    const std::vector<size_t> chosen =
        selection == FrameSelection::kDistinct ? SelectDistinct(camera.views)
        : selection == FrameSelection::kCoverage
            ? SelectByCoverage(camera.views, camera.resolution)
            : InformativeViews(camera, "cam" + std::to_string(c), &findings);
    for (const size_t v : chosen) kept.insert(problem->frame_of_view[c][v]);
    all.insert(problem->frame_of_view[c].begin(), problem->frame_of_view[c].end());
  }
  Keep(kept, problem);
  findings.insert(findings.begin(), {Severity::kInfo,
                                     std::to_string(kept.size()) + " of " +
                                         std::to_string(all.size()) + " frames were selected",
                                     ""});
  return findings;
}

}  // namespace calibrato
