#include "calibrato/motion/motion.h"

#include <gtest/gtest.h>

#include "calibrato/base/input_error.h"

namespace calibrato {
namespace {

TEST(CarrierName, ReadsBackAndRefusesOthers) {
  for (const Carrier carrier : {Carrier::kFree, Carrier::kArm}) {
    EXPECT_EQ(CarrierFromName(CarrierName(carrier)), carrier);
  }
  EXPECT_EQ(CarrierName(Carrier::kArm), "arm");
  EXPECT_THROW((void)CarrierFromName("arn"), InputError);
}

TEST(TaskName, ReadsBackAndRefusesOthers) {
  for (const Task task : {Task::kIntrinsic, Task::kExtrinsic}) {
    EXPECT_EQ(TaskFromName(TaskName(task)), task);
  }
  EXPECT_EQ(NumLoops(TaskFromName("intrinsic")), 4);
  EXPECT_EQ(NumLoops(TaskFromName("extrinsic")), 3);
  EXPECT_THROW((void)TaskFromName(""), InputError);
}

TEST(MotionYaml, ReadsBackToTheSameBits) {
  Rng rng(1);
  Motion motion = RandomMotion(Task::kIntrinsic, rng);
  motion.carrier = Carrier::kArm;
  motion.base_pose.xyz_m << 0.41, 0.1 + 0.2, 1.0 / 3.0;
  motion.loops[2].duration_s = 7.3;
  motion.provenance.Set("seed", 7);
  const std::string text = ToYaml(ToValue(motion));
  std::vector<std::string> warnings;
  const Motion read = MotionFromValue(ParseYaml(text, "motion.yaml"), &warnings);
  EXPECT_TRUE(warnings.empty());
  EXPECT_EQ(read.carrier, motion.carrier);
  EXPECT_EQ(read.base_pose, motion.base_pose);
  ASSERT_EQ(read.loops.size(), motion.loops.size());
  for (size_t i = 0; i < read.loops.size(); ++i) {
    EXPECT_EQ(read.loops[i].coefficients, motion.loops[i].coefficients);
    EXPECT_EQ(read.loops[i].duration_s, motion.loops[i].duration_s);
  }
  EXPECT_EQ(read.provenance.At("seed").AsInt(), 7);
  EXPECT_EQ(ToYaml(ToValue(read)), text);
}

TEST(MotionYaml, OfAMotionOfUnknownProvenanceReadsBack) {
  Motion motion;
  motion.loops.emplace_back();
  const Motion read = MotionFromValue(ParseYaml(ToYaml(ToValue(motion)), "motion.yaml"), nullptr);
  EXPECT_TRUE(read.provenance.IsNull());
}

// The valid file with one piece of text replaced.
std::string FileWith(const std::string& piece, const std::string& replacement) {
  Motion motion;
  motion.loops.push_back({.coefficients = LoopCoefficients::Constant(0.25)});
  std::string text = ToYaml(ToValue(motion));
  const size_t position = text.find(piece);
  EXPECT_NE(position, std::string::npos) << text;
  return text.replace(position, piece.size(), replacement);
}

TEST(MotionYaml, RefusesWhatIsNoMotionAndNamesTheKey) {
  const struct {
    std::string piece;
    std::string replacement;
    std::string key;
  } cases[] = {
      {"free", "balloon", "carrier"},       {"0.25,", "", "coefficients"},
      {"0.25,", "11.0,", "coefficients"},   {"0.25,", ".nan,", "coefficients"},
      {"5.0", "0.0", "duration_s"},         {"5.0", "-1.0", "duration_s"},
      {"duration_s", "time", "duration_s"}, {"xyz_m", "position", "xyz_m"},
  };
  for (const auto& [piece, replacement, key] : cases) {
    try {
      (void)MotionFromValue(ParseYaml(FileWith(piece, replacement), "motion.yaml"), nullptr);
      ADD_FAILURE() << piece << " -> " << replacement << " was taken";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(key), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find("motion.yaml line"), std::string::npos)
          << error.what();
    }
  }
}

TEST(MotionYaml, KeepsItsTimingAndIsQuinticWithoutOne) {
  Motion motion;
  motion.loops.resize(1);
  EXPECT_EQ(ToValue(motion).Find("timing"), nullptr);
  EXPECT_EQ(MotionFromValue(ToValue(motion), nullptr).timing, Timing::kQuintic);
  motion.timing = Timing::kOptimal;
  EXPECT_EQ(MotionFromValue(ToValue(motion), nullptr).timing, Timing::kOptimal);
  try {
    (void)MotionFromValue(
        ParseYaml(FileWith("carrier: ", "timing: optimum\ncarrier: "), "motion.yaml"), nullptr);
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("quintic and optimal"), std::string::npos)
        << error.what();
  }
}

