#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "calibrato/base/files.h"
#include "calibrato/base/input_error.h"
#include "calibrato/cli/command.h"
#include "calibrato/cli/design_arguments.h"
#include "calibrato/cli/parse.h"
#include "calibrato/learning/plan_by_method.h"
#include "calibrato/mdp/design_setting.h"
#include "calibrato/mdp/motion_information.h"

namespace calibrato {
namespace {

struct Options {
  std::string rig;
  std::string policy;
  std::string method;
  std::string task = "intrinsic";
  std::string carrier = "free";
  std::string rigs;
  DesignArguments design;
  int evaluations = 4000;
  std::string out;
};

// What the motion is expected to leave unknown about the rig of the file.
Value Expectation(Task task, const Rig& rig, const Motion& motion) {
  Value expected = Value::Object();
  if (task != Task::kExtrinsic) {
    const auto camera = ExpectIntrinsicInformation(rig, motion);
    if (camera) {
      const int focal = CameraModel::FocalIndex(std::string(rig.cameras.front().model.name()));
      const Eigen::VectorXd variance = camera->covariance.diagonal().segment(focal, 4);
      expected.Set("focal_sigma_px", std::sqrt(variance.head<2>().mean()))
          .Set("centre_sigma_px", std::sqrt(variance.tail<2>().mean()))
          .Set("num_frames", camera->num_frames);
    }
  }
  if (task != Task::kIntrinsic) {
    const auto extrinsics = ExpectExtrinsicInformation(rig, motion);
    if (extrinsics) {
      const Eigen::VectorXd variance = extrinsics->covariance.diagonal();
      expected.Set("rotation_sigma_rad", std::sqrt(variance.head<3>().sum()))
          .Set("translation_sigma_m", std::sqrt(variance.segment<3>(3).sum()))
          .Set("time_offset_sigma_s", std::sqrt(variance(6)));
    }
  }
  return expected;
}

// The same motion shrunk, and repeated: what a shorter or a longer one would give.
Motion Shrunk(const MotionDesignProblem& problem, const Motion& motion, double share) {
  MotionDesignProblem smaller = problem;
  smaller.max_path_m = share * PathLength(motion);
  return FitToBudget(smaller, motion).value_or(motion);
}
Motion Twice(const Motion& motion) {
  Motion twice = motion;
  twice.loops.insert(twice.loops.end(), motion.loops.begin(), motion.loops.end());
  return twice;
}

Motion PolicyMotion(const std::string& folder) {
  namespace fs = std::filesystem;
  for (const fs::path& path :
       {fs::path(folder) / "motion.yaml", fs::path(folder) / "policy" / "motion.yaml"}) {
    if (fs::exists(path)) return ReadMotion(path.string());
  }
  throw InputError({"no policy", folder, "neither motion.yaml nor policy/motion.yaml is there",
                    "give the folder that calibrato learn wrote, once it has finished"});
}

// As the carrier makes it.
Motion Executed(Motion motion, Carrier carrier, const Rig& rig) {
  motion.carrier = carrier;
  auto planned = PlanMotion(motion, rig);
  TimedMotion timed = std::holds_alternative<TimedMotion>(planned)
                          ? std::get<TimedMotion>(std::move(planned))
                          : PlanScaledToFit(motion, rig);
  for (size_t i = 0; i < timed.motion.loops.size(); ++i) {
    timed.motion.loops[i].duration_s = timed.loop_duration_s[i];
  }
  return timed.motion;
}

double Duration(const Motion& motion) {
  double sum = 0.0;
  for (const Loop& loop : motion.loops) sum += loop.duration_s;
  return sum;
}

void PrintExpectation(const char* what, const Motion& motion, const Value& expected) {
  std::printf("%-22s %6.2f m %6.1f s", what, PathLength(motion), Duration(motion));
  const auto print = [&](const char* key, const char* format, double factor) {
    if (const Value* sigma = expected.Find(key)) std::printf(format, factor * sigma->AsDouble());
  };
  print("focal_sigma_px", "   focal %.3f px", 1.0);
  print("centre_sigma_px", "   centre %.3f px", 1.0);
  print("rotation_sigma_rad", "   rotation %.3f mrad", 1e3);
  print("translation_sigma_m", "   translation %.3f mm", 1e3);
  print("time_offset_sigma_s", "   time %.4f ms", 1e3);
  if (expected.members().empty()) std::printf("   nothing is learned");
  std::printf("\n");
}

ExitCode RunPlan(const Options& options, const GlobalOptions& global) {
  if (options.policy.empty() == options.method.empty()) {
    throw InputError(
        {"plan by what?", "", "give either --method or --policy", "for example --method fisher"});
  }
  if (std::filesystem::exists(options.out) && !global.force) {
    throw InputError({"cannot write the motion", options.out, "it exists", "add --force"});
  }
  const Task task = TaskFromName(options.task);
  const Carrier carrier = CarrierFromName(options.carrier);
  const Rng rng(global.seed);
  std::vector<Rig> rigs = {AsEstimated(ReadRig(options.rig))};
  if (!options.rigs.empty()) {
    const auto drawn =
        BelievedRigs(RigDistributionFromName(options.rigs), options.design.num_believed, rng);
    rigs.insert(rigs.end(), drawn.begin() + 1, drawn.end());
  }
  const Rig rig = rigs.front();
  const MotionDesignProblem problem =
      MakeDesignProblem(task, carrier, std::move(rigs), options.design);

  Motion motion;
  int64_t num_evaluations = 0;
  if (!options.policy.empty()) {
    motion = Executed(PolicyMotion(options.policy), carrier, rig);
  } else {
    std::optional<MotionDesign> design =
        PlanByMethod(options.method, problem, options.evaluations, rng);
    if (!design) {
      throw InputError({"no motion teaches anything about this rig", options.rig,
                        "the board is never seen as a whole",
                        "allow a longer path or more time, or move the board"});
    }
    num_evaluations = design->num_information_evaluations;
    motion = Executed(std::move(design->motion), carrier, rig);
    motion.provenance = Value::Object()
                            .Set("method", options.method)
                            .Set("task", options.task)
                            .Set("prior", options.rigs.empty() ? "the rig of " + options.rig
                                                               : "rigs " + options.rigs)
                            .Set("seed", std::to_string(global.seed))
                            .Set("information_evaluations", num_evaluations);
  }
  const Value expected = Expectation(task, rig, motion);
  WriteFileAtomically(options.out, ToYaml(ToValue(motion)));
  if (global.json) {
    const Value result = Value::Object()
                             .Set("kind", "plan")
                             .Set("task", options.task)
                             .Set("method", options.method)
                             .Set("carrier", options.carrier)
                             .Set("path_length_m", PathLength(motion))
                             .Set("motion_s", Duration(motion))
                             .Set("information_evaluations", num_evaluations)
                             .Set("expected", expected);
    std::fputs(ToJson(result).c_str(), stdout);
  } else if (!global.quiet) {
    std::printf("expected standard deviations of the calibration\n");
    const Motion half = Shrunk(problem, motion, 0.5);
    const Motion twice = Twice(motion);
    PrintExpectation("half the path", half, Expectation(task, rig, half));
    PrintExpectation("this motion", motion, expected);
    PrintExpectation("twice this motion", twice, Expectation(task, rig, twice));
    std::printf("motion: %s\n", options.out.c_str());
  }
  return kDone;
}

}  // namespace

Action SetUpPlan(CLI::App& app, const GlobalOptions& global) {
  auto options = std::make_shared<Options>();
  std::string methods;
  for (const std::string& name : PlanMethodNames()) methods += (methods.empty() ? "" : ", ") + name;
  app.add_option("--rig", options->rig, "RIG.yaml: what is believed of the rig")->required();
  app.add_option("--policy", options->policy, "Folder of a learned policy: its motion");
  app.add_option("--method", options->method, methods);
  app.add_option("--task", options->task, "intrinsic, extrinsic or joint")->capture_default_str();
  app.add_option("--carrier", options->carrier, "free or arm")->capture_default_str();
  app.add_option("--rigs", options->rigs,
                 "A distribution of which rigs are drawn that the motion must suit as well");
  AddDesignArguments(app, &options->design);
  app.add_option("--evaluations", options->evaluations,
                 "Of expected information, one motion for one rig each")
      ->check(CLI::Range(1, 100000000))
      ->capture_default_str();
  app.add_option("--out", options->out, "MOTION.yaml to write")->required();
  return [options, &global] { return RunPlan(*options, global); };
}

}  // namespace calibrato
