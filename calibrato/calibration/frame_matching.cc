#include "calibrato/calibration/frame_matching.h"

#include <algorithm>
#include <cstdint>

namespace calibrato {
namespace {

constexpr Duration kLargestTolerance = Duration::FromNanoseconds(20'000'000);

}  // namespace

Duration DefaultStampTolerance(const std::vector<std::vector<BoardView>>& views) {
  Duration least = Duration::FromNanoseconds(INT64_MAX);
  for (const std::vector<BoardView>& camera : views) {
    std::vector<Duration> intervals;
    for (size_t v = 1; v < camera.size(); ++v) {
      intervals.push_back(camera[v].stamp - camera[v - 1].stamp);
    }
    if (intervals.empty()) continue;
    const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2);
    std::nth_element(intervals.begin(), middle, intervals.end());
    least = std::min(least, *middle);
  }
  if (least.nanoseconds() == INT64_MAX) return {};
  return std::min(kLargestTolerance, Duration::FromNanoseconds(least.nanoseconds() / 2));
}

std::vector<std::vector<int>> FramesByStamp(const std::vector<std::vector<BoardView>>& views,
                                            Duration tolerance) {
  std::vector<std::vector<int>> frame_of_view(views.size());
  std::vector<size_t> next(views.size(), 0);
  const auto stamp = [&](size_t c, size_t v) { return views[c][v].stamp; };
  for (int frame = 0;; ++frame) {
    // The earliest view that is left opens a frame; of each other camera the view nearest to it
    // joins, unless its next one is nearer still to the opener's successor.
    size_t opener = views.size();
    for (size_t c = 0; c < views.size(); ++c) {
      if (next[c] == views[c].size()) continue;
      if (opener == views.size() || stamp(c, next[c]) < stamp(opener, next[opener])) opener = c;
    }
    if (opener == views.size()) return frame_of_view;
    const size_t first = next[opener]++;
    const Time time = stamp(opener, first);
    frame_of_view[opener].push_back(frame);
    for (size_t c = 0; c < views.size(); ++c) {
      if (c == opener || next[c] == views[c].size()) continue;
      const Time candidate = stamp(c, next[c]);
      if (candidate - time > tolerance) continue;
      const bool nearer_to_next = next[opener] < views[opener].size() &&
                                  stamp(opener, next[opener]) <= candidate + (candidate - time);
      if (nearer_to_next) continue;
      frame_of_view[c].push_back(frame);
      ++next[c];
    }
  }
}

}  // namespace calibrato
