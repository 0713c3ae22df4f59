#include <cstdio>
#include <memory>
#include <string>
#include <variant>

#include "calibrato/base/files.h"
#include "calibrato/base/input_error.h"
#include "calibrato/cli/command.h"
#include "calibrato/cli/parse.h"
#include "calibrato/motion/carrier.h"
#include "calibrato/motion/paper_scene.h"
#include "calibrato/motion/robot_formats.h"

namespace calibrato {
namespace {

struct Options {
  std::string motion;
  std::string format;
  std::string rig;
  std::string timing;
  bool scale_to_fit = false;
  std::string out;
};

ExitCode RunExport(const Options& options, const GlobalOptions& global) {
  const RobotFormat format = RobotFormatFromName(options.format);
  Motion motion = ReadMotion(options.motion);
  motion.carrier = Carrier::kArm;
  if (!options.timing.empty()) motion.timing = TimingFromName(options.timing);
  const Rig rig = options.rig.empty() ? PaperRig() : ReadRig(options.rig);
  auto planned = PlanMotion(motion, rig);
  if (const auto* refusal = std::get_if<Refusal>(&planned)) {
    if (!options.scale_to_fit) {
      throw InputError(
          {"the arm can't make this motion", options.motion, refusal->Describe(), refusal->remedy});
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

}  // namespace

Action SetUpExport(CLI::App& app, const GlobalOptions& global) {
  auto options = std::make_shared<Options>();
  app.add_option("motion", options->motion,
                 "MOTION.yaml; planned on the arm, whatever carrier it names")
      ->required();
  app.add_option("--format", options->format, "joint-csv, moveit or franka-csv")->required();
  app.add_option("--rig", options->rig,
                 "RIG.yaml: board, obstacles and limits to plan with; else the paper's rig");
  app.add_option("--timing", options->timing,
                 "quintic, or optimal (as fast as the arm can); else the motion's own");
  app.add_flag("--scale-to-fit", options->scale_to_fit,
               "Shrink a motion that the arm can't make, instead of refusing it");
  app.add_option("--out", options->out, "The file")->required();
  return [options, &global] { return RunExport(*options, global); };
}

}  // namespace calibrato
