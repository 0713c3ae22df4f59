#include "calibrato/detection/detect.h"

#include <algorithm>
#include <cassert>
#include <numeric>
#include <opencv2/core/utility.hpp>
#include <utility>

#include "calibrato/base/input_error.h"
#include "calibrato/base/parallel.h"
#include "calibrato/base/progress.h"
#include "calibrato/detection/find_checkerboard.h"

namespace calibrato {
namespace {

// How many images are searched for another board when the board was in none.
constexpr size_t kImagesSearchedAgain = 5;

// Boards that people mean when they write another one: squares counted instead of inner corners,
// one row or column too many or too few. (Rows and columns swapped is the same board seen from
// another side, and is found.) Larger ones first, since a smaller one may be found as a part of
// one.
std::vector<Board> SimilarBoards(const Board& board) {
  const auto& written = std::get<Checkerboard>(board);
  std::vector<Board> similar;
  for (const auto& [more_rows, more_columns] :
       {std::pair(-1, -1), std::pair(1, 1), std::pair(1, 0), std::pair(0, 1), std::pair(-1, 0),
        std::pair(0, -1)}) {
    Checkerboard other = written;
    other.rows += more_rows;
    other.columns += more_columns;
    if (other.rows >= 3 && other.columns >= 3) similar.emplace_back(other);
  }
  return similar;
}

// The similar board that is in most of a few images, spread over all of them.
std::optional<Board> FindSimilarBoard(const ImageSource& images, const Board& board,
                                      const DetectionOptions& options) {
  const std::vector<Board> similar = SimilarBoards(board);
  const size_t num_images = std::min(images.names.size(), kImagesSearchedAgain);
  using Found = std::vector<bool>;
  const std::vector<Found> found = ParallelMap<Found>(num_images, [&](size_t i) {
    const GreyImage image = images.load(i * images.names.size() / num_images);
    Found in_image;
    for (const Board& other : similar) {
      in_image.push_back(DetectBoard(image, other, options).has_value());
    }
    return in_image;
  });
  std::optional<Board> best;
  std::ptrdiff_t most = 0;
  for (size_t k = 0; k < similar.size(); ++k) {
    const auto count = std::count_if(found.begin(), found.end(),
                                     [k](const Found& in_image) { return in_image[k]; });
    if (count <= most) continue;
    most = count;
    best = similar[k];
  }
  return best;
}

[[noreturn]] void FailWithoutBoard(const ImageSource& images, const Board& board,
                                   const DetectionOptions& options) {
  const size_t count = images.names.size();
  const std::string where =
      count == 1 ? images.names.front() : images.names.front() + " .. " + images.names.back();
  std::string remedy = "check --target and that the whole board is sharp and in view";
  if (const std::optional<Board> other = FindSimilarBoard(images, board, options)) {
    const auto& found = std::get<Checkerboard>(*other);
    remedy = "a board of " + std::to_string(found.rows) + " rows x " +
             std::to_string(found.columns) +
             " columns was found, so write targetRows: " + std::to_string(found.rows) +
             " and targetCols: " + std::to_string(found.columns) +
             " (inner corners are counted, not squares)";
  }
  throw InputError({"no board found", where,
                    "searched " + std::to_string(count) + (count == 1 ? " image" : " images") +
                        " for a " + Describe(board),
                    remedy});
}

std::string Text(Resolution resolution) {
  return std::to_string(resolution.width) + " x " + std::to_string(resolution.height);
}

}  // namespace

std::optional<BoardView> DetectBoard(const GreyImage& image, const Board& board,
                                     const DetectionOptions& options) {
  const auto& checkerboard = std::get<Checkerboard>(board);
  if (checkerboard.rows < 3 || checkerboard.columns < 3) {
    throw InputError({"board too small", "", Describe(board) + " can't be told from its background",
                      "use one of at least 3 rows and 3 columns of inner corners"});
  }
  std::optional<Eigen::Matrix2Xd> pixels =
      FindCheckerboard(image, checkerboard, options.refinement_half_window);
  if (!pixels) return std::nullopt;
  BoardView view;
  view.corner_ids.resize(static_cast<size_t>(pixels->cols()));
  std::iota(view.corner_ids.begin(), view.corner_ids.end(), 0);
  view.pixels = *std::move(pixels);
  view.points_g = BoardPoints(board);
  return view;
}

Detections DetectBoards(const ImageSource& images, const Board& board,
                        const DetectionOptions& options) {
  assert(images.stamps.empty() || images.stamps.size() == images.names.size());
  cv::setNumThreads(1);  // the loop over the images uses the cores better
  struct Search {
    std::optional<BoardView> view;
    Resolution resolution;
  };
  Progress progress("detecting", static_cast<int64_t>(images.names.size()));
  std::vector<Search> searches = ParallelMap<Search>(images.names.size(), [&](size_t k) -> Search {
    const GreyImage image = images.load(k);
    Search search{DetectBoard(image, board, options), image.resolution};
    progress.Advance();
    return search;
  });

  Detections detections;
  detections.num_images = static_cast<int>(images.names.size());
  for (size_t k = 0; k < searches.size(); ++k) {
    std::optional<BoardView>& view = searches[k].view;
    if (!view) {
      detections.images_without_board.push_back(images.names[k]);
      continue;
    }
    if (detections.views.empty()) detections.resolution = searches[k].resolution;
    if (searches[k].resolution != detections.resolution) {
      throw InputError({"images of two sizes", images.names[k],
                        "it has " + Text(searches[k].resolution) + " pixels, " +
                            detections.views.front().name + " has " + Text(detections.resolution),
                        "choose the images of one camera and one setting with --images"});
    }
    view->name = images.names[k];
    if (!images.stamps.empty()) view->stamp = images.stamps[k];
    detections.views.push_back(*std::move(view));
  }
  if (!detections.views.empty()) return detections;
  if (images.names.empty()) {
    throw InputError({"no board found", "", "there are no images", "record some"});
  }
  FailWithoutBoard(images, board, options);
}

}  // namespace calibrato
