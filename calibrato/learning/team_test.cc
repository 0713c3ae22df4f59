#include "calibrato/learning/team.h"

#include <gtest/gtest.h>

#include "calibrato/base/input_error.h"
#include "calibrato/learning/team_of_threads.h"

namespace calibrato {
namespace {

TEST(MapOver, GivesEveryProcessAllResultsInTheirOrder) {
  const auto run = [](Team& team) {
    // Some have one index more than others, one has none.
    const auto results = MapOver(team, 5, [](size_t i) { return std::string(i, 'x'); });
    std::string joined;
    for (const std::string& result : results) joined += result + "|";
    return joined;
  };
  Alone alone;
  EXPECT_EQ(run(alone), "|x|xx|xxx|xxxx|");
  for (const int size : {2, 3, 7}) {
    const auto of_ranks = RunAsTeam(size, run);
    ASSERT_EQ(of_ranks.size(), static_cast<size_t>(size));
    for (const std::string& joined : of_ranks) EXPECT_EQ(joined, run(alone)) << size;
  }
}

TEST(MapOver, CallsEachIndexInOneProcess) {
  const auto called = RunAsTeam(3, [](Team& team) {
    std::string mine;
    std::mutex mutex;
    (void)MapOver(team, 4, [&](size_t i) {
      const std::lock_guard lock(mutex);
      mine += std::to_string(i);
      EXPECT_TRUE(IsMine(team, i));
      return std::string();
    });
    return mine;
  });
  // The first has two, on its threads in any order.
  EXPECT_TRUE(called[0] == "03" || called[0] == "30") << called[0];
  EXPECT_EQ(called[1], "1");
  EXPECT_EQ(called[2], "2");
}

TEST(Team, AgreesOnWhatTheFirstHasAndOnWhatAnyOneSaw) {
  const auto heard = RunAsTeam(3, [](Team& team) {
    const std::string text =
        OfTheFirst(team, [&] { return "from " + std::to_string(team.rank()); });
    return text + (AnyOf(team, team.rank() == 2) ? " stop" : "") +
           (AnyOf(team, false) ? " never" : "");
  });
  for (const std::string& text : heard) EXPECT_EQ(text, "from 0 stop");
}

TEST(Team, NoticesProcessesThatDiffer) {
  const auto noticed = RunAsTeam(2, [](Team& team) {
    ExpectAlike(team, "the same");
    try {
      ExpectAlike(team, team.is_first() ? "1.0" : "1.0000000000000002");
    } catch (const InputError&) {
      return std::string("differ");
    }
    return std::string("alike");
  });
  for (const std::string& text : noticed) EXPECT_EQ(text, "differ");
}

}  // namespace
}  // namespace calibrato
