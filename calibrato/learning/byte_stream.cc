#include "calibrato/learning/byte_stream.h"

#include <bit>
#include <cassert>
#include <cstring>
#include <utility>

#include "calibrato/base/input_error.h"

namespace calibrato {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr size_t kMagicSize = 8;
constexpr size_t kHeaderSize = kMagicSize + 3 * sizeof(int64_t);

// FNV-1a over words of 64 bits: not against forgers, but against disks.
int64_t Checksum(std::string_view bytes) {
  uint64_t hash = 0xcbf29ce484222325U ^ bytes.size();
  for (size_t i = 0; i < bytes.size(); i += sizeof(uint64_t)) {
    uint64_t word = 0;
    std::memcpy(&word, bytes.data() + i, std::min(sizeof(word), bytes.size() - i));
    hash = (hash ^ word) * 0x100000001b3U;
    hash ^= hash >> 29;
  }
  return static_cast<int64_t>(hash);
}

int64_t IntAt(std::string_view bytes, size_t position) {
  int64_t value = 0;
  std::memcpy(&value, bytes.data() + position, sizeof(value));
  return value;
}

}  // namespace

void ByteWriter::Append(const void* data, size_t size) {
  bytes_.append(static_cast<const char*>(data), size);
}

void ByteWriter::Write(int64_t value) { Append(&value, sizeof(value)); }

void ByteWriter::Write(double value) { Append(&value, sizeof(value)); }

void ByteWriter::Write(std::string_view text) {
  Write(static_cast<int64_t>(text.size()));
  Append(text.data(), text.size());
}

void ByteWriter::Write(const std::vector<float>& values) {
  Write(static_cast<int64_t>(values.size()));
  Append(values.data(), values.size() * sizeof(float));
}

void ByteWriter::Write(const Eigen::VectorXd& values) {
  Write(static_cast<int64_t>(values.size()));
  Append(values.data(), static_cast<size_t>(values.size()) * sizeof(double));
}

void ByteWriter::Write(const Eigen::MatrixXd& values) {
  Write(static_cast<int64_t>(values.rows()));
  Write(Eigen::VectorXd(values.reshaped()));
}

ByteReader::ByteReader(std::string_view bytes, std::string path)
    : bytes_(bytes), path_(std::move(path)) {}

void ByteReader::Fail(const std::string& why) const {
  throw InputError({"cannot read learner's state", path_, why,
                    "learn again without --resume, or restore the file from a copy"});
}

void ByteReader::Take(void* data, size_t size) {
  if (bytes_.size() < size) Fail("its content ends too early");
  std::memcpy(data, bytes_.data(), size);
  bytes_.remove_prefix(size);
}

size_t ByteReader::ReadCount(size_t bytes_each) {
  const int64_t count = ReadInt();
  if (count < 0 || static_cast<uint64_t>(count) > bytes_.size() / bytes_each) {
    Fail("its content ends too early");
  }
  return static_cast<size_t>(count);
}

int64_t ByteReader::ReadInt() {
  int64_t value = 0;
  Take(&value, sizeof(value));
  return value;
}

double ByteReader::ReadDouble() {
  double value = 0.0;
  Take(&value, sizeof(value));
  return value;
}

std::string ByteReader::ReadText() {
  std::string text(ReadCount(1), '\0');
  Take(text.data(), text.size());
  return text;
}

std::vector<float> ByteReader::ReadFloats() {
  std::vector<float> values(ReadCount(sizeof(float)));
  Take(values.data(), values.size() * sizeof(float));
  return values;
}

Eigen::VectorXd ByteReader::ReadVector() {
  Eigen::VectorXd values(static_cast<Eigen::Index>(ReadCount(sizeof(double))));
  Take(values.data(), static_cast<size_t>(values.size()) * sizeof(double));
  return values;
}

Eigen::MatrixXd ByteReader::ReadMatrix() {
  const int64_t rows = ReadInt();
  const Eigen::VectorXd values = ReadVector();
  if (rows < 0 || (rows == 0 && values.size() > 0) || (rows > 0 && values.size() % rows != 0)) {
    Fail("a matrix of impossible size");
  }
  return values.reshaped(rows, rows > 0 ? values.size() / rows : 0);
}

void ByteReader::ExpectEnd() const {
  if (!bytes_.empty()) Fail("its content does not end where it should");
}

std::string Sealed(std::string_view magic, int64_t version, std::string_view content) {
  assert(magic.size() == kMagicSize);
  std::string bytes(magic);
  for (const int64_t value : {version, static_cast<int64_t>(content.size()), Checksum(content)}) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
  }
  bytes.append(content);
  return bytes;
}

std::string_view Unsealed(std::string_view magic, int64_t version, std::string_view bytes,
                          const std::string& path) {
  const ByteReader reader(bytes, path);
  if (bytes.substr(0, kMagicSize) != magic.substr(0, std::min(bytes.size(), kMagicSize))) {
    reader.Fail("it is another kind of file");
  }
  if (bytes.size() < kHeaderSize) reader.Fail("it is cut short");
  const int64_t found_version = IntAt(bytes, kMagicSize);
  if (found_version != version) {
    throw InputError({"cannot read learner's state", path,
                      "its format is version " + std::to_string(found_version) +
                          ", this program reads version " + std::to_string(version),
                      "use the program that wrote it, or learn again"});
  }
  const std::string_view content = bytes.substr(kHeaderSize);
  if (IntAt(bytes, kMagicSize + 8) != static_cast<int64_t>(content.size())) {
    reader.Fail("it is cut short");
  }
  if (IntAt(bytes, kMagicSize + 16) != Checksum(content)) {
    reader.Fail("it is damaged: its checksum is wrong");
  }
  return content;
}

}  // namespace calibrato
