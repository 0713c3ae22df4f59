#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace calibrato {

// Lines of comma-separated values, as lists of corners, samples and images are made of. Private to
// the room.

/// Without blanks at both ends.
[[nodiscard]] std::string_view Trimmed(std::string_view text);

/// The fields between commas, trimmed; they point into the line.
void SplitAtCommas(std::string_view line, std::vector<std::string_view>* fields);

/// As an error quotes a field: its first 40 characters.
[[nodiscard]] std::string Quoted(std::string_view field);

/// Without the byte order mark that some programs begin a file with.
[[nodiscard]] std::string_view WithoutByteOrderMark(std::string_view line);

}  // namespace calibrato
