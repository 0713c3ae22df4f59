#pragma once

#include <string>

#include "calibrato/sensors/board.h"

namespace calibrato {

enum class DrawingFormat { kPdf, kSvg, kPng };

struct DrawingOptions {
  double dpi = 300.0;  ///< Of a PNG: pixels an inch, 36 to 2400.
};

/// The content of a file that prints a board at its true size: black on white, upright, seen from
/// the front (PatternOf), on the smallest of A4 to A0 that holds it, else on a page of its own
/// size. Below the board stand what it is, the distances to measure after printing, and a ruler.
///
/// PDF and SVG are vectors, true to 2 um. A PNG carries its resolution (pHYs), of whole pixels a
/// metre; the grey of each pixel is its covered part. The same board gives the same bytes.
/// @throws InputError: a page above 5 m, the most that PDF knows; a PNG above 200 megapixels.
[[nodiscard]] std::string DrawBoard(const Board& board, DrawingFormat format,
                                    const DrawingOptions& options = {});

}  // namespace calibrato
