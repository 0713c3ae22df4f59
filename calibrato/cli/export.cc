#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "calibrato/base/input_error.h"
#include "calibrato/cli/arm_argument.h"
#include "calibrato/cli/command.h"
#include "calibrato/cli/export_result.h"
#include "calibrato/cli/output_files.h"
#include "calibrato/cli/parse.h"
#include "calibrato/evaluation/contestant.h"
#include "calibrato/evaluation/joint_drawing.h"
#include "calibrato/evaluation/motion_drawing.h"
#include "calibrato/motion/arm_plan.h"
#include "calibrato/motion/carrier.h"
#include "calibrato/motion/paper_scene.h"
#include "calibrato/motion/robot_formats.h"
#include "calibrato/report/report.h"
#include "calibrato/sensors/foreign_calibration.h"

namespace calibrato {
namespace {

struct Options {
  std::string subject;  // MOTION.yaml, or a result's folder.
  std::string format;
  std::string rig;
  std::string arm;
  std::string timing;
  bool scale_to_fit = false;
  std::optional<double> camera_rate_hz;
  std::string html;
  std::string out;
};

// From the base to the flange.
Eigen::Matrix3Xd PointsOf(const Arm& arm, const JointVector& q) {
  const std::vector<Rigid3> frames = FramesOf(arm, q);
  Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Zero(3, static_cast<Eigen::Index>(frames.size()) + 1);
  for (size_t i = 0; i < frames.size(); ++i) {
    points.col(static_cast<Eigen::Index>(i) + 1) = frames[i].t;
  }
  return points;
}

// The page of a dry run.
std::string DryRunHtml(const Value& summary, const TimedMotion& timed, const Rig& rig,
                       const std::optional<Arm>& arm) {
  ExecutableMotion motion;
  motion.path = PlannedPath(timed);
  motion.path_length_m = PathLength(timed.motion);
  motion.timed = timed;
  Value drawing;
  JointsAgainstLimits joints;
  if (arm) {
    drawing = MotionDrawing(motion, rig, [&](const JointVector& q) { return PointsOf(*arm, q); });
    joints.names = NamesOf(*arm).joints;
    joints.samples = JointSamples(timed, 1000);
    joints.limits = arm->limits;
  } else {
    drawing = MotionDrawing(motion, rig);
    joints = PandaJointsOf(timed);
  }
  drawing.Set("policy", "motion");
  Value document = summary;
  document.Set("kind", "dry-run")
      .Set("joints", JointDrawing(joints))
      .Set("motion", std::move(drawing))
      .Set("board_outline_b", BoardOutline(rig));
  return ReportHtml("Dry run", {document});
}

ExitCode ExportMotion(const Options& options, const GlobalOptions& global) {
  const RobotFormat format = RobotFormatFromName(options.format);
  CheckOutputFiles(
      {{"--out", options.out}, {"--html", options.html}},
      {{"the motion", options.subject}, {"--rig", options.rig}, {"--arm", options.arm}});
  const std::optional<Arm> arm = ReadArmArgument(options.arm);
  if (arm && format == RobotFormat::kFrankaCsv) {
    throw InputError({"no franka-csv for the arm " + arm->name, options.arm,
                      "those are commands for a Panda", "use --format joint-csv or moveit"});
  }
  Motion motion = ReadMotion(options.subject);
  motion.carrier = Carrier::kArm;
  if (!options.timing.empty()) motion.timing = TimingFromName(options.timing);
  const Rig rig = options.rig.empty() ? PaperRig() : ReadRig(options.rig);
  auto planned = arm ? PlanOnArm(*arm, motion, rig) : PlanMotion(motion, rig);
  if (const auto* refusal = std::get_if<Refusal>(&planned)) {
    if (!options.scale_to_fit) {
      throw InputError({"the arm can't make this motion", options.subject, refusal->Describe(),
                        refusal->remedy});
    }
    planned = arm ? PlanScaledToFit(*arm, motion, rig) : PlanScaledToFit(motion, rig);
  }
  const auto& timed = std::get<TimedMotion>(planned);
  Value summary = Value::Object();
  summary.Set("kind", "export")
      .Set("out", options.out)
      .Set("format", options.format)
      .Set("timing", TimingName(timed.motion.timing))
      .Set("motion_s", timed.duration_s())
      .Set("scale", timed.scale);
  if (arm) summary.Set("arm", arm->name);
  std::vector<FileToWrite> files = {
      {options.out, RobotFile(timed, format, arm ? NamesOf(*arm) : PandaNames())}};
  if (!options.html.empty()) {
    files.push_back({options.html, DryRunHtml(summary, timed, rig, arm)});
  }
  WriteFilesTogether(files);
  if (global.json) {
    std::fputs(ToJson(summary).c_str(), stdout);
  } else if (!global.quiet) {
    const size_t num_loops = timed.motion.loops.size();
    std::printf("%zu %s in %.2f s, scale %.3f\n%s\n", num_loops, num_loops == 1 ? "loop" : "loops",
                timed.duration_s(), timed.scale, options.out.c_str());
  }
  return kDone;
}

ExitCode RunExport(const Options& options, const GlobalOptions& global) {
  if (std::filesystem::is_directory(options.subject)) {
    if (!options.html.empty()) {
      throw InputError({"--html has no use here", options.subject, "it draws motions",
                        "give a MOTION.yaml, or leave it out"});
    }
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
  AddArmArgument(app, &options->arm);
  app.add_option("--timing", options->timing,
                 "quintic, or optimal (as fast as the arm can); else the motion's own");
  app.add_flag("--scale-to-fit", options->scale_to_fit,
               "Shrink a motion that the arm can't make, instead of refusing it");
  app.add_option("--html", options->html,
                 "Of a motion: also a page that plays the arm and holds its joints against their "
                 "limits");
  app.add_option("--out", options->out, "The file; of a calibration, the folder")->required();
  return [options, &global] { return RunExport(*options, global); };
}

}  // namespace calibrato
