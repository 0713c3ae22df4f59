#pragma once

#include <string>
#include <vector>

#include "calibrato/base/time.h"

namespace calibrato {

/// One line of EuRoC's cam0/data.csv.
struct ListedImage {
  Time stamp;
  std::string name;  ///< File name, without its folder.
};

/// EuRoC's list of a camera's images: lines `stamp [ns],file name`, ascending or not; lines that
/// begin with '#' are comments, and so is a first line that begins with no number.
/// @throws InputError with file and line: another number of fields, a stamp that is no whole
/// number, no rows; no text.
[[nodiscard]] std::vector<ListedImage> ReadImageList(const std::string& path);

}  // namespace calibrato
