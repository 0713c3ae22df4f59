#include "calibrato/sensors/effects.h"

#include <gtest/gtest.h>

#include "calibrato/base/input_error.h"

namespace calibrato {
namespace {

Rig MakeRig() {
  Rig rig;
  rig.cameras = {Camera{CameraModel("pinhole-none", Eigen::Vector4d(585.0, 585.0, 320.5, 240.5)),
                        {640, 480},
                        "",
                        std::nullopt}};
  rig.board = Checkerboard{6, 7, 0.06, 0.06};
  return rig;
}

std::string FileOf(const Rig& rig) { return ToYaml(ToValue(rig)); }

// Each switch changes the rig, by the keys that its entry names, and no other switch's doing.
TEST(Effects, EachIsOneSwitchThatTheRigFileKeeps) {
  for (const Effect& effect : Effects()) {
    Rig rig = MakeRig();
    SwitchOnEffects(std::string(effect.name), &rig);
    const std::string text = FileOf(rig);
    EXPECT_NE(text, FileOf(MakeRig())) << effect.name;
    EXPECT_EQ(FileOf(RigFromValue(ParseYaml(text, "rig.yaml"), nullptr)), text) << effect.name;
    // The last part of its first key stands in the file.
    const std::string_view first = effect.key.substr(0, effect.key.find(','));
    const std::string_view leaf = first.substr(first.rfind('.') + 1);
    EXPECT_NE(text.find(std::string(leaf) + ":"), std::string::npos) << effect.name;
  }
}

TEST(SwitchOnEffects, AllIsEveryOneButTheRollingShutter) {
  Rig all = MakeRig();
  SwitchOnEffects("all", &all);
  Rig one_by_one = MakeRig();
  for (const Effect& effect : Effects()) {
    if (effect.name != "rolling-shutter") effect.switch_on(&one_by_one);
  }
  EXPECT_EQ(FileOf(all), FileOf(one_by_one));
  EXPECT_EQ(all.image_disturbances.line_delay_s, 0.0);
  SwitchOnEffects("rolling-shutter", &all);
  EXPECT_EQ(all.image_disturbances.line_delay_s, 3e-5);
}

TEST(SwitchOnEffects, TakesSeveralAndNamesTheNearestOfATypo) {
  Rig rig = MakeRig();
  SwitchOnEffects("jitter,drops", &rig);
  EXPECT_EQ(rig.image_disturbances.stamp_jitter_s, 5e-4);
  EXPECT_EQ(rig.image_disturbances.drop_probability, 0.05);
  try {
    SwitchOnEffects("jiter", &rig);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("did you mean jitter?"), std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace calibrato
