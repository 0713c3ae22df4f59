#include "calibrato/recording/image_list.h"

#include "calibrato/base/input_error.h"
#include "calibrato/recording/comma_separated.h"
#include "calibrato/recording/stamped_rows.h"

namespace calibrato {

std::vector<ListedImage> ReadImageList(const std::string& path) {
  std::vector<ListedImage> images;
  ForEachStampedRow(path, [&](const StampedRow& row) {
    if (row.stamp_ns < 0 || row.fields.size() != 2 || row.fields.back().empty()) {
      throw InputError(
          {"malformed list of images", row.where,
           "expected a stamp in whole nanoseconds and a file name, found " + Quoted(row.line),
           "correct the line or remove it"});
    }
    images.push_back({Time::FromNanoseconds(row.stamp_ns), std::string(row.fields.back())});
  });
  if (images.empty()) {
    throw InputError({"no images", path, "the list has no rows",
                      "remove it, or name the images by their stamps in nanoseconds"});
  }
  return images;
}

}  // namespace calibrato
