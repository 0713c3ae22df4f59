#include "calibrato/detection/disc_numbering.h"

#include <Eigen/LU>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "calibrato/detection/lens_map.h"

namespace calibrato {
namespace {

// How far from where it should be a disc may lie, of the shorter step to the next one.
constexpr double kMaxMisplacement = 1.0 / 7.0;
constexpr double kMinMisplacement = 1.0;  // [px]; blobs are no more exact
// The areas of blobs are those of whole pixels.
constexpr double kMaxAreaRatio = 1.6;
constexpr double kBorder = 2.0;  // [px]; blur reaches beyond a disc's edge
constexpr size_t kMinDiscs = 8;  // for a lens that can contradict a disc

std::vector<Eigen::Index> NumbersOf(const DiscNumbering& numbering) {
  std::vector<Eigen::Index> numbers;
  for (size_t k = 0; k < numbering.size(); ++k) {
    if (numbering[k] >= 0) numbers.push_back(static_cast<Eigen::Index>(k));
  }
  return numbers;
}

class Mender {
 public:
  Mender(const Eigen::Matrix2Xd& board, const std::vector<DarkBlob>& blobs, const PointIndex& index,
         const Resolution& resolution)
      : board_(board), blobs_(blobs), index_(index), resolution_(resolution) {
    const Eigen::Index middle = board.cols() / 2;
    step_m_ = std::numeric_limits<double>::infinity();
    for (Eigen::Index k = 0; k < board.cols(); ++k) {
      if (k != middle) step_m_ = std::min(step_m_, (board.col(k) - board.col(middle)).norm());
    }
  }

  // The lens, after the discs that contradict it were taken out, the worst first.
  std::optional<LensMap> TakeOutMisplaced(DiscNumbering* numbering) const {
    while (true) {
      const std::vector<Eigen::Index> numbers = NumbersOf(*numbering);
      if (numbers.size() < kMinDiscs) return std::nullopt;
      Eigen::Matrix2Xd pixels(2, static_cast<Eigen::Index>(numbers.size()));
      for (Eigen::Index i = 0; i < pixels.cols(); ++i) {
        pixels.col(i) = Pixel(*numbering, numbers[static_cast<size_t>(i)]);
      }
      const std::optional<LensMap> lens =
          FitLensMap(board_(Eigen::all, numbers), pixels, 0.0, resolution_);
      if (!lens) return std::nullopt;
      std::vector<double> misplacements;
      for (const Eigen::Index k : numbers) {
        const Eigen::Vector2d pixel = Pixel(*numbering, k);
        const std::optional<LocalMap> map = lens->Around(board_.col(k), pixel);
        if (!map) return std::nullopt;
        misplacements.push_back((map->pixel - pixel).norm() / Allowed(*map));
      }
      const double worst = *std::max_element(misplacements.begin(), misplacements.end());
      if (!(worst > 1.0)) return lens;
      // One at a time would take long where there are many.
      for (size_t i = 0; i < numbers.size(); ++i) {
        if (misplacements[i] > std::max(1.0, 0.5 * worst)) {
          (*numbering)[static_cast<size_t>(numbers[i])] = -1;
        }
      }
    }
  }

  struct Search {
    bool is_any_found = false;
    int num_near_border = 0;  // of those that were not
  };
  Search PutInMissing(const LensMap& lens, DiscNumbering* numbering) const {
    const std::vector<Eigen::Index> numbers = NumbersOf(*numbering);
    std::vector<bool> is_taken(blobs_.size(), false);
    std::vector<double> areas_m2;
    for (const Eigen::Index k : numbers) {
      const auto blob = static_cast<size_t>((*numbering)[static_cast<size_t>(k)]);
      is_taken[blob] = true;
      const std::optional<LocalMap> map = lens.Around(board_.col(k), blobs_[blob].pixel);
      if (map) areas_m2.push_back(blobs_[blob].area / std::abs(map->J_pixel_board.determinant()));
    }
    const auto middle = areas_m2.begin() + static_cast<std::ptrdiff_t>(areas_m2.size() / 2);
    std::nth_element(areas_m2.begin(), middle, areas_m2.end());
    Search search;
    for (size_t k = 0; k < numbering->size(); ++k) {
      if ((*numbering)[k] >= 0) continue;
      const Eigen::Vector2d place = board_.col(static_cast<Eigen::Index>(k));
      const Eigen::Index neighbour =
          *std::min_element(numbers.begin(), numbers.end(), [&](Eigen::Index a, Eigen::Index b) {
            return (board_.col(a) - place).norm() < (board_.col(b) - place).norm();
          });
      const std::optional<LocalMap> map = lens.Around(place, Pixel(*numbering, neighbour));
      if (!map) continue;
      const double area = *middle * std::abs(map->J_pixel_board.determinant());
      double nearest = Allowed(*map);
      int best = -1;
      index_.VisitNear(map->pixel, nearest, [&](int blob) {
        const DarkBlob& other = blobs_[static_cast<size_t>(blob)];
        const double distance = (other.pixel - map->pixel).norm();
        if (!(distance < nearest) || is_taken[static_cast<size_t>(blob)]) return;
        if (!(other.area < kMaxAreaRatio * area && area < kMaxAreaRatio * other.area)) return;
        nearest = distance;
        best = blob;
      });
      if (best < 0) {
        if (LeavesImage(*map, std::sqrt(*middle / std::numbers::pi))) ++search.num_near_border;
        continue;
      }
      (*numbering)[k] = best;
      is_taken[static_cast<size_t>(best)] = true;
      search.is_any_found = true;
    }
    return search;
  }

 private:
  const Eigen::Vector2d& Pixel(const DiscNumbering& numbering, Eigen::Index k) const {
    return blobs_[static_cast<size_t>(numbering[static_cast<size_t>(k)])].pixel;
  }

  double Allowed(const LocalMap& map) const {
    const double step = step_m_ * map.J_pixel_board.colwise().norm().minCoeff();
    return std::max(kMinMisplacement, kMaxMisplacement * step);
  }

  bool LeavesImage(const LocalMap& map, double radius_m) const {
    const Eigen::Vector2d extent = radius_m * map.J_pixel_board.rowwise().norm();
    const Eigen::Vector2d low = map.pixel - extent;
    const Eigen::Vector2d high = map.pixel + extent;
    return !(low.minCoeff() >= kBorder && high.x() <= resolution_.width - 1 - kBorder &&
             high.y() <= resolution_.height - 1 - kBorder);
  }

  const Eigen::Matrix2Xd& board_;
  const std::vector<DarkBlob>& blobs_;
  const PointIndex& index_;
  const Resolution& resolution_;
  double step_m_;
};

}  // namespace

MendedNumbering Mended(const DiscNumbering& numbering, const Eigen::Matrix2Xd& board,
                       const std::vector<DarkBlob>& blobs, const PointIndex& index,
                       const Resolution& resolution) {
  assert(numbering.size() == static_cast<size_t>(board.cols()));
  const Mender mender(board, blobs, index, resolution);
  MendedNumbering mended{numbering};
  // Those that were put in make the lens more certain, so that the next ones are found.
  constexpr int kMaxRounds = 4;
  for (int round = 0; round < kMaxRounds; ++round) {
    const std::optional<LensMap> lens = mender.TakeOutMisplaced(&mended.numbering);
    if (!lens) return {numbering};
    const Mender::Search search = mender.PutInMissing(*lens, &mended.numbering);
    mended.num_near_border = search.num_near_border;
    if (!search.is_any_found) return mended;
  }
  return mended;
}

}  // namespace calibrato
