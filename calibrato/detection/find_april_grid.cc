#include "calibrato/detection/find_april_grid.h"

#include <algorithm>
#include <cassert>
#include <opencv2/calib3d.hpp>
#include <set>
#include <vector>

#include "calibrato/detection/corner_refinement.h"
#include "calibrato/detection/corner_view.h"
#include "calibrato/detection/dark_quads.h"
#include "calibrato/detection/marker_code.h"
#include "calibrato/detection/saddle_field.h"
#include "calibrato/detection/saddle_search.h"

namespace calibrato {
namespace {

constexpr char kFamily[] = "DICT_APRILTAG_36h11";
constexpr MarkerLayout kLayout{6, 2, 0.0};
constexpr double kBorderShare = 0.2;  // of a tag's side that is black border
// Any two of the family differ by 11 bits in every turn. Among all that is not a tag, one in
// 40,000 is within two bits of one; one that is expected at its place may have more.
constexpr int kMaxErrors = 2;
constexpr int kMaxErrorsWhereExpected = 4;

// What else might be on the board: the other families of AprilTag, of which few codes arise by
// chance, and this one with the border that is usual elsewhere.
struct OtherFamily {
  const char* dictionary;
  MarkerLayout layout;
};
constexpr OtherFamily kOtherFamilies[] = {{"DICT_APRILTAG_36h11", {6, 1, 0.0}},
                                          {"DICT_APRILTAG_36h10", {6, 2, 0.0}},
                                          {"DICT_APRILTAG_36h10", {6, 1, 0.0}},
                                          {"DICT_APRILTAG_25h9", {5, 2, 0.0}},
                                          {"DICT_APRILTAG_25h9", {5, 1, 0.0}}};

using Quad = Eigen::Matrix<double, 2, 4>;
// By number on the board, where known: the corners in the board's order.
using Tags = std::vector<std::optional<Quad>>;

// The corners in the board's order (lower left, lower right, ..) from those of a quadrilateral.
// AprilTag's own drawing of a tag is upside down in OpenCV's: what begins there at the top left is
// the lower right corner.
Quad InBoardOrder(const Quad& quad, int turn) {
  constexpr int kCornerInOpenCv[] = {1, 0, 3, 2};
  Quad ordered;
  for (int corner = 0; corner < 4; ++corner) {
    ordered.col(corner) = quad.col((kCornerInOpenCv[corner] - turn + 4) % 4);
  }
  return ordered;
}

Quad FromBoardOrder(const Quad& ordered) {
  constexpr int kCornerOnBoard[] = {1, 0, 3, 2};  // in OpenCV's order
  Quad quad;
  for (int corner = 0; corner < 4; ++corner) quad.col(corner) = ordered.col(kCornerOnBoard[corner]);
  return quad;
}

bool IsOfAnotherFamily(const GreyImage& image, const Quad& quad) {
  return std::any_of(std::begin(kOtherFamilies), std::end(kOtherFamilies), [&](const auto& other) {
    const std::optional<MarkerCode> code = ReadMarker(image, quad, other.layout);
    return code && CodesOf(other.dictionary).Identify(*code, 0);
  });
}

bool AreAtOnePlace(const Quad& a, const Quad& b) {
  const double side = (a.col(1) - a.col(0)).norm();
  return (a.rowwise().mean() - b.rowwise().mean()).norm() < 0.5 * side;
}

struct Reading {
  Tags tags;
  std::set<size_t> seen_twice;  // their numbers
  int num_mirrored = 0;
  RejectionCounts rejected;

