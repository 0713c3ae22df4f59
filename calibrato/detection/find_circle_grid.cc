#include "calibrato/detection/find_circle_grid.h"

#include <Eigen/LU>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdlib>
#include <map>
#include <utility>
#include <vector>

#include "calibrato/detection/corner_view.h"
#include "calibrato/detection/dark_blobs.h"
#include "calibrato/detection/disc_centres.h"
#include "calibrato/detection/disc_numbering.h"
#include "calibrato/detection/lattice.h"

namespace calibrato {
namespace {

// Discs one step apart are about equally large in the image.
constexpr double kMaxAreaRatio = 2.0;

// In how many lattices of more discs than the board has a disc may have been before it is no longer
// started from. From one or another disc at an oblique board's edge the growth goes astray, so one
// is not enough; without a limit a wall of n discs would be grown n times. Smaller lattices are
// grown soon, and from another of their discs they may turn out to be the board.
constexpr int kMaxWalls = 6;

// A disc's place in the lattice of all discs, in integers. The discs of an asymmetric grid are on
// the diagonals of a finer square lattice, which are a square lattice of their own.
Eigen::Vector2i LatticePlace(const CircleGrid& board, int row, int column) {
  if (!board.asymmetric) return {row, column};
  const int x = 2 * column + row % 2;
  return {(x + row) / 2, (x - row) / 2};  // x and row are both even or both odd
}

// The two shortest steps from a blob to its like that are far from parallel. Seen from the side
// they may be other steps than along rows and columns, but they span the same lattice.
std::optional<LatticeSeed> SeedAt(int k, const std::vector<DarkBlob>& blobs,
                                  const std::vector<Eigen::Vector2d>& points,
                                  const PointIndex& index) {
  constexpr double kMinSine = 0.5;
  const DarkBlob& here = blobs[static_cast<size_t>(k)];
  const double size = std::sqrt(here.area);
  std::vector<std::pair<double, int>> near;
  for (double radius = 3.0 * size; radius < 20.0 * size && near.size() < 4; radius *= 2.0) {
    near.clear();
    index.VisitNear(here.pixel, radius, [&](int other) {
      const double distance = (points[static_cast<size_t>(other)] - here.pixel).norm();
      const double ratio = blobs[static_cast<size_t>(other)].area / here.area;
      if (other == k || distance > radius) return;
      if (ratio > kMaxAreaRatio || ratio * kMaxAreaRatio < 1.0) return;
      near.emplace_back(distance, other);
    });
  }
  if (near.size() < 2) return std::nullopt;
  std::sort(near.begin(), near.end());
  LatticeSeed seed;
  seed.point = k;
  const Eigen::Vector2d first = points[static_cast<size_t>(near[0].second)] - here.pixel;
  for (const auto& [distance, other] : near) {
    seed.steps << first, points[static_cast<size_t>(other)] - here.pixel;
    if (std::abs(seed.steps.determinant()) > kMinSine * first.norm() * distance) return seed;
  }
  return std::nullopt;
}

// The lattice's coordinates may be any that span it: all matrices of integers up to 2 and
// determinant +-1 are tried.
std::vector<Eigen::Matrix2i> ChangesOfBasis() {
  std::vector<Eigen::Matrix2i> changes;
  for (int a = -2; a <= 2; ++a) {
    for (int b = -2; b <= 2; ++b) {
      for (int c = -2; c <= 2; ++c) {
        for (int d = -2; d <= 2; ++d) {
          if (std::abs(a * d - b * c) != 1) continue;
          changes.push_back((Eigen::Matrix2i() << a, b, c, d).finished());
        }
      }
    }
  }
  return changes;
}

// How many blobs beside the board's discs may have been taken for some of them.
size_t MaxLeftOver(const CircleGrid& board) {
  return static_cast<size_t>(std::min(board.rows, board.columns)) / 2;
}

using Places = std::map<std::pair<int, int>, int>;

// All ways to number a lattice's blobs as the board's discs: with at most a tenth of them missing
// and next to none left over.
std::vector<DiscNumbering> NumberingsOf(const std::vector<LatticeNode>& nodes,
                                        const CircleGrid& board) {
  std::vector<Eigen::Vector2i> places;
  for (int row = 0; row < board.rows; ++row) {
    for (int column = 0; column < board.columns; ++column) {
      places.push_back(LatticePlace(board, row, column));
    }
  }
  std::vector<DiscNumbering> numberings;
  const size_t num_discs = places.size();
  const size_t max_left_over = MaxLeftOver(board);
  if (10 * nodes.size() < 9 * num_discs || nodes.size() > num_discs + max_left_over) return {};
  Eigen::Vector2i board_low = places.front();
  Eigen::Vector2i board_high = places.front();
  for (const Eigen::Vector2i& place : places) {
    board_low = board_low.cwiseMin(place);
    board_high = board_high.cwiseMax(place);
  }
  size_t most = 0;
  for (const Eigen::Matrix2i& change : ChangesOfBasis()) {
    const auto place_of = [&](const LatticeNode& node) -> Eigen::Vector2i {
      return change * Eigen::Vector2i(node.row, node.column);
    };
    Eigen::Vector2i low = Eigen::Vector2i::Constant(1 << 20);
    Eigen::Vector2i high = -low;
    for (const LatticeNode& node : nodes) {
      low = low.cwiseMin(place_of(node));
      high = high.cwiseMax(place_of(node));
    }
    const Eigen::Vector2i first = low - board_low;
    const Eigen::Vector2i last = high - board_high;
    // A missing or a left-over row moves the box by one or two.
    if ((first - last).cwiseAbs().maxCoeff() > 2) continue;
    Places blobs;
    for (const LatticeNode& node : nodes) {
      const Eigen::Vector2i place = place_of(node);
      blobs[{place.x(), place.y()}] = node.point;
    }
    const Eigen::Vector2i begin = first.cwiseMin(last);
    const Eigen::Vector2i end = first.cwiseMax(last);
    for (int x = begin.x(); x <= end.x(); ++x) {
      for (int y = begin.y(); y <= end.y(); ++y) {
        DiscNumbering numbering;
        size_t found = 0;
        for (const Eigen::Vector2i& place : places) {
          const auto blob = blobs.find({place.x() + x, place.y() + y});
          numbering.push_back(blob == blobs.end() ? -1 : blob->second);
          found += blob == blobs.end() ? 0 : 1;
        }
        if (10 * found < 9 * num_discs || found + max_left_over < nodes.size()) continue;
        if (found < most) continue;
        if (found > most) numberings.clear();
        most = found;
        numberings.push_back(std::move(numbering));
      }
    }
  }
  return numberings;
}

// The affine map from the board to the image that fits best: 2 x 3, of (x, y, 1).
Eigen::Matrix<double, 2, 3> AffineFit(const DiscNumbering& numbering,
                                      const std::vector<Eigen::Vector2d>& points,
                                      const Eigen::Matrix3Xd& points_g) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Matrix<double, 3, 2> right = Eigen::Matrix<double, 3, 2>::Zero();
  for (size_t k = 0; k < numbering.size(); ++k) {
    if (numbering[k] < 0) continue;
    const Eigen::Vector3d terms(points_g(0, static_cast<Eigen::Index>(k)),
                                points_g(1, static_cast<Eigen::Index>(k)), 1.0);
    normal += terms * terms.transpose();
    right += terms * points[static_cast<size_t>(numbering[k])].transpose();
  }
  return (normal.inverse() * right).transpose();
}

struct Grid {
  DiscNumbering numbering;
  Eigen::Matrix<double, 2, 3> affine;
};

}  // namespace

