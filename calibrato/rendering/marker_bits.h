#pragma once

#include <string_view>
#include <vector>

namespace calibrato {

/// The modules of a square marker as one sees it: bits[row][column] is true where white, row 0 at
/// the top, with a black border on all sides.
using MarkerBits = std::vector<std::vector<bool>>;

/// Marker `id` of a dictionary by its OpenCV name, with a border of one module.
/// @pre The dictionary is one of kMarkerDictionaries and has that marker.
[[nodiscard]] MarkerBits DictionaryMarker(std::string_view dictionary, int id);

/// Tag `id` of the family 36h11 with a border of two modules, turned as in Kalibr's AprilGrids: by
/// half against OpenCV's marker of the same number. @pre 0 <= id < kNumAprilTags
[[nodiscard]] MarkerBits AprilGridTag(int id);

}  // namespace calibrato
