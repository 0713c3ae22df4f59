#include "calibrato/cli/learn_best.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <utility>

#include "calibrato/base/input_error.h"
#include "calibrato/cli/command.h"
#include "calibrato/cli/parse.h"
#include "calibrato/learning/design_learner.h"
#include "calibrato/mdp/design_setting.h"

namespace calibrato {
namespace {

constexpr int kNumEpisodes = 96;

}  // namespace

int EpisodesPerRoundOfBest(int num_episodes) {
  return std::min(DesignLearnOptions().episodes_per_round, num_episodes);
}

int NumEpisodesOfBest(int num_episodes) {
  const int round = EpisodesPerRoundOfBest(num_episodes);
  return num_episodes / round * round;
}

LearnResult LearnBest(const LearnBestArguments& arguments) {
  const LearnSetting& setting = arguments.setting;
  const Rng rng(arguments.seed);
  const Fidelity fidelity = FidelityFromName(setting.fidelity);
  std::vector<Rig> believed;
  std::function<Rig(uint64_t)> rig_of_episode;
  bool is_before_board = true;  // Of every rig, where it was planned.
  if (std::filesystem::is_regular_file(setting.rigs)) {
    const Rig rig = AsEstimated(ReadRig(setting.rigs));
    believed = {rig};
    rig_of_episode = [rig](uint64_t) { return rig; };
  } else {
    const RigDistribution rigs = RigDistributionFromName(setting.rigs);
    believed = BelievedRigs(rigs, arguments.design.num_believed, rng);
    is_before_board = IsPapersScene(rigs);
    rig_of_episode = [rigs, rng](uint64_t index) {
      Rng draw = rng.Stream("episode rig", index);
      return DrawRig(rigs, draw);
    };
  }

  DesignLearnOptions options;
  options.carrier = CarrierFromName(setting.carrier);
  options.problem = MakeDesignProblem(TaskFromName(setting.task), options.carrier,
                                      std::move(believed), arguments.design);
  const int num_wanted = arguments.num_episodes == 0 ? kNumEpisodes : arguments.num_episodes;
  options.num_episodes = NumEpisodesOfBest(num_wanted);
  options.episodes_per_round = EpisodesPerRoundOfBest(num_wanted);
  options.seed = arguments.seed;
  options.resume = arguments.resume;
  options.environment = MakeEnvironment(setting).name;
  const MotionDesignProblem& problem = options.problem;
  const Judge judge = [&](const TimedMotion& motion, uint64_t index) {
    const Rig rig = rig_of_episode(index);
    const Rng noise = rng.Stream("episode noise", index);
    if (is_before_board) {
      return JudgeMotion(problem.task, rig, motion, fidelity, problem.criterion, noise);
    }
    std::optional<TimedMotion> moved;
    try {
      moved = BeforeBoard(motion, rig);
    } catch (const InputError&) {
      // Before this board the carrier can't even stand: nobody learns anything of that rig.
      return JudgeNothingLearned(problem.task, rig, problem.criterion);
    }
    return JudgeMotion(problem.task, rig, *moved, fidelity, problem.criterion, noise);
  };
  NoteInterruptions();
  return LearnByDesign(options, judge, arguments.out, &InterruptRequested(), arguments.team);
}

}  // namespace calibrato
