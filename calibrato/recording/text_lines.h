#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

struct gzFile_s;  // of zlib, whose header stays out of ours

namespace calibrato {

/// The lines of a text file, plain or gzip (told apart by its content), one after the other, with
/// little memory however long the file. Lines end in LF or CRLF; the last one may lack its end.
///
///     TextLines lines(path);
///     while (const auto line = lines.Next()) Use(*line, lines.line_number());
class TextLines {
 public:
  /// No line of a list that people or programs write is longer; a longer one is no text.
  static constexpr size_t kMaxLineBytes = size_t{1} << 20;

  /// @throws InputError if the file is missing, a folder or unreadable.
  explicit TextLines(const std::string& path);
  ~TextLines();
  TextLines(const TextLines&) = delete;
  TextLines& operator=(const TextLines&) = delete;

  /// The next line without its end, valid until the next call; nothing at the end of the file.
  /// @throws InputError: a truncated or damaged gzip, a NUL byte (not text), a line beyond
  /// kMaxLineBytes.
  std::optional<std::string_view> Next();
  /// Of the line that Next() gave last, counted from 1.
  int64_t line_number() const { return line_number_; }

 private:
  bool ReadMore();
  [[noreturn]] void Fail(const std::string& why, const std::string& remedy) const;

  std::string path_;
  gzFile_s* file_;
  std::string buffer_;
  size_t begin_ = 0;  // of what is unread in buffer_
  bool at_end_ = false;
  int64_t line_number_ = 0;
};

}  // namespace calibrato
