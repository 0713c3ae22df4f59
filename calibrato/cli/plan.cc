#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calibrato/base/input_error.h"
#include "calibrato/cli/arm_argument.h"
#include "calibrato/cli/command.h"
#include "calibrato/cli/design_arguments.h"
#include "calibrato/cli/look_arguments.h"
#include "calibrato/cli/output_files.h"
#include "calibrato/cli/parse.h"
#include "calibrato/evaluation/closed_loop.h"
#include "calibrato/learning/plan_by_method.h"
#include "calibrato/mdp/design_setting.h"
#include "calibrato/mdp/motion_design.h"
#include "calibrato/mdp/motion_information.h"
#include "calibrato/motion/arm_plan.h"
#include "calibrato/simulation/rig_distribution.h"

namespace calibrato {
namespace {

struct Options {
  std::string rig;
  std::string policy;
  std::string method;
  std::string task;     // Empty: the policy's, or intrinsic.
  std::string carrier;  // Empty: that of the policy's motion, or free.
  std::string arm;
  std::string rigs;
  LookArguments look;
  DesignArguments design;
  int evaluations = 0;  // 0: kEvaluations.
  int executed = 0;
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
  smaller.num_loops = static_cast<int>(motion.loops.size());
  smaller.num_fixed_loops = 0;
  smaller.base_pose = motion.base_pose;
  smaller.max_path_m = share * PathLength(motion);
  return FitToBudget(smaller, motion).value_or(motion);
}
Motion Twice(const Motion& motion) {
  Motion twice = motion;
  twice.loops.insert(twice.loops.end(), motion.loops.begin(), motion.loops.end());
  return twice;
}

constexpr int kEvaluations = 4000;
// For what is left of a motion, from how it went on before.
constexpr int kEvaluationsOfRest = 400;

struct PlannedBefore {
  Motion motion;
  std::optional<std::string> task;  // That it was learned for.
};

// Of a policy's folder; empty if there is none, or no folder.
std::string MotionPath(const std::string& folder) {
  namespace fs = std::filesystem;
  if (folder.empty()) return "";
  for (const fs::path& path : {fs::path(folder), fs::path(folder) / "policy"}) {
    if (fs::exists(path / "motion.yaml")) return (path / "motion.yaml").string();
  }
  return "";
}

PlannedBefore ReadPolicyMotion(const std::string& folder) {
  const std::string motion_path = MotionPath(folder);
  if (motion_path.empty()) {
    throw InputError({"no policy", folder, "neither motion.yaml nor policy/motion.yaml is there",
                      "give the folder that calibrato learn wrote, once it has finished"});
  }
  PlannedBefore before{ReadMotion(motion_path), {}};
  const std::filesystem::path header_path =
      std::filesystem::path(motion_path).replace_filename("policy.yaml");
  if (std::filesystem::exists(header_path)) {
    const Value header = ReadYaml(header_path.string());
    if (const Value* task = header.Find("task")) before.task = task->AsString();
  } else if (before.motion.provenance.IsObject()) {
    if (const Value* task = before.motion.provenance.Find("task")) before.task = task->AsString();
  }
  return before;
}

// The design keeps to a sphere and above a height; of an arm whose reach is not known in closed
// form both are widened until its start is well within, and the plan on the arm has the last word.
void StartFrom(const Arm& arm, const Rig& rig, MotionDesignProblem* problem) {
  constexpr double kRoom = 0.2;  // [m]
  problem->base_pose = BasePoseBeforeBoard(rig, StartPose(arm));
  const Eigen::Vector3d& start = problem->base_pose.xyz_m;
  FreeCarrierLimits& limits = problem->limits;
  limits.reach = std::max(limits.reach, (start - FreeCarrierShoulder()).norm() + kRoom);
  limits.min_height = std::min(limits.min_height, start.z() - kRoom);
}

// What was asked for that has no use beside --policy; empty if nothing.
std::string OptionOfMethods(const Options& options) {
  const DesignArguments standard;
  if (!options.rigs.empty()) return "--rigs";
  if (options.design.num_believed != standard.num_believed) return "--believed";
  if (options.executed > 0) return "";  // The rest is designed.
  if (options.evaluations != 0) return "--evaluations";
  if (options.design.max_path_m != standard.max_path_m) return "--max-path";
  if (options.design.max_time_s != standard.max_time_s) return "--max-time";
  return "";
}

void CheckUse(const Options& options) {
  if (options.policy.empty() == options.method.empty()) {
    throw InputError(
        {"plan by what?", "", "give either --method or --policy", "for example --method fisher"});
  }
  CheckLookArguments(options.look);
  const bool by_policy = !options.policy.empty();
  const std::string unused = by_policy ? OptionOfMethods(options) : "";
  if (!unused.empty()) {
    throw InputError({unused + " has no use here", "", "the policy's motion is what it is",
                      "leave it out, or plan by --method"});
  }
  if (!options.arm.empty() && (by_policy || !options.carrier.empty())) {
    throw InputError({"--arm has no use here", "",
                      by_policy ? "a policy's motion begins where its own carrier stood"
                                : "the arm is the carrier",
                      by_policy ? "plan by --method" : "leave --carrier out"});
  }
  if (!by_policy && options.executed > 0) {
    throw InputError({"--executed has no use here", "",
                      "it says how many loops of the policy's motion are done",
                      "give --policy, or leave it out"});
  }
  const bool has_draws = !options.rigs.empty() || by_policy;
  if (!has_draws && options.design.num_believed != DesignArguments().num_believed) {
    throw InputError({"--believed has no use here", "", "it is how many rigs of --rigs are drawn",
                      "add --rigs paper, or leave it out"});
  }
}

// Loops that are done can't be made smaller.
void CheckExecuted(const Options& options, Motion motion, Carrier carrier, const Rig& rig) {
  motion.carrier = carrier;
  const auto planned = PlanMotion(motion, rig);
  if (const auto* refusal = std::get_if<Refusal>(&planned)) {
    throw InputError({"the policy's motion can't have been executed", options.policy,
                      refusal->Describe(),
                      "give the motion as it was executed, and its --carrier"});
  }
}

// A motion with the durations that it takes.
struct ExecutedMotion {
  Motion motion;
  double scale = 1.0;  // What it was made smaller by.
};

// As the carrier, or the arm that somebody described, makes it. @throws InputError if it can't.
ExecutedMotion Executed(Motion motion, Carrier carrier, const std::optional<Arm>& arm,
                        const Rig& rig) {
  motion.carrier = carrier;
  TimedMotion timed = arm ? PlanScaledToFit(*arm, motion, rig) : PlanScaledToFit(motion, rig);
  for (size_t i = 0; i < timed.motion.loops.size(); ++i) {
    timed.motion.loops[i].duration_s = timed.loop_duration_s[i];
  }
  return {std::move(timed.motion), timed.scale};
}

// The same at half its path. @return nothing if the carrier can't make that
std::optional<Motion> HalfOf(const MotionDesignProblem& problem, const Motion& motion,
                             Carrier carrier, const std::optional<Arm>& arm, const Rig& rig) {
  try {
    return Executed(Shrunk(problem, motion, 0.5), carrier, arm, rig).motion;
  } catch (const InputError&) {
    return std::nullopt;
  }
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

std::string TaskNameOf(const Options& options, const std::optional<PlannedBefore>& before) {
  const bool is_said = !options.task.empty();
  if (!before || !before->task) return is_said ? options.task : "intrinsic";
  if (!is_said || options.task == *before->task) return *before->task;
  throw InputError(
      {"a policy of another task", options.policy,
       "it was learned for the " + *before->task + " task, " + options.task + " was asked for",
       "use --task " + *before->task + ", or learn one for " + options.task});
}

Carrier CarrierOf(const Options& options, const std::optional<PlannedBefore>& before) {
  if (!options.carrier.empty()) return CarrierFromName(options.carrier);
  return before ? before->motion.carrier : Carrier::kFree;
}

// The loops that are not executed yet, designed anew for what is known of the rig by now: within
// the path and time of the motion as it was, unless told otherwise. @return What it took.
int64_t PlanRest(const Options& options, MotionDesignProblem problem, Motion* motion) {
  const auto num_loops = static_cast<int>(motion->loops.size());
  if (options.executed >= num_loops) {
    throw InputError({"nothing is left to plan", options.policy,
                      "its motion has " + std::to_string(num_loops) + " loops",
                      "use --executed " + std::to_string(num_loops - 1) + " or less"});
  }
  problem.num_loops = num_loops;
  problem.num_fixed_loops = options.executed;
  problem.base_pose = motion->base_pose;
  if (!(options.design.max_path_m > 0.0)) problem.max_path_m = PathLength(*motion);
  if (!(options.design.max_time_s > 0.0)) problem.max_duration_s = Duration(*motion);
  const int wanted = options.evaluations > 0 ? options.evaluations : kEvaluationsOfRest;
  const int evaluations = std::max(1, static_cast<int>(wanted / NumEvaluations(problem)));
  const std::optional<MotionDesign> design = DesignMotion(problem, *motion, {evaluations});
  const auto stays_as_it_was = [] {
    std::fprintf(stderr, "note: nothing better was found; the rest stays as it was\n");
  };
  if (!design) {
    stays_as_it_was();
    return evaluations * NumEvaluations(problem);
  }
  const auto fitting = WithRestThatFits(design->motion, static_cast<size_t>(options.executed),
                                        motion->carrier, problem.rigs.front());
  if (!fitting) {
    stays_as_it_was();
    return design->num_information_evaluations;
  }
  const Value provenance = motion->provenance;
  *motion = fitting->timed->motion;
  motion->provenance = provenance;
  if (motion->provenance.IsObject()) {
    motion->provenance.Set("executed_loops", options.executed).Set("planned_anew_for", options.rig);
  }
  return design->num_information_evaluations;
}

ExitCode RunPlan(const Options& options, const GlobalOptions& global) {
  CheckUse(options);
  CheckOutputFiles({{"--out", options.out}, {"--rig-out", options.look.rig_out}},
                   {{"--rig", options.rig},
                    {"--arm", options.arm},
                    {"--policy", MotionPath(options.policy)},
                    {"--photo", options.look.photo},
                    {"--cameras", options.look.cameras}});
  if (std::filesystem::exists(options.out) && !global.force) {
    throw InputError({"cannot write the motion", options.out, "it exists", "add --force"});
  }
  if (std::filesystem::exists(options.look.rig_out) && !global.force) {
    throw InputError({"cannot write the rig", options.look.rig_out, "it exists", "add --force"});
  }
  std::optional<PlannedBefore> before;
  if (!options.policy.empty()) before = ReadPolicyMotion(options.policy);
  const std::string task_name = TaskNameOf(options, before);
  const Task task = TaskFromName(task_name);
  const Carrier carrier = CarrierOf(options, before);
  const std::optional<Arm> arm = ReadArmArgument(options.arm);
  const Rng rng(global.seed);
  Rig nominal = ReadRig(options.rig);
  std::optional<SeenRig> seen;
  if (!options.look.photo.empty()) {
    seen = LookByPhoto(options.look, std::move(nominal), arm ? &*arm : nullptr);
    nominal = seen->rig;
  }
  std::vector<Rig> rigs = {AsEstimated(nominal)};
  if (!options.rigs.empty()) {
    rigs = BelievedRigs(RigDistributionFromName(options.rigs), options.design.num_believed, rng,
                        rigs.front());
  }
  const Rig rig = rigs.front();
  MotionDesignProblem problem = MakeDesignProblem(task, carrier, std::move(rigs), options.design);
  if (arm) StartFrom(*arm, rig, &problem);
  const int num_evaluations_wanted = options.evaluations > 0 ? options.evaluations : kEvaluations;

  Motion motion;
  int64_t num_evaluations = 0;
  if (before) {
    before->motion.base_pose = BasePoseBeforeBoard(rig, before->motion.base_pose);
    if (options.executed > 0) CheckExecuted(options, before->motion, carrier, rig);
    motion = Executed(before->motion, carrier, arm, rig).motion;
    if (options.executed > 0) {
      num_evaluations = PlanRest(options, problem, &motion);
      motion = Executed(std::move(motion), carrier, arm, rig).motion;
    }
  } else {
    std::optional<MotionDesign> design =
        PlanByMethod(options.method, problem, num_evaluations_wanted, rng);
    if (!design) {
      throw InputError({"no motion teaches anything about this rig", options.rig,
                        "the board is never seen as a whole",
                        "allow a longer path or more time, or move the board"});
    }
    num_evaluations = design->num_information_evaluations;
    ExecutedMotion executed = Executed(std::move(design->motion), carrier, arm, rig);
    motion = std::move(executed.motion);
    if (arm && executed.scale < 1.0) {
      std::fprintf(stderr, "note: made smaller to fit the arm %s: %.3f of what was designed\n",
                   arm->name.c_str(), executed.scale);
    }
    motion.provenance = Value::Object()
                            .Set("method", options.method)
                            .Set("task", task_name)
                            .Set("prior", options.rigs.empty() ? "the rig of " + options.rig
                                                               : "rigs " + options.rigs)
                            .Set("seed", std::to_string(global.seed))
                            .Set("information_evaluations", num_evaluations);
    if (arm) motion.provenance.Set("arm", arm->name);
  }
  const Value expected = Expectation(task, rig, motion);
  std::vector<FileToWrite> files = {{options.out, ToYaml(ToValue(motion))}};
  if (!options.look.rig_out.empty()) {
    files.push_back({options.look.rig_out, ToYaml(ToValue(nominal))});
  }
  WriteFilesTogether(files);
  if (global.json) {
    Value result = Value::Object()
                       .Set("kind", "plan")
                       .Set("task", task_name)
                       .Set("method", before ? "policy" : options.method)
                       .Set("carrier", arm ? arm->name : CarrierName(carrier))
                       .Set("path_length_m", PathLength(motion))
                       .Set("motion_s", Duration(motion))
                       .Set("information_evaluations", num_evaluations)
                       .Set("expected", expected);
    if (seen) result.Set("board", ToValue(*seen));
    std::fputs(ToJson(result).c_str(), stdout);
  } else if (!global.quiet) {
    if (seen) std::printf("%s\n", Describe(*seen).c_str());
    std::printf("expected standard deviations of the calibration\n");
    const std::optional<Motion> half = HalfOf(problem, motion, carrier, arm, rig);
    const Motion twice = Twice(motion);
    if (half) PrintExpectation("half the path", *half, Expectation(task, rig, *half));
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
  AddLookArguments(app, &options->look);
  app.add_option("--policy", options->policy, "Folder of a learned policy: its motion");
  app.add_option("--method", options->method, methods);
  app.add_option("--executed", options->executed,
                 "Loops of the policy's motion that are done; the rest is planned anew for --rig, "
                 "as known by now")
      ->check(CLI::Range(1, 1000));
  app.add_option("--task", options->task,
                 "intrinsic, extrinsic or joint (the policy's; with --method intrinsic)");
  app.add_option("--carrier", options->carrier, "free or arm (the policy's; with --method free)");
  AddArmArgument(app, &options->arm);
  app.add_option("--rigs", options->rigs,
                 "A distribution of which rigs are drawn that the motion must suit as well");
  AddDesignArguments(app, &options->design);
  app.add_option("--evaluations", options->evaluations,
                 "Of expected information, one motion for one rig each (4000; of the rest of a "
                 "policy's motion 400)")
      ->check(CLI::Range(1, 100000000));
  app.add_option("--out", options->out, "MOTION.yaml to write")->required();
  return [options, &global] { return RunPlan(*options, global); };
}

}  // namespace calibrato
