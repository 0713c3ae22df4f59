#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace calibrato {

/// A row of a list whose first column is a stamp. Private to the room.
struct StampedRow {
  std::string where;      ///< "cam0/data.csv line 3", for errors.
  std::string_view line;  ///< Trimmed.
  int64_t stamp_ns = -1;  ///< -1 where the first field is no whole number, or negative.
  const std::vector<std::string_view>& fields;  ///< The stamp's among them.
};

/// Calls `visit` for each row, in their order; what it is given is valid during the call. Empty
/// lines, those that begin with #, and a first line of column names are passed over.
/// @throws InputError if the file can't be read; what `visit` throws.
void ForEachStampedRow(const std::string& path,
                       const std::function<void(const StampedRow&)>& visit);

}  // namespace calibrato
