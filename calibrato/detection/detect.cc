#include "calibrato/detection/detect.h"

#include <algorithm>
#include <cassert>
#include <numeric>
#include <opencv2/core/utility.hpp>
#include <utility>

#include "calibrato/base/input_error.h"
#include "calibrato/base/parallel.h"
#include "calibrato/detection/find_april_grid.h"
#include "calibrato/detection/find_charuco.h"
#include "calibrato/detection/find_checkerboard.h"
#include "calibrato/detection/find_circle_grid.h"
#include "calibrato/detection/similar_board.h"
#include "calibrato/sensors/board_symmetry.h"

namespace calibrato {
namespace {

// How many images are searched for another board when the board was in none.
constexpr size_t kImagesSearchedAgain = 5;

struct Finder {
  const GreyImage& image;
  RejectionCounts* rejected;

  std::optional<BoardView> operator()(const Checkerboard& board) const {
    RefuseBelowThree(board.rows, board.columns, board);
    return FindCheckerboard(image, board, rejected);
  }
  std::optional<BoardView> operator()(const AprilGrid& board) const {
    return FindAprilGrid(image, board, rejected);
  }
  std::optional<BoardView> operator()(const CircleGrid& board) const {
    RefuseBelowThree(board.rows, board.columns, board);
    return FindCircleGrid(image, board, rejected);
  }
  std::optional<BoardView> operator()(const Charuco& board) const {
    return FindCharuco(image, board, rejected);
  }

  static void RefuseBelowThree(int rows, int columns, const Board& board) {
    if (rows >= 3 && columns >= 3) return;
    throw InputError({"board too small", "", Describe(board) + " can't be told from its background",
                      "use one of at least 3 rows and 3 columns"});
  }
};

// The similar board that is in most of a few images, spread over all of them.
std::optional<Board> FindSimilarBoard(const ImageSource& images, const Board& board) {
  const std::vector<Board> similar = SimilarBoards(board);
  const size_t num_images = std::min(images.names.size(), kImagesSearchedAgain);
  using Found = std::vector<bool>;
  const std::vector<Found> found = ParallelMap<Found>(num_images, [&](size_t i) {
    const GreyImage image = images.load(i * images.names.size() / num_images);
    Found in_image;
    for (const Board& other : similar) in_image.push_back(DetectBoard(image, other).has_value());
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

// What was seen instead of the board, and what to do about it.
std::pair<std::string, std::string> Explain(const ImageSource& images, const Board& board,
                                            const RejectionCounts& rejected) {
  if (rejected.images_with_mirrored_board > 0) {
    return {"a mirrored one was seen in " + std::to_string(rejected.images_with_mirrored_board),
            "turn off mirroring in the camera's driver, or print the board the right way round"};
  }
  if (rejected.images_with_two_boards > 0) {
    return {"two boards at a time were seen in " + std::to_string(rejected.images_with_two_boards),
            "show one board at a time"};
  }
  if (const std::optional<Board> other = FindSimilarBoard(images, board)) {
    return {"", AdviceFor(*other)};
  }
  if (rejected.tags_of_another_family > 0) {
    return {"markers of another family or border were seen",
            "check that --target names the family that was printed"};
  }
  if (rejected.tags_not_on_board > 0) {
    return {"markers with numbers that this board has not were seen",
            "check the rows and columns in --target"};
  }
  return {"", "check --target and that the whole board is sharp and in view"};
}

InputError::Parts NoBoard(const ImageSource& images, const Board& board,
                          const RejectionCounts& rejected) {
  const size_t count = images.names.size();
  const std::string where =
      count == 1 ? images.names.front() : images.names.front() + " .. " + images.names.back();
  const auto [seen, remedy] = Explain(images, board, rejected);
  return {"no board found", where,
          "searched " + std::to_string(count) + (count == 1 ? " image" : " images") + " for a " +
              Describe(board) + (seen.empty() ? "" : "; " + seen),
          remedy};
}

std::string Text(Resolution resolution) {
  return std::to_string(resolution.width) + " x " + std::to_string(resolution.height);
}

// In the order of their stamps, each numbered as the one before.
void NumberByContinuity(const Board& board, Detections* detections) {
  const std::vector<std::vector<int>> numberings = OtherNumberings(board);
  std::vector<BoardView>& views = detections->views;
  std::vector<size_t> order(views.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](size_t a, size_t b) { return views[a].stamp < views[b].stamp; });
  if (numberings.empty() || views.empty()) return;
  if (views[order.front()].stamp == views[order.back()].stamp) return;
  const Eigen::Matrix3Xd points_g = BoardPoints(board);
  for (size_t k = 1; k < order.size(); ++k) {
    views[order[k]] = NumberedAsBefore(views[order[k]], views[order[k - 1]], numberings, points_g);
  }
  detections->is_numbered_by_continuity = true;
}

}  // namespace

BoardSearch SearchForBoard(const GreyImage& image, const Board& board) {
  assert(image.pixels.size() ==
         static_cast<size_t>(image.resolution.width) * image.resolution.height);
  BoardSearch search;
  search.view = std::visit(Finder{image, &search.rejected}, board);
  return search;
}

std::optional<BoardView> DetectBoard(const GreyImage& image, const Board& board) {
  return SearchForBoard(image, board).view;
}

Detections SearchForBoards(const ImageSource& images, const Board& board) {
  if (images.names.empty()) {
    throw InputError({"no board found", "", "there are no images", "record some"});
  }
  assert(images.stamps.empty() || images.stamps.size() == images.names.size());
  cv::setNumThreads(1);  // the loop over the images uses the cores better
  struct Search {
    BoardSearch found;
    Resolution resolution;
  };
  std::vector<Search> searches = ParallelMap<Search>(images.names.size(), [&](size_t k) -> Search {
    const GreyImage image = images.load(k);
    return {SearchForBoard(image, board), image.resolution};
  });

  Detections detections;
  detections.num_images = static_cast<int>(images.names.size());
  for (size_t k = 0; k < searches.size(); ++k) {
    detections.rejected += searches[k].found.rejected;
    std::optional<BoardView>& view = searches[k].found.view;
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
  if (detections.views.empty()) {
    detections.resolution = searches.front().resolution;
    detections.no_board = NoBoard(images, board, detections.rejected);
  }
  NumberByContinuity(board, &detections);
  return detections;
}

Detections DetectBoards(const ImageSource& images, const Board& board) {
  Detections detections = SearchForBoards(images, board);
  if (detections.no_board) throw InputError(*detections.no_board);
  return detections;
}

}  // namespace calibrato
