#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace calibrato {

/// The name that was probably meant by a misspelt one, for "did you mean ...?": the candidate with
/// the fewest letters changed, added, left out or swapped with their neighbour, upper and lower
/// case taken as equal; the first of several as near. Nothing if more than a third of its letters
/// would have to change.
std::optional<std::string> NearestName(std::string_view name,
                                       const std::vector<std::string>& candidates);

}  // namespace calibrato
