#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <variant>

#include "calibrato/base/files.h"
#include "calibrato/base/input_error.h"
#include "calibrato/cli/command.h"
#include "calibrato/cli/export_result.h"
#include "calibrato/cli/parse.h"
#include "calibrato/motion/carrier.h"
#include "calibrato/motion/paper_scene.h"
#include "calibrato/motion/robot_formats.h"
#include "calibrato/sensors/foreign_calibration.h"

namespace calibrato {
namespace {

struct Options {
  std::string subject;  // MOTION.yaml, or a result's folder.
  std::string format;
  std::string rig;
  std::string timing;
  bool scale_to_fit = false;
  std::optional<double> camera_rate_hz;
  std::string out;
};

ExitCode ExportMotion(const Options& options, const GlobalOptions& global) {
  const RobotFormat format = RobotFormatFromName(options.format);
  Motion motion = ReadMotion(options.subject);
  motion.carrier = Carrier::kArm;
  if (!options.timing.empty()) motion.timing = TimingFromName(options.timing);
  const Rig rig = options.rig.empty() ? PaperRig() : ReadRig(options.rig);
  auto planned = PlanMotion(motion, rig);
  if (const auto* refusal = std::get_if<Refusal>(&planned)) {
    if (!options.scale_to_fit) {
      throw InputError({"the arm can't make this motion", options.subject, refusal->Describe(),
                        refusal->remedy});
    }
    planned = PlanScaledToFit(motion, rig);
  }
  const auto& timed = std::get<TimedMotion>(planned);
  WriteFileAtomically(options.out, RobotFile(timed, format));
  Value summary = Value::Object();
  summary.Set("kind", "export")
      .Set("out", options.out)
      .Set("format", options.format)
      .Set("timing", TimingName(timed.motion.timing))
      .Set("motion_s", timed.duration_s())
      .Set("scale", timed.scale);
  if (global.json) {
    std::fputs(ToJson(summary).c_str(), stdout);
  } else if (!global.quiet) {
    std::printf("%zu loops in %.2f s, scale %.3f\n%s\n", timed.motion.loops.size(),
                timed.duration_s(), timed.scale, options.out.c_str());
  }
  return kDone;
}

ExitCode RunExport(const Options& options, const GlobalOptions& global) {
  if (std::filesystem::is_directory(options.subject)) {
    return ExportResult(options.subject, options.format, options.camera_rate_hz, options.out,
                        global);
  }
  if (FindCalibrationFormat(options.format)) {
    throw InputError({"nothing to write as " + options.format, options.subject,
                      "a calibration is a folder, and this is none",
                      "give the --out folder of calibrate camera or calibrate camera-imu"});
  }
  return ExportMotion(options, global);
}

}  // namespace

Action SetUpExport(CLI::App& app, const GlobalOptions& global) {
  auto options = std::make_shared<Options>();
  app.add_option("what", options->subject,
                 "MOTION.yaml, planned on the arm, whatever carrier it names; or the --out folder "
                 "of a calibration")
      ->required();
  app.add_option("--format", options->format,
                 "Of a motion: joint-csv, moveit or franka-csv; of a calibration: openvins, "
                 "vins-fusion, basalt, orb-slam3 or ros")
      ->required();
  app.add_option("--camera-rate", options->camera_rate_hz,
                 "Of a calibration, images a second: orb-slam3 asks for it")
      ->check(CLI::Range(0.5, 1000.0));
  app.add_option("--rig", options->rig,
                 "RIG.yaml: board, obstacles and limits to plan with; else the paper's rig");
  app.add_option("--timing", options->timing,
                 "quintic, or optimal (as fast as the arm can); else the motion's own");
  app.add_flag("--scale-to-fit", options->scale_to_fit,
               "Shrink a motion that the arm can't make, instead of refusing it");
  app.add_option("--out", options->out, "The file; of a calibration, the folder")->required();
  return [options, &global] { return RunExport(*options, global); };
}

}  // namespace calibrato