  int num_tags() const {
    return static_cast<int>(
        std::count_if(tags.begin(), tags.end(), [](const auto& tag) { return tag.has_value(); }));
  }
};

Reading ReadTags(const GreyImage& image, const std::vector<Quad>& quads, const AprilGrid& board) {
  const MarkerCodes& codes = CodesOf(kFamily);
  Reading reading;
  reading.tags.resize(static_cast<size_t>(board.rows) * static_cast<size_t>(board.columns));
  std::vector<int> errors(reading.tags.size(), 0);
  for (const Quad& quad : quads) {
    const std::optional<MarkerCode> code = ReadMarker(image, quad, kLayout);
    const std::optional<MarkerMatch> match =
        code ? codes.Identify(*code, kMaxErrors) : std::nullopt;
    if (!match) {
      if (code && codes.Identify(codes.Mirrored(*code), 0)) {
        ++reading.num_mirrored;
      } else if (IsOfAnotherFamily(image, quad)) {
        ++reading.rejected.tags_of_another_family;
      }
      continue;
    }
    const auto id = static_cast<size_t>(match->id);
    if (id >= reading.tags.size()) {
      ++reading.rejected.tags_not_on_board;
    } else if (!reading.tags[id] || errors[id] > match->num_errors) {
      // A quadrilateral with one wrong corner may be read as well.
      if (reading.tags[id] && !AreAtOnePlace(*reading.tags[id], quad))
        reading.seen_twice.insert(id);
      reading.tags[id] = InBoardOrder(quad, match->turn);
      errors[id] = match->num_errors;
    } else if (!AreAtOnePlace(*reading.tags[id], quad)) {
      reading.seen_twice.insert(id);
    }
  }
  return reading;
}

// Where a tag's corners should be, by the known tags at most two rows and columns away.
std::optional<Quad> Expected(const Tags& tags, const AprilGrid& board,
                             const Eigen::Matrix3Xd& points_g, int row, int column) {
  std::vector<cv::Point2d> from;
  std::vector<cv::Point2d> to;
  bool has_neighbour = false;
  for (int r = std::max(0, row - 2); r <= std::min(board.rows - 1, row + 2); ++r) {
    for (int c = std::max(0, column - 2); c <= std::min(board.columns - 1, column + 2); ++c) {
      const int id = r * board.columns + c;
      const std::optional<Quad>& tag = tags[static_cast<size_t>(id)];
      if (!tag) continue;
      has_neighbour = has_neighbour || (std::abs(r - row) <= 1 && std::abs(c - column) <= 1);
      for (int corner = 0; corner < 4; ++corner) {
        from.emplace_back(points_g(0, 4 * id + corner), points_g(1, 4 * id + corner));
        to.emplace_back((*tag)(0, corner), (*tag)(1, corner));
      }
    }
  }
  if (!has_neighbour) return std::nullopt;
  const cv::Mat H = cv::findHomography(from, to, 0);
  if (H.empty()) return std::nullopt;
  const cv::Matx33d matrix(H);
  Quad expected;
  for (int corner = 0; corner < 4; ++corner) {
    const Eigen::Index k = 4 * (row * board.columns + column) + corner;
    const cv::Vec3d h = matrix * cv::Vec3d(points_g(0, k), points_g(1, k), 1.0);
    expected.col(corner) << h[0] / h[2], h[1] / h[2];
  }
  return expected;
}

bool IsInside(const Quad& quad, Resolution resolution) {
  return (quad.array() >= 0.0).all() && (quad.row(0).array() <= resolution.width - 1).all() &&
         (quad.row(1).array() <= resolution.height - 1).all();
}

// Adds the tags that were not found but are where their neighbours make them expected.
void AddExpectedTags(const GreyImage& image, const SaddleField& field, const AprilGrid& board,
                     const Eigen::Matrix3Xd& points_g, Tags* tags) {
  const MarkerCodes& codes = CodesOf(kFamily);
  for (bool has_grown = true; has_grown;) {
    has_grown = false;
    for (int row = 0; row < board.rows; ++row) {
      for (int column = 0; column < board.columns; ++column) {
        const int id = row * board.columns + column;
        if ((*tags)[static_cast<size_t>(id)]) continue;
        std::optional<Quad> expected = Expected(*tags, board, points_g, row, column);
        if (!expected || !IsInside(*expected, image.resolution)) continue;
        const double side = (expected->col(1) - expected->col(0)).norm();
        const double reach = 0.3 * std::min(1.0, board.tag_spacing) * side;
        for (int corner = 0; corner < 4; ++corner) {
          const std::optional<int> near = field.NearestTo(expected->col(corner), reach);
          if (near) expected->col(corner) = field.saddle(*near).pixel;
        }
        const std::optional<MarkerCode> code =
            ReadMarker(image, FromBoardOrder(*expected), kLayout);
        if (!code || codes.CountErrors(*code, id, 0) > kMaxErrorsWhereExpected) continue;
        (*tags)[static_cast<size_t>(id)] = expected;
        has_grown = true;
      }
    }
  }
}

// Whether neighbouring tags are one step apart, as the tags' own sides tell, in at least four of
// five cases. A tag that was misread, or a board whose rows and columns are swapped, shows.
bool AreLaidOutAs(const AprilGrid& board, const Tags& tags) {
  constexpr double kMaxSurprise = 0.5;  // of a step
  int num_good = 0;
  int num_pairs = 0;
  const auto compare = [&](int id, int next_id, int along) {
    const std::optional<Quad>& tag = tags[static_cast<size_t>(id)];
    const std::optional<Quad>& next = tags[static_cast<size_t>(next_id)];
    if (!tag || !next) return;
    // The side from corner 0 to 1 is along x, that to 3 along y.
    const Eigen::Vector2d step = (1.0 + board.tag_spacing) * (tag->col(along) - tag->col(0));
    const Eigen::Vector2d surprise = next->rowwise().mean() - tag->rowwise().mean() - step;
    ++num_pairs;
    if (surprise.norm() < kMaxSurprise * step.norm()) ++num_good;
  };
  for (int row = 0; row < board.rows; ++row) {
    for (int column = 0; column < board.columns; ++column) {
      const int id = row * board.columns + column;
      if (column + 1 < board.columns) compare(id, id + 1, 1);
      if (row + 1 < board.rows) compare(id, id + board.columns, 3);
    }
  }
  return 5 * num_good >= 4 * num_pairs;
}

// A finer search finds smaller tags, and sees what else there is more often.
Reading Search(const GreyImage& image, const AprilGrid& board, const Eigen::Matrix3Xd& points_g) {
  Reading all;
  all.tags.resize(static_cast<size_t>(board.rows) * static_cast<size_t>(board.columns));
  const std::vector<int> reductions = ReductionsToSearch(image.resolution);
  for (const int reduction : reductions) {
    const bool is_coarsest = reduction == reductions.back();
    if (all.num_tags() == static_cast<int>(all.tags.size())) break;
    if (is_coarsest && all.num_tags() > 0) break;
    const SaddleField field(FindSaddles(image, reduction));
    const Reading reading = ReadTags(image, FindDarkQuads(field), board);
    for (size_t id = 0; id < all.tags.size(); ++id) {
      if (!all.tags[id]) all.tags[id] = reading.tags[id];
    }
    AddExpectedTags(image, field, board, points_g, &all.tags);
    all.num_mirrored = std::max(all.num_mirrored, reading.num_mirrored);
    all.seen_twice.insert(reading.seen_twice.begin(), reading.seen_twice.end());
    all.rejected.tags_not_on_board =
        std::max(all.rejected.tags_not_on_board, reading.rejected.tags_not_on_board);
    all.rejected.tags_of_another_family =
        std::max(all.rejected.tags_of_another_family, reading.rejected.tags_of_another_family);
  }
  for (const size_t id : all.seen_twice) all.tags[id].reset();
  all.rejected.tags_seen_twice = static_cast<int>(all.seen_twice.size());
  return all;
}

}  // namespace

std::optional<BoardView> FindAprilGrid(const GreyImage& image, const AprilGrid& board,
                                       RejectionCounts* rejected) {
  const Eigen::Matrix3Xd points_g = BoardPoints(board);
  Reading found = Search(image, board, points_g);
  *rejected += found.rejected;
  if (found.num_mirrored > found.num_tags()) {
    ++rejected->images_with_mirrored_board;
    return std::nullopt;
  }
  if (found.rejected.tags_seen_twice > found.num_tags()) {
    ++rejected->images_with_two_boards;
    return std::nullopt;
  }
  if (!AreLaidOutAs(board, found.tags)) {
    ++rejected->images_with_other_layout;
    return std::nullopt;
  }

  std::vector<std::optional<Eigen::Vector2d>> corners(static_cast<size_t>(points_g.cols()));
  std::vector<Eigen::Index> ids;
  for (size_t id = 0; id < found.tags.size(); ++id) {
    for (Eigen::Index corner = 0; found.tags[id] && corner < 4; ++corner) {
      ids.push_back(static_cast<Eigen::Index>(4 * id) + corner);
    }
  }
  if (ids.empty()) return std::nullopt;
  const Eigen::Matrix2Xd board_corners = points_g(Eigen::seqN(0, 2), ids);
  Eigen::Matrix2Xd pixels(2, board_corners.cols());
  for (Eigen::Index k = 0; k < pixels.cols(); ++k) {
    const Eigen::Index id = ids[static_cast<size_t>(k)];
    pixels.col(k) = found.tags[static_cast<size_t>(id / 4)]->col(id % 4);
  }
  // Ahead of a lower left corner is the tag, of an upper right one the small square.
  std::vector<bool> is_dark_ahead;
  for (const Eigen::Index id : ids) is_dark_ahead.push_back(id % 2 == 0);
  const double gap = std::min(1.0, board.tag_spacing) * board.tag_size_m;
  const std::vector<std::optional<Eigen::Vector2d>> refined =
      RefineCorners(image, board_corners, pixels, is_dark_ahead,
                    {{gap, gap}, std::min(gap, kBorderShare * board.tag_size_m)}, rejected);
  for (size_t k = 0; k < ids.size(); ++k) corners[static_cast<size_t>(ids[k])] = refined[k];
  return ViewOf(corners, points_g);
}

}  // namespace calibrato
