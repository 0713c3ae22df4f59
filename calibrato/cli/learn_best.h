#pragma once

#include <cstdint>
#include <string>

#include "calibrato/cli/design_arguments.h"
#include "calibrato/cli/learn_environment.h"
#include "calibrato/learning/team.h"
#include "calibrato/learning/trainer.h"

namespace calibrato {

/// Preset `best` in the words of the command line.
struct LearnBestArguments {
  LearnSetting setting;
  DesignArguments design;
  int num_episodes = 0;  ///< 0: 96.
  uint64_t seed = 1;
  bool resume = false;
  std::string out;
  Team* team = nullptr;  ///< Null: this process alone.
};

/// How many of so many episodes are played: whole rounds ..
[[nodiscard]] int NumEpisodesOfBest(int num_episodes);
/// .. of so many.
[[nodiscard]] int EpisodesPerRoundOfBest(int num_episodes);

/// @throws InputError for a word that means nothing, or as LearnByDesign.
[[nodiscard]] LearnResult LearnBest(const LearnBestArguments& arguments);

}  // namespace calibrato
