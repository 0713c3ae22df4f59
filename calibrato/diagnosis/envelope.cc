#include "calibrato/diagnosis/envelope.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace calibrato {
namespace {

struct Piece {
  double time_s = 0.0;
  double low = 0.0;
  double high = 0.0;
};

std::vector<Piece> Pieces(const std::vector<double>& time_s, const std::vector<double>& values,
                          int num_pieces) {
  std::vector<Piece> singles;
  for (size_t k = 0; k < values.size(); ++k) {
    if (std::isfinite(values[k])) singles.push_back({time_s[k], values[k], values[k]});
  }
  if (singles.size() <= 2 * static_cast<size_t>(num_pieces)) return singles;
  const double begin = singles.front().time_s;
  const double length = (singles.back().time_s - begin) / num_pieces;
  std::vector<Piece> pieces;
  int last = -1;
  for (const Piece& single : singles) {
    const int number = std::min(num_pieces - 1, static_cast<int>((single.time_s - begin) / length));
    if (number != last) {
      pieces.push_back({begin + (number + 0.5) * length, single.low, single.high});
      last = number;
    }
    pieces.back().low = std::min(pieces.back().low, single.low);
    pieces.back().high = std::max(pieces.back().high, single.high);
  }
  return pieces;
}

}  // namespace

Value Envelope(const std::vector<double>& time_s, const std::vector<double>& values,
               int num_pieces) {
  assert(time_s.size() == values.size() && num_pieces >= 1);
  const std::vector<Piece> pieces = Pieces(time_s, values, num_pieces);
  double largest = 0.0;
  for (const Piece& piece : pieces) {
    largest = std::max({largest, std::abs(piece.low), std::abs(piece.high)});
  }
  const double scale = largest > 0.0 ? std::pow(10.0, 4.0 - std::floor(std::log10(largest))) : 1.0;
  Value times = Value::Array();
  Value low = Value::Array();
  Value high = Value::Array();
  for (const Piece& piece : pieces) {
    times.Append(std::round(1e4 * piece.time_s) / 1e4);
    low.Append(std::round(scale * piece.low) / scale);
    high.Append(std::round(scale * piece.high) / scale);
  }
  Value envelope = Value::Object();
  envelope.Set("time_s", std::move(times)).Set("low", std::move(low)).Set("high", std::move(high));
  return envelope;
}

}  // namespace calibrato
