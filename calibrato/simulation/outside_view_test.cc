#include "calibrato/simulation/outside_view.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <variant>

#include "calibrato/motion/paper_scene.h"

namespace calibrato {
namespace {

int NumDifferent(const RgbImage& a, const RgbImage& b) {
  int count = 0;
  for (size_t k = 0; k < a.pixels.size(); ++k) {
    count += std::abs(a.pixels[k] - b.pixels[k]) > 10 ? 1 : 0;
  }
  return count;
}

TEST(OutsideView, ShowsTheArmMoveBeforeTheBoard) {
  Motion motion = HandcraftedMotion(Task::kExtrinsic);
  motion.carrier = Carrier::kArm;
  CarrierPath path = PlannedPath(std::get<TimedMotion>(PlanMotion(motion, PaperRig())));
  const OutsideView view(PaperRig());
  const RgbImage start = view.Draw(path, 0.0);
  const RgbImage later = view.Draw(path, 2.2);
  EXPECT_EQ(NumDifferent(start, view.Draw(path, 0.0)), 0);
  EXPECT_GT(NumDifferent(start, later), 1000);
  EXPECT_LT(NumDifferent(start, later), 200'000);
  path.joints = nullptr;
  EXPECT_GT(NumDifferent(start, view.Draw(path, 0.0)), 10'000);
  // The board's white, 225, is in view, and nothing of the room is as bright.
  EXPECT_GT(std::count(start.pixels.begin(), start.pixels.end(), 225), 3000);
}

TEST(SideBySide, KeepsBothPictures) {
  RgbImage left{{4, 3}, std::vector<uint8_t>(36, 7)};
  left.pixels[0] = 200;
  GreyImage right{{2, 3}, {1, 2, 3, 4, 5, 6}};
  const RgbImage both = SideBySide(left, right);
  ASSERT_EQ(both.resolution, (Resolution{6, 3}));
  EXPECT_EQ(both.pixels[0], 200);
  EXPECT_EQ(both.pixels[12], 1);
  EXPECT_EQ(both.pixels[15], 2);
  EXPECT_EQ(both.pixels[2 * 18 + 17], 6);
  // One of twice the height is shrunk.
  right = {{4, 6}, std::vector<uint8_t>(24, 9)};
  EXPECT_EQ(SideBySide(left, right).resolution, (Resolution{6, 3}));
}

}  // namespace
}  // namespace calibrato
