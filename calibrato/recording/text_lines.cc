#include "calibrato/recording/text_lines.h"

#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <system_error>

#include "calibrato/base/input_error.h"

namespace calibrato {
namespace {

constexpr size_t kBlockBytes = size_t{1} << 18;

}  // namespace

TextLines::TextLines(const std::string& path) : path_(path), file_(nullptr) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) {
    Fail(error && error != std::errc::no_such_file_or_directory ? error.message() : "no such file",
         "check the spelling of the path");
  }
  if (std::filesystem::is_directory(status)) Fail("it is a folder", "name a file");
  file_ = gzopen(path.c_str(), "rb");
  if (file_ == nullptr) {
    Fail(std::generic_category().message(errno), "check the permissions of the file");
  }
  gzbuffer(file_, kBlockBytes);
}

TextLines::~TextLines() {
  if (file_ != nullptr) gzclose(file_);
}

void TextLines::Fail(const std::string& why, const std::string& remedy) const {
  throw InputError({"cannot read file", path_, why, remedy});
}

bool TextLines::ReadMore() {
  if (at_end_) return false;
  buffer_.erase(0, begin_);
  begin_ = 0;
  const size_t kept = buffer_.size();
  buffer_.resize(kept + kBlockBytes);
  errno = 0;
  const int count = gzread(file_, buffer_.data() + kept, kBlockBytes);
  const int file_errno = errno;
  buffer_.resize(kept + static_cast<size_t>(count > 0 ? count : 0));
  // At a gzip that ends too early, gzread returns what there is and leaves a note.
  int error = Z_OK;
  gzerror(file_, &error);
  if (error == Z_BUF_ERROR) Fail("the gzip is truncated", "copy the file again");
  if (error == Z_ERRNO) Fail(std::generic_category().message(file_errno), "copy the file again");
  if (error != Z_OK && error != Z_STREAM_END) Fail("the gzip is damaged", "copy the file again");
  if (buffer_.find('\0', kept) != std::string::npos) {
    Fail("it is not a text file", "give comma-separated values, plain or as gzip");
  }
  at_end_ = count <= 0;
  return !at_end_;
}

std::optional<std::string_view> TextLines::Next() {
  size_t searched = begin_;
  size_t end = 0;
  while ((end = buffer_.find('\n', searched)) == std::string::npos) {
    if (buffer_.size() - begin_ > kMaxLineBytes) {
      Fail("line " + std::to_string(line_number_ + 1) + " is longer than 1 MB",
           "give comma-separated values, one row a line");
    }
    searched = buffer_.size() - begin_;  // as ReadMore moves begin_ to 0
    if (ReadMore()) continue;
    if (begin_ == buffer_.size()) return std::nullopt;
    end = buffer_.size();
    break;
  }
  std::string_view line = std::string_view(buffer_).substr(begin_, end - begin_);
  begin_ = std::min(end + 1, buffer_.size());
  if (line.ends_with('\r')) line.remove_suffix(1);
  ++line_number_;
  return line;
}

}  // namespace calibrato
