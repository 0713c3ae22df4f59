#pragma once

#include <string>
#include <vector>

#include "calibrato/sensors/board.h"

namespace calibrato {

/// Boards that people mean when they write another one, likelier and larger ones first (a smaller
/// one may be found as a part of one): squares counted instead of inner corners, one row or column
/// too many or too few; rows and columns swapped where that is another board; a symmetric grid of
/// circles for an asymmetric one.
[[nodiscard]] std::vector<Board> SimilarBoards(const Board& board);

/// How to write the target file of a board that was found instead, in words.
[[nodiscard]] std::string AdviceFor(const Board& found);

}  // namespace calibrato
