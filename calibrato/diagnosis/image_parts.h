#pragma once

#include <string>
#include <vector>

#include "calibrato/sensors/camera_model.h"
#include "calibrato/sensors/measurements.h"

namespace calibrato {

/// The parts of the image, of three times three, in which no corner of any view lies, as a person
/// calls them: "top left", "top", .., "middle", .., "bottom right".
[[nodiscard]] std::vector<std::string> UncoveredParts(const std::vector<BoardView>& views,
                                                      Resolution resolution);

/// "the top left", "the top left and the top", "the top left, the top and the left".
[[nodiscard]] std::string Enumerated(const std::vector<std::string>& parts);

}  // namespace calibrato
