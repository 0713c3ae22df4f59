#include "calibrato/recording/image_list.h"

#include <charconv>
#include <optional>

#include "calibrato/base/input_error.h"
#include "calibrato/recording/comma_separated.h"
#include "calibrato/recording/text_lines.h"

namespace calibrato {

std::vector<ListedImage> ReadImageList(const std::string& path) {
  TextLines lines(path);
  std::vector<ListedImage> images;
  std::vector<std::string_view> fields;
  while (const std::optional<std::string_view> next = lines.Next()) {
    const std::string_view line =
        Trimmed(lines.line_number() == 1 ? WithoutByteOrderMark(*next) : *next);
    if (line.empty() || line.starts_with('#')) continue;
    SplitAtCommas(line, &fields);
    int64_t stamp = -1;
    const std::string_view field = fields.front();
    const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), stamp);
    const bool is_number = error == std::errc() && end == field.data() + field.size();
    if (!is_number && images.empty() && lines.line_number() == 1) continue;  // names of columns
    if (!is_number || stamp < 0 || fields.size() != 2 || fields.back().empty()) {
      throw InputError(
          {"malformed list of images", path + " line " + std::to_string(lines.line_number()),
           "expected a stamp in whole nanoseconds and a file name, found " + Quoted(line),
           "correct the line or remove it"});
    }
    images.push_back({Time::FromNanoseconds(stamp), std::string(fields.back())});
  }
  if (images.empty()) {
    throw InputError({"no images", path, "the list has no rows",
                      "remove it, or name the images by their stamps in nanoseconds"});
  }
  return images;
}

}  // namespace calibrato
