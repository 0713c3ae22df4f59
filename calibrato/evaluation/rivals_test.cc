#include "calibrato/evaluation/rivals.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "calibrato/base/input_error.h"
#include "calibrato/evaluation/foreign_camera.h"
#include "calibrato/mdp/frames_that_count.h"
#include "calibrato/motion/paper_scene.h"

namespace calibrato {
namespace {

ContestSetting TwoRigs(Task task) {
  ContestSetting setting;
  setting.task = task;
  setting.num_rigs = 2;
  return setting;
}

const RivalRow& RowOf(const Rivals& rivals, const std::string& estimator,
                      const std::string& policy) {
  for (const RivalRow& row : rivals.rows) {
    if (row.estimator == estimator && row.policy == policy) return row;
  }
  throw std::runtime_error("no row " + estimator + ", " + policy);
}

// The same problem, solved by the same criterion: nothing but rounding may differ much.
TEST(Rivals, OpenCvFindsTheSameCameraFromTheSameCorners) {
  const Rivals rivals = EvaluateRivals(TwoRigs(Task::kIntrinsic), {}, {}, 8);
  for (const char* policy : {"random", "handcrafted"}) {
    const RivalRow& ours = RowOf(rivals, "calibrato", policy);
    const RivalRow& theirs = RowOf(rivals, "opencv", policy);
    for (size_t i = 0; i < 2; ++i) {
      EXPECT_EQ(theirs.trials[0][i].failure, "");
      EXPECT_EQ(ours.trials[0][i].num_frames, theirs.trials[0][i].num_frames);
      EXPECT_LE(theirs.trials[0][i].num_frames, 8);
      EXPECT_NEAR(theirs.trials[0][i].relative_error, ours.trials[0][i].relative_error,
                  0.1 * ours.trials[0][i].relative_error);
    }
  }
  EXPECT_GT(rivals.seconds.at("opencv"), 0.0);
  EXPECT_EQ(ToJson(ToValue({rivals})).find("seconds"), std::string::npos);
}

TEST(Rivals, TheFilterIsWorseThanTheBatchAndHasNoClock) {
  const Rivals rivals = EvaluateRivals(TwoRigs(Task::kExtrinsic), {}, {});
  const RivalRow& filter = RowOf(rivals, "kalman-filter", "random");
  for (const Trial& trial : filter.trials[0]) {
    EXPECT_EQ(trial.failure, "");
    EXPECT_LT(trial.rotation_error_rad, 0.02);
    EXPECT_TRUE(std::isnan(trial.time_offset_error_s));
    EXPECT_GT(trial.nees, 0.0);
  }
}

TEST(Rivals, EveryMemberOfAMethodIsTriedBeforeBoardsThatStandElsewhere) {
  ContestSetting setting = TwoRigs(Task::kExtrinsic);
  setting.rigs = RigDistribution::kBroad;
  Motion small = HandcraftedMotion(Task::kExtrinsic);
  for (Loop& loop : small.loops) loop.coefficients *= 0.5;
  const std::vector<MotionUnderTrial> two_seeds = {
      {"learned", HandcraftedMotion(Task::kExtrinsic), Task::kExtrinsic, true},
      {"learned", small, Task::kExtrinsic, true}};
  const Rivals rivals = EvaluateRivals(setting, two_seeds, {});
  const RivalRow& learned = RowOf(rivals, "calibrato", "learned");
  const RivalRow& handcrafted = RowOf(rivals, "calibrato", "handcrafted");
  ASSERT_EQ(learned.trials.size(), 2U);
  for (size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(learned.trials[0][i].failure, "");
    EXPECT_GT(learned.trials[0][i].num_frames, 50);
    // The same motion on the same rig with the same noise.
    EXPECT_EQ(learned.trials[0][i].relative_error, handcrafted.trials[0][i].relative_error);
    EXPECT_LT(learned.trials[1][i].path_length_m, handcrafted.trials[0][i].path_length_m);
  }
}

TEST(Rivals, OutsideProgramsWantImages) {
  EXPECT_THROW(
      static_cast<void>(EvaluateRivals(TwoRigs(Task::kExtrinsic), {}, {{"other", {"true"}, 1.0}})),
      InputError);
}

TEST(ForeignCamera, MrcalReadsOurCorners) {
  const Rig rig = PaperRig();
  const ExecutableMotion motion =
      MakeExecutable(HandcraftedMotion(Task::kIntrinsic), Carrier::kFree, rig);
  std::vector<BoardView> views =
      RecordForTrial(Task::kIntrinsic, rig, motion, Fidelity::kFast, Rng(1)).views;
  const Camera& camera = rig.cameras.front();
  views = FramesThatCount(std::move(views), camera.resolution, rig.board);
  std::vector<BoardView> some;
  for (size_t k = 0; k < views.size(); k += 8) some.push_back(views[k]);
  const ForeignCamera made =
      CalibrateByMrcal(some, camera.resolution, std::get<Checkerboard>(rig.board));
  if (made.failure == "cannot be started") GTEST_SKIP() << "mrcal is not installed";
  ASSERT_EQ(made.failure, "");
  EXPECT_NEAR(made.parameters[0], 585.76, 6.0);
  EXPECT_NEAR(made.parameters[3], 240.5, 6.0);
}

}  // namespace
}  // namespace calibrato
