#include "calibrato/diagnosis/image_parts.h"

#include <gtest/gtest.h>

namespace calibrato {
namespace {

BoardView ViewAt(const std::vector<Eigen::Vector2d>& pixels) {
  BoardView view;
  view.pixels.resize(2, static_cast<Eigen::Index>(pixels.size()));
  for (size_t k = 0; k < pixels.size(); ++k) {
    view.pixels.col(static_cast<Eigen::Index>(k)) = pixels[k];
  }
  return view;
}

TEST(UncoveredParts, AreNamedInReadingOrder) {
  const Resolution image{300, 300};
  EXPECT_EQ(UncoveredParts({ViewAt({{150, 10}, {290, 10}, {10, 150}, {150, 150}}),
                            ViewAt({{290, 150}, {10, 290}, {150, 290}})},
                           image),
            (std::vector<std::string>{"top left", "bottom right"}));
  EXPECT_EQ(UncoveredParts({}, image).size(), 9U);
}

TEST(UncoveredParts, ReachFromTheOutermostPixelsToAThird) {
  const Resolution image{300, 300};
  // 99 is the last pixel of the first third, 100 the first of the second; 299 is the last of all.
  EXPECT_EQ(UncoveredParts({ViewAt({{99, 99}})}, image).front(), "top");
  EXPECT_EQ(UncoveredParts({ViewAt({{100, 99}})}, image)[1], "top right");
  EXPECT_EQ(UncoveredParts({ViewAt({{299.4, 299.4}})}, image).back(), "bottom");
}

TEST(Enumerated, ReadsAsASentence) {
  EXPECT_EQ(Enumerated({"top left"}), "the top left");
  EXPECT_EQ(Enumerated({"top left", "top"}), "the top left and the top");
  EXPECT_EQ(Enumerated({"top left", "top", "left"}), "the top left, the top and the left");
}

}  // namespace
}  // namespace calibrato
