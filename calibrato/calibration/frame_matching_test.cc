#include "calibrato/calibration/frame_matching.h"

#include <gtest/gtest.h>

namespace calibrato {
namespace {

std::vector<BoardView> ViewsAt(const std::vector<int>& milliseconds) {
  std::vector<BoardView> views;
  for (const int ms : milliseconds) {
    BoardView view;
    view.stamp = Time::FromNanoseconds(int64_t{1'000'000} * ms);
    view.name = std::to_string(ms);
    views.push_back(view);
  }
  return views;
}

using Frames = std::vector<std::vector<int>>;
constexpr Duration kMillisecond = Duration::FromNanoseconds(1'000'000);

TEST(FramesByStamp, StampsWithinTheToleranceAreOneFrame) {
  const std::vector<std::vector<BoardView>> views = {ViewsAt({0, 100, 200, 400}),
                                                     ViewsAt({3, 98, 300, 404})};
  EXPECT_EQ(FramesByStamp(views, kMillisecond * 5), (Frames{{0, 1, 2, 4}, {0, 1, 3, 4}}));
  EXPECT_EQ(FramesByStamp(views, kMillisecond * 1), (Frames{{0, 3, 4, 6}, {1, 2, 5, 7}}));
}

TEST(FramesByStamp, TheNearestWins) {
  // 8 lies nearer to 10 than to 0.
  const std::vector<std::vector<BoardView>> views = {ViewsAt({0, 10}), ViewsAt({8})};
  EXPECT_EQ(FramesByStamp(views, kMillisecond * 9), (Frames{{0, 1}, {1}}));
}

TEST(FramesByStamp, ManyCamerasAndNone) {
  const std::vector<std::vector<BoardView>> views = {
      ViewsAt({0, 50}), {}, ViewsAt({1, 51}), ViewsAt({49})};
  EXPECT_EQ(FramesByStamp(views, kMillisecond * 2), (Frames{{0, 1}, {}, {0, 1}, {1}}));
}

TEST(DefaultStampTolerance, IsHalfTheMedianIntervalAndAtMostTwentyMilliseconds) {
  EXPECT_EQ(DefaultStampTolerance({ViewsAt({0, 20, 40, 200}), ViewsAt({0, 100})}),
            kMillisecond * 10);
  EXPECT_EQ(DefaultStampTolerance({ViewsAt({0, 1000, 2000})}), kMillisecond * 20);
  EXPECT_EQ(DefaultStampTolerance({ViewsAt({7})}), Duration());
}

}  // namespace
}  // namespace calibrato
