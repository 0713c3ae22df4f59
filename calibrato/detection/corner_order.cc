#include "calibrato/detection/corner_order.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>
#include <vector>

namespace calibrato {
namespace {

// The corners renumbered: corner (row, column) of the result is corner source(row, column).
template <typename Source>
Eigen::Matrix2Xd Renumbered(const Checkerboard& board, const Eigen::Matrix2Xd& pixels,
                            const Source& source) {
  Eigen::Matrix2Xd result(2, pixels.cols());
  for (int row = 0; row < board.rows; ++row) {
    for (int column = 0; column < board.columns; ++column) {
      const auto [source_row, source_column] = source(row, column);
      result.col(row * board.columns + column) =
          pixels.col(source_row * board.columns + source_column);
    }
  }
  return result;
}

struct Corner {
  int row;
  int column;
};

// Twice the signed area of the board's outline, walked from (0, 0) along x first. v points down, so
// that it is negative where x, y and the direction towards the viewer are right-handed.
double SignedArea(const Checkerboard& board, const Eigen::Matrix2Xd& pixels) {
  const Eigen::Index last_row = Eigen::Index{board.rows - 1} * board.columns;
  const Eigen::Index last_column = board.columns - 1;
  const Eigen::Vector2d diagonal = pixels.col(last_row + last_column) - pixels.col(0);
  const Eigen::Vector2d other = pixels.col(last_column) - pixels.col(last_row);
  return diagonal.x() * other.y() - diagonal.y() * other.x();
}

double Brightness(const GreyImage& image, const Eigen::Vector2d& pixel) {
  const auto clamped = [](double x, int size) {
    return std::clamp(static_cast<int>(std::lround(x)), 0, size - 1);
  };
  const auto u = static_cast<size_t>(clamped(pixel.x(), image.resolution.width));
  const auto v = static_cast<size_t>(clamped(pixel.y(), image.resolution.height));
  return image.pixels[v * static_cast<size_t>(image.resolution.width) + u];
}

// Mean brightness around the middle of the square between four corners.
double SquareBrightness(const GreyImage& image, const Checkerboard& board,
                        const Eigen::Matrix2Xd& pixels, int row, int column) {
  const Eigen::Index first = Eigen::Index{row} * board.columns + column;
  const Eigen::Index corners[] = {first, first + 1, first + board.columns,
                                  first + board.columns + 1};
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (const Eigen::Index corner : corners) middle += 0.25 * pixels.col(corner);
  double sum = Brightness(image, middle);
  for (const Eigen::Index corner : corners) {
    sum += Brightness(image, 0.6 * middle + 0.4 * pixels.col(corner));
  }
  return sum / 5.0;
}

// Whether the square outside (0, 0) is black: it shares its colour with those between four corners
// whose row and column have an even sum. Nothing where neighbours do not differ as a checkerboard's
// must: a finder that was asked for one row too many may have made one up beside the board.
std::optional<bool> FirstSquareIsBlack(const GreyImage& image, const Checkerboard& board,
                                       const Eigen::Matrix2Xd& pixels) {
  constexpr double kMaxShareOfMisfits = 0.02;
  Eigen::MatrixXd brightness(board.rows - 1, board.columns - 1);
  for (int row = 0; row + 1 < board.rows; ++row) {
    for (int column = 0; column + 1 < board.columns; ++column) {
      brightness(row, column) = SquareBrightness(image, board, pixels, row, column);
    }
  }
  int num_pairs = 0;
  int num_even_darker = 0;
  int num_even_brighter = 0;
  const auto compare = [&](int row, int column, int next_row, int next_column) {
    const double excess = brightness(next_row, next_column) - brightness(row, column);
    ++num_pairs;
    const bool is_even = (row + column) % 2 == 0;
    if (is_even ? excess > 0.0 : excess < 0.0) ++num_even_darker;
    if (is_even ? excess < 0.0 : excess > 0.0) ++num_even_brighter;
  };
  for (int row = 0; row + 1 < board.rows; ++row) {
    for (int column = 0; column + 1 < board.columns; ++column) {
      if (row + 2 < board.rows) compare(row, column, row + 1, column);
      if (column + 2 < board.columns) compare(row, column, row, column + 1);
    }
  }
  const double needed = (1.0 - kMaxShareOfMisfits) * num_pairs;
  if (num_even_darker >= needed) return true;
  if (num_even_brighter >= needed) return false;
  return std::nullopt;
}

}  // namespace

std::optional<Eigen::Matrix2Xd> OrderCorners(const GreyImage& image, const Checkerboard& board,
                                             const Eigen::Matrix2Xd& pixels) {
  assert(pixels.cols() == Eigen::Index{board.rows} * board.columns);
  const int last_row = board.rows - 1;
  const int last_column = board.columns - 1;
  const auto is_mirrored = SignedArea(board, pixels) > 0.0;
  std::vector<Eigen::Matrix2Xd> sides;
  sides.push_back(is_mirrored ? Renumbered(board, pixels,
                                           [&](int row, int column) {
                                             return Corner{row, last_column - column};
                                           })
                              : pixels);
  sides.push_back(Renumbered(board, sides.front(), [&](int row, int column) {
    return Corner{last_row - row, last_column - column};
  }));
  if (board.rows == board.columns) {
    sides.push_back(Renumbered(board, sides.front(), [&](int row, int column) {
      return Corner{column, last_row - row};
    }));
    sides.push_back(Renumbered(board, sides.front(), [&](int row, int column) {
      return Corner{last_column - column, row};
    }));
  }
  if (!FirstSquareIsBlack(image, board, pixels)) return std::nullopt;
  const auto first_is_white = [&](const Eigen::Matrix2Xd& side) {
    return FirstSquareIsBlack(image, board, side) == false;
  };
  if (!std::all_of(sides.begin(), sides.end(), first_is_white)) {
    std::erase_if(sides, first_is_white);
  }
  return *std::min_element(sides.begin(), sides.end(),
                           [](const Eigen::Matrix2Xd& a, const Eigen::Matrix2Xd& b) {
                             return a.col(0).squaredNorm() < b.col(0).squaredNorm();
                           });
}

}  // namespace calibrato
