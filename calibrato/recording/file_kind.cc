#include "calibrato/recording/file_kind.h"

#include <algorithm>
#include <cstdint>
#include <string_view>

#include "calibrato/recording/mcap_format.h"
#include "calibrato/recording/random_access_file.h"

namespace calibrato {
namespace {

using namespace std::string_view_literals;

// Sources: ISO/IEC 14496-12 (a box's size and type), RFC 8794 (EBML), the RIFF of AVI, and ISO/IEC
// 13818-1 (pack header; transport packets of 188 bytes that begin with 0x47).
bool IsVideo(std::string_view bytes) {
  const std::string_view box = bytes.substr(std::min<size_t>(bytes.size(), 4), 4);
  const std::string_view form = bytes.substr(std::min<size_t>(bytes.size(), 8), 4);
  return box == "ftyp" || box == "moov" || box == "mdat" || box == "wide" ||
         bytes.starts_with("\x1a\x45\xdf\xa3"sv) || bytes.starts_with("\0\0\1\xba"sv) ||
         (bytes.starts_with("RIFF") && form == "AVI ") ||
         (bytes.size() > 188 && bytes[0] == '\x47' && bytes[188] == '\x47');
}

}  // namespace

FileKind KindOfFile(const std::string& path) {
  constexpr uint64_t kEnough = 189;
  const RandomAccessFile file(path);
  const std::string bytes = file.Read(0, std::min(kEnough, file.size()));
  if (bytes.starts_with("#ROSBAG V2.0\n")) return FileKind::kRosbag1;
  if (bytes.starts_with("#ROSBAG") || bytes.starts_with("#ROSLOG") ||
      bytes.starts_with("#ROSRECORD")) {
    return FileKind::kOldRosbag1;
  }
  if (bytes.starts_with(kMcapMagic)) return FileKind::kMcap;
  if (bytes.starts_with("SQLite format 3\0"sv)) return FileKind::kSqlite;
  if (bytes.starts_with("\x28\xb5\x2f\xfd"sv)) return FileKind::kZstd;
  return IsVideo(bytes) ? FileKind::kVideo : FileKind::kOther;
}

}  // namespace calibrato
