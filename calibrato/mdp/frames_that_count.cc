#include "calibrato/mdp/frames_that_count.h"

#include <set>
#include <utility>
#include <variant>

namespace calibrato {
namespace {

constexpr double kBorderPx = 8.0;
// Two tags, or as many corners as detection asks for.
constexpr Eigen::Index kLeastCorners = 8;

bool IsInside(const Eigen::Vector2d& pixel, Resolution resolution) {
  return pixel.x() >= kBorderPx && pixel.y() >= kBorderPx &&
         pixel.x() <= resolution.width - 1 - kBorderPx &&
         pixel.y() <= resolution.height - 1 - kBorderPx;
}

// Without the tags that have a corner outside; a tag of which a corner is missing is kept.
BoardView InsidePart(const BoardView& view, Resolution resolution, int points_per_tag) {
  std::set<int> outside;
  for (Eigen::Index k = 0; k < view.num_corners(); ++k) {
    const int tag = view.corner_ids[static_cast<size_t>(k)] / points_per_tag;
    if (!IsInside(view.pixels.col(k), resolution)) outside.insert(tag);
  }
  std::vector<int> kept;
  for (Eigen::Index k = 0; k < view.num_corners(); ++k) {
    const int tag = view.corner_ids[static_cast<size_t>(k)] / points_per_tag;
    if (!outside.contains(tag)) kept.push_back(static_cast<int>(k));
  }
  BoardView part{
      view.stamp, view.name, {}, view.pixels(Eigen::all, kept), view.points_g(Eigen::all, kept)};
  for (const int k : kept) part.corner_ids.push_back(view.corner_ids[static_cast<size_t>(k)]);
  return part;
}

}  // namespace

std::string IntrinsicTaskModel(const CameraModel& truth) {
  const std::string name(truth.name());
  const bool is_part_of_it =
      name == "pinhole-none" || name == "pinhole-radtan" || name == kIntrinsicTaskModel;
  return is_part_of_it ? kIntrinsicTaskModel : name;
}

std::vector<BoardView> FramesThatCount(std::vector<BoardView> views, Resolution resolution) {
  std::erase_if(views, [&](const BoardView& view) {
    for (Eigen::Index k = 0; k < view.num_corners(); ++k) {
      if (!IsInside(view.pixels.col(k), resolution)) return true;
    }
    return false;
  });
  return views;
}

std::vector<BoardView> FramesThatCount(std::vector<BoardView> views, Resolution resolution,
                                       const Board& board) {
  const bool in_parts =
      std::holds_alternative<AprilGrid>(board) || std::holds_alternative<Charuco>(board);
  if (!in_parts) return FramesThatCount(std::move(views), resolution);
  for (BoardView& view : views) view = InsidePart(view, resolution, PointsPerTag(board));
  std::erase_if(views, [](const BoardView& view) { return view.num_corners() < kLeastCorners; });
  return views;
}

}  // namespace calibrato
