#include "calibrato/detection/dark_quads.h"

#include <algorithm>
#include <array>
#include <optional>
#include <set>

namespace calibrato {
namespace {

// A tag's bits look like corners too; seen from a corner of the tag, they lie at a sine of 0.24 or
// more off its side.
constexpr double kMaxSine = 0.15;
constexpr double kMinSide = 6.0;  // [px]

}  // namespace

std::vector<Eigen::Matrix<double, 2, 4>> FindDarkQuads(const SaddleField& field) {
  std::vector<Eigen::Matrix<double, 2, 4>> quads;
  std::set<std::array<int, 4>> known;
  for (int k = 0; k < static_cast<int>(field.saddles().size()); ++k) {
    const Eigen::Vector2d here = field.saddle(k).pixel;
    for (const double side : {1.0, -1.0}) {
      const Eigen::Matrix2d directions = side * field.saddle(k).edges;
      const std::optional<int> next = field.NeighbourAlong(k, directions.col(0), kMaxSine);
      const std::optional<int> last = field.NeighbourAlong(k, directions.col(1), kMaxSine);
      if (!next || !last) continue;
      const Eigen::Vector2d a = field.saddle(*next).pixel - here;
      const Eigen::Vector2d b = field.saddle(*last).pixel - here;
      const double shorter = std::min(a.norm(), b.norm());
      if (shorter < kMinSide) continue;
      const std::optional<int> opposite = field.NearestTo(here + a + b, 0.25 * shorter);
      if (!opposite || !field.MayBeNeighbours(*next, *opposite) ||
          !field.MayBeNeighbours(*last, *opposite)) {
        continue;
      }
      std::array<int, 4> corners = {k, *next, *opposite, *last};
      Eigen::Matrix<double, 2, 4> quad;
      for (int i = 0; i < 4; ++i) quad.col(i) = field.saddle(corners[static_cast<size_t>(i)]).pixel;
      std::sort(corners.begin(), corners.end());
      const bool is_degenerate =
          std::adjacent_find(corners.begin(), corners.end()) != corners.end();
      if (!is_degenerate && known.insert(corners).second) quads.push_back(quad);
    }
  }
  return quads;
}

}  // namespace calibrato
