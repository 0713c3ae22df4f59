#include <algorithm>
#include <cstdio>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calibrato/base/input_error.h"
#include "calibrato/calibration/camera_rig_calibration.h"
#include "calibrato/cli/board_views.h"
#include "calibrato/cli/command.h"
#include "calibrato/cli/output.h"
#include "calibrato/cli/parse.h"
#include "calibrato/diagnosis/camera_diagnosis.h"
#include "calibrato/diagnosis/camera_document.h"
#include "calibrato/diagnosis/detection_findings.h"
#include "calibrato/diagnosis/frame_selection.h"
#include "calibrato/recording/recording.h"
#include "calibrato/sensors/board_symmetry.h"
#include "calibrato/sensors/camera_chain.h"

namespace calibrato {
namespace {

struct Options {
  std::string recording;
  std::string target;
  std::vector<std::string> images;
  std::vector<std::string> models = {"pinhole-radtan"};
  std::string resolution;
  std::optional<double> frame_rate_hz;
  std::vector<std::string> fixed;
  std::string select = "all";
  bool estimate_bending = false;
  bool keep_outliers = false;
  RecordingWindow window;
  std::string out;
};

void CheckOptions(const Options& options) {
  for (const std::string& model : options.models) (void)CameraModel::NumParameters(model);
}

bool HasEnoughViews(const CameraViews& camera) {
  return camera.views.size() >= static_cast<size_t>(kMinViews);
}

// One camera with enough views is worth a result, in which the others have failed.
CameraRigProblem MakeProblem(std::vector<CameraViews>* found, const std::optional<Board>& board,
                             const Options& options) {
  const auto most = std::max_element(
      found->begin(), found->end(),
      [](const CameraViews& a, const CameraViews& b) { return a.views.size() < b.views.size(); });
  if (!HasEnoughViews(*most)) {
    throw InputError({"too few views", "cam" + std::to_string(most - found->begin()),
                      "the board was found in " + std::to_string(most->views.size()) +
                          ", at least " + std::to_string(kMinViews) + " are needed",
                      "take more photos of the board, about twenty"});
  }
  CameraRigProblem problem;
  problem.estimate_bending = options.estimate_bending;
  problem.board = board;
  for (size_t c = 0; c < found->size(); ++c) {
    CameraViews& camera = (*found)[c];
    CameraProblem one;
    one.model = options.models.size() == 1 ? options.models[0] : options.models[c];
    one.resolution = camera.resolution;
    one.views = std::move(camera.views);
    one.reject_outliers = !options.keep_outliers;
    HoldParameters(options.fixed, &one);
    problem.cameras.push_back(std::move(one));
    problem.frame_of_view.push_back(std::move(camera.frame_of_view));
  }
  return problem;
}

std::string CameraChainYaml(const CameraRigReport& report) {
  std::vector<Camera> chain;
  std::string caution;
  if (VerdictOf(report) == Verdict::kFail) {
    caution = "# verdict: fail; not to be trusted, see result.json for why\n";
  }
  std::string notes;
  for (size_t c = 0; c < report.cameras.size(); ++c) {
    const CameraCalibration& calibration = report.calibration.cameras[c];
    if (!calibration.model) return "";
    chain.push_back({*calibration.model, report.problem.cameras[c].resolution,
                     "/" + report.cameras[c].name + "/image_raw",
                     c == 0 ? std::nullopt : report.calibration.T_cn_cnm1[c - 1]});
    if (calibration.model->name() == "pinhole-radtan5") {
      notes =
          "# distortion_model radtan5 (k1 k2 p1 p2 k3) is calibrato's; Kalibr does not know it.\n";
    }
  }
  return caution + notes + ToYaml(ToValue(chain));
}

// Detection's notes and what the views say; a model's failure to fit is the diagnosis's.
CameraRigReport MakeReport(CameraRigProblem problem, const std::vector<CameraViews>& found,
                           std::vector<Finding> findings) {
  CameraRigReport report;
  report.calibration = CalibrateCameraRig(problem);
  report.findings = RigFindings(report.calibration, problem.board);
  report.findings.insert(report.findings.end(), findings.begin(), findings.end());
  const std::vector<CameraCalibration>& cameras = report.calibration.cameras;
  const bool is_whole = std::all_of(cameras.begin(), cameras.end(),
                                    [](const CameraCalibration& c) { return c.model.has_value(); });
  if (cameras.size() > 1 && !is_whole) {
    report.findings.push_back({Severity::kInfo,
                               "camchain.yaml is not written: it would lack a camera",
                               "mend what is wrong with it, or choose the others with --images"});
  }
  for (size_t c = 0; c < found.size(); ++c) {
    CameraReportCard card;
    card.name = "cam" + std::to_string(c);
    card.diagnosis = DiagnoseCamera(problem.cameras[c], report.calibration.cameras[c]);
    if (found[c].no_board) {
      const InputError::Parts& absence = *found[c].no_board;
      card.diagnosis.findings = {
          {Severity::kFail, absence.what + " in any image: " + absence.why, absence.remedy}};
    }
    card.images_without_board = found[c].images_without_board;
    card.detection_rejected = found[c].rejected;
    for (Finding& finding : FindingsOnDetection(found[c].rejected)) {
      card.diagnosis.findings.push_back(std::move(finding));
    }
    if (found[c].is_numbered_by_continuity) {
      card.diagnosis.findings.push_back(
          {Severity::kInfo,
           "the board looks the same from several sides: its corners are numbered so that they "
           "move least from one image to the next",
           "for a frame that does not depend on that, " + SidedBoardAdvice(*problem.board)});
    }
    report.cameras.push_back(std::move(card));
  }
  report.problem = std::move(problem);
  return report;
}

ExitCode RunCalibrateCamera(const Options& options, const GlobalOptions& global) {
  Stopwatch stopwatch;
  OutputFolder out(options.out);
  CheckOptions(options);
  const FrameSelection selection = FrameSelectionFromName(options.select);
  std::vector<std::string> warnings;
  std::optional<Board> board;
  RecordingOptions recording_options;
  recording_options.with_imus = false;
  if (!options.target.empty()) {
    board = BoardFromValue(ReadYaml(options.target), &warnings);
    recording_options.board_points_g = BoardPoints(*board);
  }
  recording_options.image_globs = options.images;
  if (!options.resolution.empty()) {
    recording_options.resolution = ParseResolution(options.resolution);
  }
  recording_options.frame_rate_hz = options.frame_rate_hz;
  const Recording recording = OpenRecording(options.recording, recording_options);
  warnings.insert(warnings.end(), recording.warnings.begin(), recording.warnings.end());
  if (options.models.size() != 1 && options.models.size() != recording.cameras.size()) {
    throw InputError({"wrong number of --model", options.recording,
                      std::to_string(options.models.size()) + " models for " +
                          std::to_string(recording.cameras.size()) + " cameras",
                      "give one for all, or one each"});
  }
  PrintWarnings(warnings);

  stopwatch.Start("detection_s");
  std::vector<CameraViews> found = FindBoardViewsOfAny(recording, board, options.window);
  stopwatch.Start("solve_s");
  CameraRigProblem problem = MakeProblem(&found, board, options);
  std::vector<Finding> findings = SelectFrames(selection, &problem);
  const CameraRigReport report = MakeReport(std::move(problem), found, std::move(findings));

  const Value result = CameraResult(report);
  // One camera's pictures are one object; of several, each its own.
  Value plots = Value::Object();
  plots.Set("plots", CameraPlots(report, 0));
  for (size_t c = 1; c < report.cameras.size(); ++c) {
    plots.Set("plots_" + report.cameras[c].name, CameraPlots(report, c));
  }
  const std::string chain = CameraChainYaml(report);
  out.Remove("camchain.yaml");  // That of an earlier run.
  if (!chain.empty()) out.Add("camchain.yaml", chain);
  CommitResult("Camera calibration", result, plots, &stopwatch, &out);
  if (global.json) {
    std::fputs(ToJson(result).c_str(), stdout);
  } else if (!global.quiet) {
    std::printf("%sreport: %s/report.html\n", CameraText(report).c_str(), options.out.c_str());
  }
  return VerdictOf(report) == Verdict::kFail ? kNotTrusted : kDone;
}

}  // namespace

Action SetUpCalibrateCamera(CLI::App& app, const GlobalOptions& global) {
  auto options = std::make_shared<Options>();
  std::string models;
  for (const std::string_view name : kCameraModelNames) {
    models += (models.empty() ? "" : ", ") + std::string(name);
  }
  app.add_option("recording", options->recording,
                 "Folder of photos, of cameras' images, or of corner lists (cam0_corners.csv); "
                 "ROS 1 bag, ROS 2 bag, MCAP file, video")
      ->required();
  app.add_option("--target", options->target, "The board: Kalibr's target YAML");
  app.add_option("--images", options->images,
                 "Which photos or image topics, as a glob; once a camera");
  app.add_option("--frame-rate", options->frame_rate_hz,
                 "Of a video without a list of stamps [Hz]");
  app.add_option("--model", options->models, "One for all or one a camera, of " + models)
      ->capture_default_str();
  app.add_option("--resolution", options->resolution, "WIDTHxHEIGHT, for corner lists");
  app.add_option("--fix", options->fixed,
                 "Parameters to hold, as p1,fu=458.6; without a value distortion is held at 0, pu "
                 "and pv in the middle of the image, any other where the views have it when it is "
                 "free")
      ->delimiter(',');
  app.add_option(
         "--select", options->select,
         "Which views: all, distinct (none that repeats another), coverage (new ones, as in the "
         "paper) or information (until more "
         "would not help)")
      ->capture_default_str();
  app.add_flag("--estimate-bending", options->estimate_bending,
               "Allow for a board that is not flat");
  app.add_flag("--keep-outliers", options->keep_outliers,
               "Use all corners, by plain least squares");
  app.add_option("--from", options->window.from_s, "Begin so late in the recording [s]");
  app.add_option("--to", options->window.to_s, "End so late in the recording [s]");
  app.add_option("--every", options->window.every, "Use one frame in so many")
      ->capture_default_str();
  app.add_option("--out", options->out, "Folder for the result")->required();
  return [options, &global] { return RunCalibrateCamera(*options, global); };
}

}  // namespace calibrato
