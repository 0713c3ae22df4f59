#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace calibrato {

/// Appends numbers and text to a string of bytes, little-endian, for ByteReader to read back in the
/// same order.
class ByteWriter {
 public:
  void Write(int64_t value);
  void Write(double value);
  void Write(std::string_view text);
  void Write(const std::vector<float>& values);
  void Write(const Eigen::VectorXd& values);
  void Write(const Eigen::MatrixXd& values);

  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  void Append(const void* data, size_t size);
  std::string bytes_;
};

/// Reads what a ByteWriter wrote. Never reads beyond the end, and never asks for memory that the
/// bytes left could not fill: @throws InputError that names the file, when they end too early.
class ByteReader {
 public:
  /// @param bytes  Must outlive the reader.
  /// @param path  Of the file, for errors.
  ByteReader(std::string_view bytes, std::string path);

  int64_t ReadInt();
  double ReadDouble();
  std::string ReadText();
  std::vector<float> ReadFloats();
  Eigen::VectorXd ReadVector();
  Eigen::MatrixXd ReadMatrix();

  /// @throws InputError unless all was read.
  void ExpectEnd() const;
  [[noreturn]] void Fail(const std::string& why) const;

 private:
  void Take(void* data, size_t size);
  size_t ReadCount(size_t bytes_each);
  std::string_view bytes_;
  std::string path_;
};

/// Puts a header before the content, and a checksum, so that Unsealed() recognises what was cut,
/// changed or is something else.
/// @param magic  Eight letters that tell the kind of file.
[[nodiscard]] std::string Sealed(std::string_view magic, int64_t version, std::string_view content);

/// @return The content, a part of `bytes`.
/// @throws InputError that names `path` and says which: another kind of file, another version, cut
/// short, or damaged.
[[nodiscard]] std::string_view Unsealed(std::string_view magic, int64_t version,
                                        std::string_view bytes, const std::string& path);

}  // namespace calibrato
