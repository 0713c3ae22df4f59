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

}  // namespace
}  // namespace calibrato
