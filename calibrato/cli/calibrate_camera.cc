#include <cstdio>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calibrato/base/input_error.h"
#include "calibrato/calibration/camera_calibration.h"
#include "calibrato/cli/command.h"
#include "calibrato/cli/output.h"
#include "calibrato/cli/parse.h"
#include "calibrato/detection/detect.h"
#include "calibrato/diagnosis/camera_diagnosis.h"
#include "calibrato/diagnosis/camera_document.h"
#include "calibrato/recording/photo.h"
#include "calibrato/recording/recording.h"
#include "calibrato/sensors/camera_chain.h"

namespace calibrato {
namespace {

struct Options {
  std::string recording;
  std::string target;
  std::vector<std::string> images;
  std::vector<std::string> models = {"pinhole-radtan"};
  std::string resolution;
  std::vector<std::string> fixed;
  std::string select = "all";
  std::string out;
};

struct CameraViews {
  std::vector<BoardView> views;
  Resolution resolution;
  std::vector<std::string> images_without_board;
};

CameraViews FindViews(const CameraRecording& camera, const std::optional<Board>& board) {
  if (const auto* views = std::get_if<std::vector<BoardView>>(&camera.data)) {
    if (!camera.resolution) {
      throw InputError({"unknown image size", camera.name, "a list of corners does not tell it",
                        "give --resolution WIDTHxHEIGHT or a sensor.yaml"});
    }
    return {*views, *camera.resolution, {}};
  }
  const auto& images = std::get<std::vector<ImageFile>>(camera.data);
  if (!board) {
    throw InputError({"no board given", camera.name, "images are searched for a known board",
                      "give --target board.yaml"});
  }
  ImageSource source;
  for (const ImageFile& image : images) {
    source.names.push_back(image.name);
    source.stamps.push_back(image.stamp);
  }
  source.load = [&](size_t k) { return ReadPhoto(images[k].path); };
  Detections detections = DetectBoards(source, *board);
  return {std::move(detections.views), detections.resolution,
          std::move(detections.images_without_board)};
}

CameraReportCard Calibrate(size_t index, CameraViews found, const Options& options) {
  if (found.views.size() < static_cast<size_t>(kMinViews)) {
    throw InputError({"too few views", "cam" + std::to_string(index),
                      "the board was found in " + std::to_string(found.views.size()) +
                          ", at least " + std::to_string(kMinViews) + " are needed",
                      "take more photos of the board, about twenty"});
  }
  CameraReportCard card;
  card.name = "cam" + std::to_string(index);
  card.problem.model = options.models.size() == 1 ? options.models[0] : options.models.at(index);
  card.problem.resolution = found.resolution;
  card.problem.views = std::move(found.views);
  card.images_without_board = std::move(found.images_without_board);
  HoldParameters(options.fixed, &card.problem);
  card.calibration = CalibrateCamera(card.problem);
  card.findings = DiagnoseCamera(card.problem, card.calibration);
  return card;
}

std::string CameraChainYaml(const std::vector<CameraReportCard>& cameras) {
  std::vector<Camera> chain;
  std::string notes;
  for (const CameraReportCard& card : cameras) {
    if (!card.calibration.model) return "";
    chain.push_back({*card.calibration.model, card.problem.resolution,
                     "/" + card.name + "/image_raw", std::nullopt});
    if (card.problem.model == "pinhole-radtan5") {
      notes =
          "# distortion_model radtan5 (k1 k2 p1 p2 k3) is calibrato's; Kalibr does not know it.\n";
    }
  }
  return notes + ToYaml(ToValue(chain));
}

ExitCode RunCalibrateCamera(const Options& options, const GlobalOptions& global) {
  Stopwatch stopwatch;
  OutputFolder out(options.out);
  if (options.select != "all") {
    throw InputError({"--select " + options.select + " is not in this version", "", "",
                      "leave it out: all views are used"});
  }
  for (const std::string& model : options.models) (void)CameraModel::NumParameters(model);
  std::vector<std::string> warnings;
  std::optional<Board> board;
  RecordingOptions recording_options;
  if (!options.target.empty()) {
    board = BoardFromValue(ReadYaml(options.target), &warnings);
    recording_options.board_points_g = BoardPoints(*board);
  }
  recording_options.image_globs = options.images;
  if (!options.resolution.empty())
    recording_options.resolution = ParseResolution(options.resolution);
  const Recording recording = OpenRecording(options.recording, recording_options);
  const size_t num_cameras = recording.cameras.size();
  if (options.models.size() != 1 && options.models.size() != num_cameras) {
    throw InputError({"wrong number of --model", options.recording,
                      std::to_string(options.models.size()) + " models for " +
                          std::to_string(num_cameras) + " cameras",
                      "give one for all, or one each"});
  }
  PrintWarnings(warnings);

  std::vector<CameraReportCard> cards;
  for (size_t c = 0; c < num_cameras; ++c) {
    stopwatch.Start("detection_s");
    CameraViews found = FindViews(recording.cameras[c], board);
    stopwatch.Start("solve_s");
    cards.push_back(Calibrate(c, std::move(found), options));
  }

  const Value result = CameraResult(cards);
  // One camera's pictures are one object; of several, each its own.
  Value plots = Value::Object();
  plots.Set("plots", CameraPlots(cards.front()));
  for (size_t c = 1; c < cards.size(); ++c) {
    plots.Set("plots_" + cards[c].name, CameraPlots(cards[c]));
  }
  const std::string chain = CameraChainYaml(cards);
  if (!chain.empty()) out.Add("camchain.yaml", chain);
  CommitResult("Camera calibration", result, plots, &stopwatch, &out);
  if (global.json) {
    std::fputs(ToJson(result).c_str(), stdout);
  } else if (!global.quiet) {
    std::printf("%sreport: %s/report.html\n", CameraText(cards).c_str(), options.out.c_str());
  }
  return VerdictOf(cards) == Verdict::kFail ? kNotTrusted : kDone;
}

}  // namespace

Action SetUpCalibrateCamera(CLI::App& app, const GlobalOptions& global) {
  auto options = std::make_shared<Options>();
  app.add_option("recording", options->recording,
                 "Folder of photos, or of corner lists (cam0_corners.csv)")
      ->required();
  app.add_option("--target", options->target, "The board: Kalibr's target YAML");
  app.add_option("--images", options->images, "Which photos, as a glob; once a camera");
  app.add_option("--model", options->models,
                 "pinhole-none, pinhole-radtan or pinhole-radtan5; one for all or one a camera")
      ->capture_default_str();
  app.add_option("--resolution", options->resolution, "WIDTHxHEIGHT, for corner lists");
  app.add_option("--fix", options->fixed,
                 "Parameters to hold, as p1,p2: distortion at 0, intrinsics at their start value")
      ->delimiter(',');
  app.add_option("--select", options->select, "Which views: all")->capture_default_str();
  app.add_option("--out", options->out, "Folder for the result")->required();
  return [options, &global] { return RunCalibrateCamera(*options, global); };
}

}  // namespace calibrato