TEST(MotionYaml, RefusesNoLoopsAndMoreThanAThousand) {
  Motion motion;
  EXPECT_THROW((void)MotionFromValue(ToValue(motion), nullptr), InputError);
  motion.loops.resize(1001);
  EXPECT_THROW((void)MotionFromValue(ToValue(motion), nullptr), InputError);
  motion.loops.resize(1000);
  EXPECT_EQ(MotionFromValue(ToValue(motion), nullptr).loops.size(), 1000u);
}

TEST(MotionYaml, WarnsOfUnknownKeys) {
  std::vector<std::string> warnings;
  (void)MotionFromValue(ParseYaml(FileWith("carrier: ", "speed: 3\ncarrier: "), "motion.yaml"),
                        &warnings);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("speed"), std::string::npos);
}

TEST(RandomMotion, IsUniformWithinItsAmplitudeAndRepeatsWithItsSeed) {
  Rng rng(3);
  const Motion motion = RandomMotion(Task::kExtrinsic, rng);
  ASSERT_EQ(motion.loops.size(), 3u);
  const LoopCoefficients amplitude = ScaledAction(LoopCoefficients::Constant(0.02));
  double sum_of_squares = 0.0;
  for (const Loop& loop : motion.loops) {
    const LoopCoefficients relative = loop.coefficients.cwiseQuotient(amplitude);
    EXPECT_LE(relative.cwiseAbs().maxCoeff(), 1.0);
    sum_of_squares += relative.squaredNorm();
  }
  // 1/3 for a uniform variable; 108 of them have a standard error of 0.03.
  EXPECT_NEAR(sum_of_squares / 108.0, 1.0 / 3.0, 0.12);
  Rng again(3);
  EXPECT_EQ(RandomMotion(Task::kExtrinsic, again).loops[2].coefficients,
            motion.loops[2].coefficients);
}

TEST(HandcraftedMotion, HasTheOriginalsExcursions) {
  const Motion motion = HandcraftedMotion(Task::kIntrinsic);
  ASSERT_EQ(motion.loops.size(), 4u);
  EXPECT_NEAR(motion.loops[0].coefficients[27], 0.51, 1e-12);    // pitch
  EXPECT_NEAR(motion.loops[1].coefficients[19], -0.255, 1e-12);  // roll
  EXPECT_NEAR(motion.loops[2].coefficients[2], -0.102, 1e-12);   // x
  EXPECT_NEAR(motion.loops[3].coefficients[31], -0.255, 1e-12);  // yaw
  EXPECT_EQ(HandcraftedMotion(Task::kExtrinsic).loops.size(), 3u);
}

TEST(MotionYaml, WithoutABasePoseHasThePapersAndNamesAKeyThatWasMeantForIt) {
  std::vector<std::string> warnings;
  const Motion motion =
      MotionFromValue(ParseYaml(FileWith("base_pose", "base_pos"), "motion.yaml"), &warnings);
  EXPECT_EQ(motion.base_pose, BasePose());
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("did you mean base_pose"), std::string::npos) << warnings[0];
}

}  // namespace
}  // namespace calibrato
