#pragma once

#include <memory>
#include <string>
#include <vector>

#include "calibrato/mdp/environment.h"
#include "calibrato/mdp/original_mistakes.h"
#include "calibrato/motion/motion.h"
#include "calibrato/sensors/rig.h"
#include "calibrato/simulation/fidelity.h"

namespace calibrato {

/// What `calibrato learn` was told of where it learns, in the words of its options.
struct LearnSetting {
  std::string task;
  std::string carrier = "free";
  std::string fidelity = "fast";
  std::string rigs = "paper";        ///< A distribution's name, or a RIG.yaml.
  std::string reward = "error";      ///< "error", "reprojection"
  std::string criterion = "a";       ///< "a", "d", "e"
  std::string mistakes;              ///< MistakesFromNames
  double information_weight = -1;    ///< [1/nat]; negative: the task's own.
  std::vector<std::string> without;  ///< Terms of the reward that are left out.
  int num_loops = 0;                 ///< Of an episode; 0: the paper's.
};

/// The environment, and all that it was made of in words: a rig's file by a digest of its content.
struct LearnEnvironment {
  std::unique_ptr<Environment> environment;
  std::string name;
  Rig scene;  ///< The rig's file, or the middle of the distribution: for drawings.
};

/// @throws InputError for a word that means nothing, or a mistake that the task does not have.
[[nodiscard]] LearnEnvironment MakeEnvironment(const LearnSetting& setting);

}  // namespace calibrato
