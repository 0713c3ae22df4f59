#pragma once

#include <CLI/CLI.hpp>
#include <atomic>
#include <cstdint>
#include <functional>
#include <string>

namespace calibrato {

/// Options that every command has.
struct GlobalOptions {
  uint64_t seed = 1;
  int threads = 0;    ///< 0: one per core.
  bool json = false;  ///< The result on stdout, and nothing else.
  bool quiet = false;
  bool force = false;      ///< Replace what is there.
  char** words = nullptr;  ///< The whole command line as the process got it, ended by nullptr.
};

/// How a command ended; the process's exit code (docs/formats.md section 1).
enum ExitCode : int {
  kDone = 0,          ///< Verdict pass or warn.
  kNotTrusted = 1,    ///< Done, but not converged, or verdict fail.
  kBadInput = 2,      ///< Bad usage or input; nothing written.
  kInterrupted = 130  ///< State saved.
};

/// What a command does once its options are parsed. @throws InputError
using Action = std::function<ExitCode()>;

/// Adds a command's own options to its `app` and returns its action. `global` is filled before the
/// action runs.
using SetUp = Action (*)(CLI::App& app, const GlobalOptions& global);

// To add a command: its set-up in a file of its own, its line here, its row in the table of
// main.cc; if it needs room learning, a line in learner_program.cc.
Action SetUpCalibrateCamera(CLI::App& app, const GlobalOptions& global);
Action SetUpCalibrateCameraImu(CLI::App& app, const GlobalOptions& global);
Action SetUpBoard(CLI::App& app, const GlobalOptions& global);
Action SetUpSimulate(CLI::App& app, const GlobalOptions& global);
Action SetUpLearn(CLI::App& app, const GlobalOptions& global);
Action SetUpEvaluateTable1(CLI::App& app, const GlobalOptions& global);
Action SetUpEvaluateTable6(CLI::App& app, const GlobalOptions& global);
Action SetUpEvaluateFigure4(CLI::App& app, const GlobalOptions& global);
Action SetUpEvaluateFigure5(CLI::App& app, const GlobalOptions& global);
Action SetUpEvaluateFigure7(CLI::App& app, const GlobalOptions& global);
Action SetUpEvaluatePareto(CLI::App& app, const GlobalOptions& global);
Action SetUpEvaluateAblation(CLI::App& app, const GlobalOptions& global);
Action SetUpEvaluatePlanners(CLI::App& app, const GlobalOptions& global);
Action SetUpEvaluateRows(CLI::App& app, const GlobalOptions& global);
Action SetUpEvaluateRivals(CLI::App& app, const GlobalOptions& global);
Action SetUpEvaluateAll(CLI::App& app, const GlobalOptions& global);
Action SetUpExport(CLI::App& app, const GlobalOptions& global);
Action SetUpCheck(CLI::App& app, const GlobalOptions& global);
Action SetUpConvert(CLI::App& app, const GlobalOptions& global);
Action SetUpNoise(CLI::App& app, const GlobalOptions& global);
Action SetUpDiff(CLI::App& app, const GlobalOptions& global);
Action SetUpMerge(CLI::App& app, const GlobalOptions& global);
Action SetUpPlan(CLI::App& app, const GlobalOptions& global);
Action SetUpGuide(CLI::App& app, const GlobalOptions& global);
Action SetUpReport(CLI::App& app, const GlobalOptions& global);

/// Set once SIGINT or SIGTERM came; only commands that save their state look at it. See main.cc.
const std::atomic<bool>& InterruptRequested();
/// From here on an interruption is only noted in InterruptRequested(), instead of ending the
/// process.
void NoteInterruptions();

}  // namespace calibrato
