#include "calibrato/mdp/original_mistakes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrato/base/input_error.h"

namespace calibrato {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(Mistakes, ComeAndGoByName) {
  EXPECT_TRUE(MistakesFromNames("").empty());
  EXPECT_EQ(NamesOf({}), "none");
  EXPECT_EQ(MistakesFromNames("frozen-swarm,constant-accuracy"),
            (Mistakes{Mistake::kConstantAccuracy, Mistake::kFrozenSwarm}));
  EXPECT_EQ(NamesOf({Mistake::kFrozenSwarm, Mistake::kConstantAccuracy}),
            "constant-accuracy,frozen-swarm");
  const Mistakes all = MistakesFromNames("all");
  EXPECT_EQ(all.size(), MistakeNames().size());
  EXPECT_EQ(MistakeName(Mistake::kLastTest), MistakeNames().back());
  EXPECT_EQ(MistakesFromNames(NamesOf(all)), all);
}

TEST(Mistakes, OfAnotherNameAreRefusedWithTheList) {
  EXPECT_THAT([] { (void)MistakesFromNames("frozen-swarm,duration-entrpy"); },
              ThrowsMessage<InputError>(AllOf(HasSubstr("'duration-entrpy'"),
                                              HasSubstr("did you mean duration-entropy"),
                                              HasSubstr("masked-histories"))));
  EXPECT_THAT([] { (void)MistakesFromNames("frozen-swarm,,last-test"); },
              ThrowsMessage<InputError>(HasSubstr("unknown mistake ''")));
}

}  // namespace
}  // namespace calibrato
