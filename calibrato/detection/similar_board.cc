#include "calibrato/detection/similar_board.h"

#include <utility>

namespace calibrato {
namespace {

constexpr int kMinSide = 3;  // rows and columns of what can be found

struct Similar {
  std::vector<Board> operator()(const Checkerboard& board) const {
    // Rows and columns swapped is the same board seen from another side.
    std::vector<Board> similar;
    AddNeighbours(board, {{-1, -1}, {1, 1}, {1, 0}, {0, 1}, {-1, 0}, {0, -1}}, &similar);
    return similar;
  }
  std::vector<Board> operator()(const CircleGrid& board) const {
    std::vector<Board> similar;
    const CircleGrid swapped{board.columns, board.rows, board.spacing_m, board.asymmetric};
    if (board.asymmetric && board.rows != board.columns) AddNeighbours(swapped, {{0, 0}}, &similar);
    CircleGrid other = board;
    other.asymmetric = !board.asymmetric;
    AddNeighbours(other, {{0, 0}}, &similar);
    AddNeighbours(board, {{1, 1}, {1, 0}, {0, 1}, {-1, 0}, {0, -1}, {-1, -1}}, &similar);
    return similar;
  }
  std::vector<Board> operator()(const AprilGrid& board) const {
    AprilGrid swapped = board;
    std::swap(swapped.rows, swapped.columns);
    if (swapped == board) return {};
    return {swapped};
  }
  std::vector<Board> operator()(const Charuco& board) const {
    std::vector<Board> similar;
    if (board.rows != board.columns) {
      Charuco swapped = board;
      std::swap(swapped.rows, swapped.columns);
      similar.emplace_back(swapped);
    }
    // Inner corners counted instead of squares.
    AddNeighbours(board, {{1, 1}}, &similar);
    return similar;
  }

 private:
  template <typename AnyBoard>
  static void AddNeighbours(const AnyBoard& board, const std::vector<std::pair<int, int>>& changes,
                            std::vector<Board>* similar) {
    for (const auto& [more_rows, more_columns] : changes) {
      AnyBoard other = board;
      other.rows += more_rows;
      other.columns += more_columns;
      if (other.rows >= kMinSide && other.columns >= kMinSide) similar->emplace_back(other);
    }
  }
};

std::string Size(const std::string& what, int rows, int columns, const std::string& key) {
  return "a board of " + std::to_string(rows) + " rows x " + std::to_string(columns) +
         " columns was found, so write " + key + "Rows: " + std::to_string(rows) + " and " + key +
         "Cols: " + std::to_string(columns) + what;
}

struct Advice {
  std::string operator()(const Checkerboard& board) const {
    return Size(" (inner corners are counted, not squares)", board.rows, board.columns, "target");
  }
  std::string operator()(const CircleGrid& board) const {
    return Size(board.asymmetric ? ", asymmetricGrid: true" : ", asymmetricGrid: false", board.rows,
                board.columns, "target");
  }
  std::string operator()(const AprilGrid& board) const {
    return Size("", board.rows, board.columns, "tag");
  }
  std::string operator()(const Charuco& board) const {
    return Size(" (squares are counted, not corners)", board.rows, board.columns, "target");
  }
};

}  // namespace

std::vector<Board> SimilarBoards(const Board& board) { return std::visit(Similar(), board); }

std::string AdviceFor(const Board& found) { return std::visit(Advice(), found); }

}  // namespace calibrato
