#include "calibrato/learning/learn_options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "calibrato/base/input_error.h"

namespace calibrato {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(LearnOptions, DefaultsAreThePapersTableFive) {
  const LearnOptions options;
  CheckOptions(options);
  EXPECT_EQ(options.planning.swarm.num_particles, 15);
  EXPECT_EQ(options.planning.swarm.num_iterations, 5);
  EXPECT_EQ(options.planning.swarm.num_remembered, 5);
  EXPECT_EQ(options.planning.num_candidates, 5);
  EXPECT_EQ(options.planning.swarm.social_weight, 1e-5);
  EXPECT_EQ(options.planning.swarm.gradient_weight, 1e-4);
  EXPECT_EQ(options.planning.swarm.inertia_weight, 1e-5);
  EXPECT_EQ(options.planning.swarm.limit, 0.015);
  EXPECT_EQ(options.networks.learning_rate, 1e-4);
}

TEST(LearnOptions, WarmUpIsASixthButNoMoreThanThirty) {
  LearnOptions options;
  for (const auto& [episodes, warm_up] : {std::pair(60, 10), {1000, 30}, {2, 1}}) {
    options.num_episodes = episodes;
    EXPECT_EQ(NumWarmUpEpisodes(options), warm_up);
  }
  options.num_warm_up_episodes = 4;
  EXPECT_EQ(NumWarmUpEpisodes(options), 4);
}

TEST(CheckOptions, NamesWhatIsOutOfRange) {
  LearnOptions options;
  options.num_warm_up_episodes = options.num_episodes;
  EXPECT_THAT([&] { CheckOptions(options); },
              ThrowsMessage<InputError>(HasSubstr("warm-up episodes")));
  options = LearnOptions();
  options.planning.num_candidates = 16;
  EXPECT_THAT([&] { CheckOptions(options); }, ThrowsMessage<InputError>(HasSubstr("candidates")));
  options = LearnOptions();
  options.networks.learning_rate = std::nan("");
  EXPECT_THAT([&] { CheckOptions(options); },
              ThrowsMessage<InputError>(HasSubstr("learning rate")));
}

TEST(CourseOfTraining, ChangesWithTheSeedButNotWithTheNumberOfEpisodes) {
  LearnOptions a;
  a.num_warm_up_episodes = 10;
  LearnOptions b = a;
  b.num_episodes = 100;
  EXPECT_EQ(CourseOfTraining(a), CourseOfTraining(b));
  b.seed = 2;
  EXPECT_NE(CourseOfTraining(a), CourseOfTraining(b));
}

TEST(PaperStages, AreThePapers) {
  EXPECT_EQ(PaperStages(Task::kIntrinsic, 1000).size(), 1U);
  EXPECT_EQ(PaperStages(Task::kJoint, 1000).size(), 1U);
  LearnOptions options;
  options.num_episodes = PaperNumEpisodes(Task::kExtrinsic);
  options.stages = PaperStages(Task::kExtrinsic, options.num_episodes);
  CheckOptions(options);
  ASSERT_EQ(options.stages.size(), 2U);
  EXPECT_EQ(FirstEpisode(options, 1), 1000);
  EXPECT_EQ(FirstEpisode(options, 2), 1650);
  EXPECT_FALSE(options.stages[0].training.calibrate);
  EXPECT_TRUE(options.stages[1].training.calibrate);
  EXPECT_EQ(options.stages[1].training.max_iterations, 1);
  EXPECT_EQ(options.stages[1].test.max_iterations, 10);
  EXPECT_EQ(StageOf(options, 999), 0U);
  EXPECT_EQ(StageOf(options, 1000), 1U);
  EXPECT_EQ(StageOf(options, 1649), 1U);
}

TEST(PaperStages, OfTwoEpisodesAreRefused) {
  LearnOptions options;
  options.num_episodes = 2;
  CheckOptions(options);
  options.stages = PaperStages(Task::kExtrinsic, 2);
  EXPECT_THAT([&] { CheckOptions(options); },
              ThrowsMessage<InputError>(
                  AllOf(HasSubstr("episodes"), HasSubstr("expected 3 to"), HasSubstr("found 2"))));
}

TEST(PaperStages, OfAnyLengthHaveSomethingToTrainInEach) {
  for (int episodes = 3; episodes < 100; ++episodes) {
    LearnOptions options;
    options.num_episodes = episodes;
    options.stages = PaperStages(Task::kExtrinsic, episodes);
    CheckOptions(options);
    EXPECT_GE(options.stages[0].num_episodes, 1);
    EXPECT_LT(options.stages[0].num_episodes, episodes);
    if (episodes > 3) {
      EXPECT_LT(NumWarmUpEpisodes(options), options.stages[0].num_episodes);
    }
  }
}

TEST(CheckOptions, NamesPlannersThatThereAre) {
  LearnOptions options;
  options.planning.planner = "guessing";
  EXPECT_THAT([&] { CheckOptions(options); },
              ThrowsMessage<InputError>(
                  AllOf(HasSubstr("unknown planner 'guessing'"), HasSubstr("cma-es"))));
  options = LearnOptions();
  options.round = 0;
  EXPECT_THAT([&] { CheckOptions(options); }, ThrowsMessage<InputError>(HasSubstr("round")));
  options = LearnOptions();
  options.stages = {TrainingStage(), TrainingStage()};
  options.stages.front().num_episodes = options.num_episodes;
  EXPECT_THAT([&] { CheckOptions(options); },
              ThrowsMessage<InputError>(HasSubstr("episodes of stage learned")));
}

}  // namespace
}  // namespace calibrato
