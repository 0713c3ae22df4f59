#include "calibrato/recording/stamped_rows.h"

#include <charconv>
#include <optional>

#include "calibrato/recording/comma_separated.h"
#include "calibrato/recording/text_lines.h"

namespace calibrato {

void ForEachStampedRow(const std::string& path,
                       const std::function<void(const StampedRow&)>& visit) {
  TextLines lines(path);
  std::vector<std::string_view> fields;
  while (const std::optional<std::string_view> next = lines.Next()) {
    const bool is_first = lines.line_number() == 1;
    const std::string_view line = Trimmed(is_first ? WithoutByteOrderMark(*next) : *next);
    if (line.empty() || line.starts_with('#')) continue;
    SplitAtCommas(line, &fields);
    int64_t stamp = -1;
    const std::string_view field = fields.front();
    const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), stamp);
    const bool is_number = error == std::errc() && end == field.data() + field.size();
    if (!is_number && is_first) continue;  // names of columns
    visit({path + " line " + std::to_string(lines.line_number()), line,
           is_number && stamp >= 0 ? stamp : -1, fields});
  }
}

}  // namespace calibrato
