#include "calibrato/detection/find_charuco.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <utility>
#include <vector>

#include "calibrato/detection/corner_refinement.h"
#include "calibrato/detection/corner_view.h"
#include "calibrato/detection/lattice.h"
#include "calibrato/detection/marker_code.h"
#include "calibrato/detection/saddle_field.h"
#include "calibrato/detection/saddle_search.h"

namespace calibrato {
namespace {

constexpr double kFreeShare = 0.85;  // of a square's side, along the edges from a corner
constexpr int kMinVotes = 2;

// What else may be in the squares: one dictionary of each size, of which few codes arise by chance.
constexpr const char* kOtherDictionaries[] = {"DICT_4X4_50", "DICT_5X5_1000", "DICT_6X6_1000",
                                              "DICT_7X7_1000", "DICT_APRILTAG_36h11"};

// Place of a corner on the board, (row, column) of inner corners, or in a lattice.
using Place = std::array<int, 2>;

// How places in a lattice become places on the board: place = M * (row, column) + t.
struct Placement {
  std::array<int, 4> M;  // row by row
  Place t;
  auto operator<=>(const Placement&) const = default;

  Place At(int row, int column) const {
    return {M[0] * row + M[1] * column + t[0], M[2] * row + M[3] * column + t[1]};
  }
};

// The squares that carry markers, in the order of their numbers.
std::vector<Place> MarkedSquares(const Charuco& board) {
  std::vector<Place> squares;
  for (int row = 0; row < board.rows; ++row) {
    for (int column = 0; column < board.columns; ++column) {
      if ((row + column) % 2 == 1) squares.push_back({row, column});
    }
  }
  return squares;
}

// A square of the lattice with all four corners, clockwise as the image shows it.
struct Cell {
  std::array<Place, 4> places;
  Eigen::Matrix<double, 2, 4> pixels;
};

std::vector<Cell> CellsOf(const std::vector<LatticeNode>& nodes, const SaddleField& field) {
  std::map<Place, Eigen::Vector2d> pixels;
  for (const LatticeNode& node : nodes) {
    pixels[{node.row, node.column}] = field.saddle(node.point).pixel;
  }
  std::vector<Cell> cells;
  for (const auto& [place, pixel] : pixels) {
    const auto [row, column] = place;
    Cell cell;
    cell.places = {Place{row, column}, {row, column + 1}, {row + 1, column + 1}, {row + 1, column}};
    if (!std::all_of(cell.places.begin(), cell.places.end(),
                     [&](const Place& corner) { return pixels.contains(corner); })) {
      continue;
    }
    const Eigen::Vector2d a = pixels.at(cell.places[1]) - pixel;
    const Eigen::Vector2d b = pixels.at(cell.places[3]) - pixel;
    const bool is_clockwise = a.x() * b.y() - a.y() * b.x() > 0.0;  // v points down
    if (!is_clockwise) std::swap(cell.places[1], cell.places[3]);
    for (size_t k = 0; k < 4; ++k) {
      cell.pixels.col(static_cast<Eigen::Index>(k)) = pixels.at(cell.places[k]);
    }
    cells.push_back(cell);
  }
  return cells;
}

// Where the lattice lies on the board if one of its cells is this square, turned like this.
Placement PlacementOf(const Cell& cell, const Place& square, int turn) {
  const auto [row, column] = square;
  // The square's corners clockwise from its top left, as inner corners of the board.
  const std::array<Place, 4> corners = {
      Place{row - 1, column - 1}, {row - 1, column}, {row, column}, {row, column - 1}};
  const auto corner = [&](size_t k) { return corners[(k + static_cast<size_t>(turn)) % 4]; };
  // The places' first and second step are unit vectors, along one coordinate each.
  Placement placement{};
  for (const size_t k : {size_t{1}, size_t{3}}) {
    const int step_row = cell.places[k][0] - cell.places[0][0];
    const int step_column = cell.places[k][1] - cell.places[0][1];
    for (size_t i = 0; i < 2; ++i) {
      const int change = corner(k)[i] - corner(0)[i];
      placement.M[2 * i] += change * step_row;
      placement.M[2 * i + 1] += change * step_column;
    }
  }
  const Place from_origin = placement.At(cell.places[0][0], cell.places[0][1]);
  placement.t = {corner(0)[0] - from_origin[0], corner(0)[1] - from_origin[1]};
  return placement;
}

struct Vote {
  Cell cell;
  Placement placement;
};

struct Markers {
  std::vector<Vote> votes;
  int num_mirrored = 0;
  RejectionCounts rejected;
};

bool IsOfAnotherDictionary(const GreyImage& image, const Cell& cell, MarkerLayout layout) {
  return std::any_of(std::begin(kOtherDictionaries), std::end(kOtherDictionaries),
                     [&](const char* name) {
                       layout.bits_per_side = CodesOf(name).bits_per_side();
                       const auto code = ReadMarker(image, cell.pixels, layout);
                       return code && CodesOf(name).Identify(*code, 0);
                     });
}

Markers ReadMarkers(const GreyImage& image, const std::vector<Cell>& cells, const Charuco& board) {
  const MarkerCodes& codes = CodesOf(board.dictionary);
  const MarkerLayout layout{codes.bits_per_side(), 1,
                            0.5 * (1.0 - board.marker_size_m / board.square_size_m)};
  const int max_errors = codes.bits_per_side() * codes.bits_per_side() / 12;
  const std::vector<Place> squares = MarkedSquares(board);
  Markers markers;
  for (const Cell& cell : cells) {
    const std::optional<MarkerCode> code = ReadMarker(image, cell.pixels, layout);
    const std::optional<MarkerMatch> match =
        code ? codes.Identify(*code, max_errors) : std::nullopt;
    if (match && static_cast<size_t>(match->id) < squares.size()) {
      markers.votes.push_back(
          {cell, PlacementOf(cell, squares[static_cast<size_t>(match->id)], match->turn)});
    } else if (match) {
      ++markers.rejected.tags_not_on_board;
    } else if (code && codes.Identify(codes.Mirrored(*code), 0)) {
      ++markers.num_mirrored;
    } else if (IsOfAnotherDictionary(image, cell, layout)) {
      ++markers.rejected.tags_of_another_family;
    }
  }
  return markers;
}

// What one search of the image gave.
struct Reading {
  PixelGrid corners;
  int num_corners = 0;
  int num_seen = 0;  // markers, whether they are of use or not
  RejectionCounts rejected;
};

// Whether all four corners of a marker's square are inner corners of the board.
bool AreInside(const Vote& vote, int rows, int columns) {
  return std::all_of(vote.cell.places.begin(), vote.cell.places.end(), [&](const Place& place) {
    const auto [row, column] = vote.placement.At(place[0], place[1]);
    return row >= 0 && row < rows && column >= 0 && column < columns;
  });
}

Reading Read(const GreyImage& image, const Charuco& board, int reduction) {
  const int rows = board.rows - 1;
  const int columns = board.columns - 1;
  Reading reading;
  reading.corners.resize(static_cast<size_t>(rows) * static_cast<size_t>(columns));
  const SaddleField field(FindSaddles(image, reduction));
  int num_mirrored = 0;
  int num_placed = 0;
  bool has_conflict = false;
  for (const std::vector<LatticeNode>& nodes : SaddleLattices(field, 4)) {
    const Markers markers = ReadMarkers(image, CellsOf(nodes, field), board);
    const auto num_votes = static_cast<int>(markers.votes.size());
    reading.rejected += markers.rejected;
    reading.num_seen += num_votes + markers.num_mirrored + markers.rejected.tags_not_on_board +
                        markers.rejected.tags_of_another_family;
    num_mirrored += markers.num_mirrored;
    std::map<Placement, int> counts;
    for (const Vote& vote : markers.votes) ++counts[vote.placement];
    const auto best =
        std::max_element(counts.begin(), counts.end(),
                         [](const auto& a, const auto& b) { return a.second < b.second; });
    if (best == counts.end() || best->second < kMinVotes) continue;
    // A marker in a border square of the target that has corners further out: the board in view is
    // larger than the target says.
    const bool is_larger =
        std::any_of(markers.votes.begin(), markers.votes.end(), [&](const Vote& vote) {
          return vote.placement == best->first && !AreInside(vote, rows, columns);
        });
    if (5 * best->second < 4 * num_votes || is_larger) {
      ++reading.rejected.images_with_other_layout;
      continue;
    }
    ++num_placed;
    // Corners that no marker vouches for are looked for again, where the others make them expected.
    std::map<Place, Eigen::Vector2d> vouched;
    for (const Vote& vote : markers.votes) {
      if (vote.placement != best->first) continue;
      for (size_t k = 0; k < 4; ++k) {
        const auto [row, column] = vote.cell.places[k];
        vouched[vote.placement.At(row, column)] =
            vote.cell.pixels.col(static_cast<Eigen::Index>(k));
      }
    }
    for (const auto& [place, pixel] : vouched) {
      const auto [row, column] = place;
      auto& corner = reading.corners[static_cast<size_t>(row) * static_cast<size_t>(columns) +
                                     static_cast<size_t>(column)];
      has_conflict = has_conflict || corner.has_value();
      corner = pixel;
    }
  }
  if (has_conflict) {
    reading.rejected.images_with_two_boards = 1;
    std::fill(reading.corners.begin(), reading.corners.end(), std::nullopt);
  }
  if (num_placed == 0 && num_mirrored >= kMinVotes) reading.rejected.images_with_mirrored_board = 1;
  reading.rejected.images_with_other_layout =
      std::min(1, reading.rejected.images_with_other_layout);
  reading.num_corners =
      static_cast<int>(std::count_if(reading.corners.begin(), reading.corners.end(),
                                     [](const auto& corner) { return corner.has_value(); }));
  return reading;
}

}  // namespace

std::optional<BoardView> FindCharuco(const GreyImage& image, const Charuco& board,
                                     RejectionCounts* rejected) {
  const Eigen::Matrix3Xd points_g = BoardPoints(board);
  Reading best;
  for (const int reduction : ReductionsToSearch(image.resolution)) {
    Reading reading = Read(image, board, reduction);
    if (reading.rejected.images_with_two_boards > 0) {
      *rejected += reading.rejected;
      return std::nullopt;
    }
    if (std::pair(reading.num_corners, reading.num_seen) >
        std::pair(best.num_corners, best.num_seen)) {
      best = std::move(reading);
    }
    if (best.num_corners == points_g.cols()) break;
  }
  *rejected += best.rejected;
  if (best.num_corners < 4) return std::nullopt;

  PixelGrid known = best.corners;
  for (int round = 0; round < 2; ++round) {
    known = WithGapsFilled(known, board.rows - 1, board.columns - 1);
  }
  std::vector<Eigen::Index> ids;
  for (size_t k = 0; k < known.size(); ++k) {
    const bool is_inside = known[k] && known[k]->minCoeff() >= 0.0 &&
                           known[k]->x() <= image.resolution.width - 1 &&
                           known[k]->y() <= image.resolution.height - 1;
    if (is_inside) ids.push_back(static_cast<Eigen::Index>(k));
  }
  Eigen::Matrix2Xd pixels(2, static_cast<Eigen::Index>(ids.size()));
  for (size_t i = 0; i < ids.size(); ++i) {
    pixels.col(static_cast<Eigen::Index>(i)) = *known[static_cast<size_t>(ids[i])];
  }
  // Ahead of corner (row, column) is square (row + 1, column + 1), and (0, 0) is black.
  std::vector<bool> is_dark_ahead;
  for (const Eigen::Index id : ids) {
    is_dark_ahead.push_back((id / (board.columns - 1) + id % (board.columns - 1)) % 2 == 0);
  }
  const double free_edge = kFreeShare * board.square_size_m;
  const std::vector<std::optional<Eigen::Vector2d>> refined = RefineCorners(
      image, points_g(Eigen::seqN(0, 2), ids), pixels, is_dark_ahead,
      {{free_edge, free_edge}, 0.5 * (board.square_size_m - board.marker_size_m)}, rejected);
  std::vector<std::optional<Eigen::Vector2d>> corners(known.size());
  for (size_t i = 0; i < ids.size(); ++i) corners[static_cast<size_t>(ids[i])] = refined[i];
  return ViewOf(corners, points_g);
}

}  // namespace calibrato