std::optional<BoardView> FindCircleGrid(const GreyImage& image, const CircleGrid& board,
                                        RejectionCounts* rejected) {
  assert(board.rows >= 3 && board.columns >= 3);
  const std::vector<DarkBlob> blobs = FindDarkBlobs(image);
  std::vector<Eigen::Vector2d> points;
  for (const DarkBlob& blob : blobs) points.push_back(blob.pixel);
  const PointIndex index(points);
  const Eigen::Matrix3Xd points_g = BoardPoints(board);
  std::vector<bool> is_taken(blobs.size(), false);
  const auto may_be_neighbours = [&](int from, int to) {
    const double ratio =
        blobs[static_cast<size_t>(from)].area / blobs[static_cast<size_t>(to)].area;
    return !is_taken[static_cast<size_t>(to)] && ratio <= kMaxAreaRatio &&
           ratio * kMaxAreaRatio >= 1.0;
  };
  const size_t max_nodes = static_cast<size_t>(points_g.cols()) + MaxLeftOver(board);
  std::vector<int> num_walls(blobs.size(), 0);
  std::vector<Grid> grids;
  int num_mirrored = 0;
  for (size_t k = 0; k < blobs.size(); ++k) {
    if (is_taken[k] || num_walls[k] >= kMaxWalls) continue;
    const std::optional<LatticeSeed> seed = SeedAt(static_cast<int>(k), blobs, points, index);
    if (!seed) continue;
    const std::vector<LatticeNode> nodes = GrowLattice(points, index, *seed, may_be_neighbours);
    const std::vector<DiscNumbering> numberings = NumberingsOf(nodes, board);
    if (numberings.empty()) {
      if (nodes.size() <= max_nodes) continue;
      for (const LatticeNode& node : nodes) ++num_walls[static_cast<size_t>(node.point)];
      continue;
    }
    for (const LatticeNode& node : nodes) is_taken[static_cast<size_t>(node.point)] = true;
    std::optional<Grid> best;
    for (const DiscNumbering& numbering : numberings) {
      const Eigen::Matrix<double, 2, 3> affine = AffineFit(numbering, points, points_g);
      // z of the board points to the camera where x, y are left-handed in (u, v), v being down.
      if (!(affine.leftCols<2>().determinant() < 0.0)) continue;
      if (!best || affine.col(2).squaredNorm() < best->affine.col(2).squaredNorm()) {
        best = Grid{numbering, affine};
      }
    }
    if (best) {
      grids.push_back(*std::move(best));
    } else {
      ++num_mirrored;
    }
  }
  if (grids.size() > 1) ++rejected->images_with_two_boards;
  if (grids.empty() && num_mirrored > 0) ++rejected->images_with_mirrored_board;
  if (grids.size() != 1) return std::nullopt;

  const Eigen::Matrix2Xd board_points = points_g.topRows<2>();
  const auto [numbering, num_near_border] =
      Mended(grids.front().numbering, board_points, blobs, index, image.resolution);
  std::vector<Eigen::Index> ids;
  for (size_t k = 0; k < numbering.size(); ++k) {
    if (numbering[k] >= 0) ids.push_back(static_cast<Eigen::Index>(k));
  }
  const auto count = static_cast<Eigen::Index>(ids.size());
  rejected->corners_near_border += num_near_border;
  rejected->corners_of_bad_fit += static_cast<int>(points_g.cols() - count) - num_near_border;
  Eigen::Matrix2Xd pixels(2, count);
  Eigen::VectorXd areas(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const int blob = numbering[static_cast<size_t>(ids[static_cast<size_t>(i)])];
    pixels.col(i) = points[static_cast<size_t>(blob)];
    areas(i) = blobs[static_cast<size_t>(blob)].area;
  }
  if (count < 8) return std::nullopt;
  const std::vector<std::optional<Eigen::Vector2d>> centres =
      FindDiscCentres(image, board_points(Eigen::all, ids), pixels, areas, rejected);
  std::vector<std::optional<Eigen::Vector2d>> corners(static_cast<size_t>(points_g.cols()));
  for (size_t i = 0; i < ids.size(); ++i) corners[static_cast<size_t>(ids[i])] = centres[i];
  std::optional<BoardView> view = ViewOf(corners, points_g);
  // Where a third is out of place, it was not the board.
  if (view && 3 * view->num_corners() < 2 * points_g.cols()) return std::nullopt;
  return view;
}

}  // namespace calibrato
