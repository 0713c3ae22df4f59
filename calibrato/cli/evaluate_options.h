#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "calibrato/cli/command.h"
#include "calibrato/evaluation/contest.h"
#include "calibrato/evaluation/contestant.h"

namespace calibrato {

/// What all of `calibrato evaluate` take, as words.
struct EvaluateOptions {
  std::string task;  ///< Empty: both.
  std::vector<std::string> policies;
  std::vector<std::string> motions;
  std::vector<std::string> trajectories;
  std::string carrier = "free";
  std::string fidelity = "fast";
  std::string rigs = "paper";
  std::string rig_file;
  int num_rigs = 0;  ///< 0: as many as suit the command.
  bool quick = false;
  std::vector<std::string> outside;  ///< YAML files of programs of others.
  std::string out;
};

void AddEvaluateOptions(CLI::App& app, EvaluateOptions* options);
/// --outside, of the commands that run other estimators.
void AddOutsideOption(CLI::App& app, EvaluateOptions* options);

/// Both where none was asked for.
[[nodiscard]] std::vector<Task> TasksOf(const EvaluateOptions& options);

/// How many rigs a command takes: as asked for; else these.
struct NumRigs {
  int fast = 500;
  int slow = 50;  ///< At fidelities physical and rendered.
  int quick = 100;
};
[[nodiscard]] ContestSetting SettingOf(const EvaluateOptions& options, const GlobalOptions& global,
                                       Task task, const NumRigs& num_rigs = {});

/// Policies, motions and trajectories, in this order. A policy is DIR, whose row is called
/// `learned`, or NAME=DIR: `fine-tuned=out/tuned`. Folders of one name are what different training
/// seeds gave, and make one row.
/// @throws InputError that names the file, and line and key or line.
[[nodiscard]] std::vector<MotionUnderTrial> ReadMotionsUnderTrial(const EvaluateOptions& options);

}  // namespace calibrato
