#include "calibrato/diagnosis/image_parts.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace calibrato {
namespace {

constexpr std::array<std::array<const char*, 3>, 3> kNames = {
    {{"top left", "top", "top right"},
     {"left", "middle", "right"},
     {"bottom left", "bottom", "bottom right"}}};

size_t Third(double pixel, int image_size) {
  return static_cast<size_t>(std::clamp(std::floor(3.0 * (pixel + 0.5) / image_size), 0.0, 2.0));
}

}  // namespace

std::vector<std::string> UncoveredParts(const std::vector<BoardView>& views,
                                        Resolution resolution) {
  std::array<std::array<bool, 3>, 3> is_covered{};
  for (const BoardView& view : views) {
    for (Eigen::Index k = 0; k < view.num_corners(); ++k) {
      is_covered[Third(view.pixels(1, k), resolution.height)]
                [Third(view.pixels(0, k), resolution.width)] = true;
    }
  }
  std::vector<std::string> parts;
  for (size_t row = 0; row < 3; ++row) {
    for (size_t column = 0; column < 3; ++column) {
      if (!is_covered[row][column]) parts.emplace_back(kNames[row][column]);
    }
  }
  return parts;
}

std::string Enumerated(const std::vector<std::string>& parts) {
  std::string text;
  for (size_t i = 0; i < parts.size(); ++i) {
    if (i > 0) text += i + 1 == parts.size() ? " and " : ", ";
    text += "the " + parts[i];
  }
  return text;
}

}  // namespace calibrato
