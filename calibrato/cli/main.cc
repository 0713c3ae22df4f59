// The command line: one table from words to functions. Commands live in files of their own.

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calibrato/base/input_error.h"
#include "calibrato/base/nearest_name.h"
#include "calibrato/base/parallel.h"
#include "calibrato/base/progress.h"
#include "calibrato/cli/command.h"

namespace calibrato {
namespace {

struct Command {
  std::vector<std::string> words;
  const char* summary;
  SetUp set_up;
};

const std::vector<Command> kCommands = {
    {{"calibrate", "camera"},
     "Intrinsics of a camera from photos or corners",
     SetUpCalibrateCamera},
    {{"calibrate", "camera-imu"},
     "Pose and time offset between cameras and an IMU",
     SetUpCalibrateCameraImu},
    {{"board"}, "Draw a board to be printed at its true size", SetUpBoard},
    {{"simulate"}, "A recording of a simulated rig, with its truth", SetUpSimulate},
    {{"learn"}, "Learn a calibration motion", SetUpLearn},
    {{"plan"}, "A motion that calibrates a rig well, and what it will give", SetUpPlan},
    {{"evaluate", "table1"},
     "Learned, handcrafted and random motions on rigs never trained on",
     SetUpEvaluateTable1},
    {{"evaluate", "table6"},
     "Table 1 with policies that were trained on reprojection error",
     SetUpEvaluateTable6},
    {{"evaluate", "figure4"},
     "Error of the intrinsics against the field of view",
     SetUpEvaluateFigure4},
    {{"evaluate", "figure5"},
     "How the error of the extrinsics is distributed over rigs",
     SetUpEvaluateFigure5},
    {{"evaluate", "figure7"},
     "Residuals and biases of the estimator, motion by motion",
     SetUpEvaluateFigure7},
    {{"evaluate", "pareto"}, "Error against path, time and number of frames", SetUpEvaluatePareto},
    {{"evaluate", "ablation"},
     "What each difference of the paper's learner costs or brings, learned anew",
     SetUpEvaluateAblation},
    {{"evaluate", "planners"},
     "All planners under equal budgets of expected information",
     SetUpEvaluatePlanners},
    {{"evaluate", "rows"},
     "Why learn at all: open loop, robust, closed loop, and an oracle",
     SetUpEvaluateRows},
    {{"evaluate", "rivals"},
     "Estimators of others and motions, each with each, on the same recordings",
     SetUpEvaluateRivals},
    {{"evaluate", "all"}, "All of these on one page", SetUpEvaluateAll},
    {{"export"},
     "A motion as a robot's arm reads it, or a calibration as other programs do",
     SetUpExport},
    {{"check"}, "What is wrong with a recording, before it is calibrated", SetUpCheck},
    {{"convert"}, "A recording as folder, ROS 1 bag or MCAP file, without loss", SetUpConvert},
    {{"noise"}, "Noise densities of an IMU from a log of it at rest", SetUpNoise},
    {{"diff"}, "Whether two calibrations of one rig differ, and by how many pixels", SetUpDiff},
    {{"merge"}, "One calibration from several recordings, and how well they repeat", SetUpMerge},
    {{"guide"}, "How to move now: a page that guides a recording by hand", SetUpGuide},
    {{"report"}, "Write report.html anew from the results in a folder", SetUpReport},
};

// The words above the commands.
const std::map<std::string, const char*> kGroups = {
    {"calibrate", "Calibrate what was recorded"}, {"evaluate", "Tables and figures of the paper"}};

std::atomic<bool> g_interrupt_requested = false;
std::atomic<bool> g_note_interruptions = false;

extern "C" void OnInterrupt(int) {
  if (g_note_interruptions && !g_interrupt_requested) {
    g_interrupt_requested = true;
    return;
  }
  // Files appear only when they are complete: nothing has to be undone.
  std::_Exit(kInterrupted);
}

void AddGlobalOptions(CLI::App* app, GlobalOptions* global) {
  app->add_option("--seed", global->seed,
                  "Of everything random; the same seed gives the same bytes")
      ->capture_default_str();
  app->add_option("--threads", global->threads, "How many threads; 0 means one per core")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  app->add_flag("--json", global->json, "The result on stdout, nothing else");
  app->add_flag("--quiet", global->quiet, "No progress, no summary");
  app->add_flag("--force", global->force, "Replace a recording that exists (simulate, convert)");
}

// The first word that names no command, with what could stand there; else nothing.
std::optional<InputError> UnknownCommand(const CLI::App& app, int argc, char** argv) {
  const CLI::App* group = &app;
  std::string path = "calibrato";
  for (int i = 1; i < argc && argv[i][0] != '-'; ++i) {
    std::vector<std::string> names;
    const CLI::App* next = nullptr;
    for (const CLI::App* candidate : group->get_subcommands({})) {
      names.push_back(candidate->get_name());
      if (names.back() == argv[i]) next = candidate;
    }
    if (names.empty()) return std::nullopt;  // A command: what follows are its own words.
    if (next == nullptr) {
      const auto nearest = NearestName(argv[i], names);
      const std::string guess = nearest ? "did you mean " + path + " " + *nearest + "? " : "";
      return InputError({"unknown command '" + path + " " + argv[i] + "'", "", "",
                         guess + "see " + path + " --help"});
    }
    group = next;
    path += " " + std::string(argv[i]);
  }
  return std::nullopt;
}

int Run(int argc, char** argv) {
  CLI::App app{
      "calibrato learns how to move a camera-IMU rig so that its calibration comes out right,\n"
      "and calibrates what was recorded."};
  app.name("calibrato");
  app.set_version_flag("--version", std::string("calibrato " CALIBRATO_VERSION));
  app.require_subcommand(1);
  GlobalOptions global;
  global.words = argv;
  std::vector<std::pair<CLI::App*, Action>> actions;
  std::map<std::string, CLI::App*> groups;
  for (const Command& command : kCommands) {
    CLI::App* parent = &app;
    for (size_t i = 0; i + 1 < command.words.size(); ++i) {
      const std::string& word = command.words[i];
      CLI::App*& group = groups[word];
      if (group == nullptr) group = parent->add_subcommand(word, kGroups.at(word));
      parent = group;
      parent->require_subcommand(1);
    }
    CLI::App* leaf = parent->add_subcommand(command.words.back(), command.summary);
    AddGlobalOptions(leaf, &global);
    actions.emplace_back(leaf, command.set_up(*leaf, global));
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help and --version
    if (const auto unknown = UnknownCommand(app, argc, argv)) throw *unknown;
    std::string hint = "calibrato";
    for (const CLI::App* used = &app; !used->get_subcommands().empty();) {
      used = used->get_subcommands().front();
      hint += " " + used->get_name();
    }
    throw InputError({error.what(), "", "", "see " + hint + " --help"});
  }
  SetNumThreads(global.threads);
  if (global.quiet || global.json) Progress::Silence();
  for (const auto& [leaf, action] : actions) {
    if (!leaf->parsed()) continue;
    const ExitCode code = action();
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
      std::fprintf(stderr, "error: cannot print the result, stdout: is its disk full?\n");
      return kNotTrusted;
    }
    return code;
  }
  return kBadInput;
}

}  // namespace

const std::atomic<bool>& InterruptRequested() { return g_interrupt_requested; }

void NoteInterruptions() { g_note_interruptions = true; }

}  // namespace calibrato

int main(int argc, char** argv) {
  std::signal(SIGINT, calibrato::OnInterrupt);
  std::signal(SIGTERM, calibrato::OnInterrupt);
  try {
    return calibrato::Run(argc, argv);
  } catch (const calibrato::InputError& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return calibrato::kBadInput;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "error: a fault of calibrato itself: %s; please report it\n",
                 error.what());
    return calibrato::kNotTrusted;
  }
}
