#pragma once

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

namespace calibrato {

/// What is wrong with the bytes of a file. Whoever knows the file makes an InputError of it.
/// Private to the room.
struct Damage {
  std::string why;
};

/// Takes one field after the other from little-endian bytes. Every length is held against what is
/// left before anything is done with it. Private to the room.
class ByteFields {
 public:
  explicit ByteFields(std::string_view bytes) : bytes_(bytes) {}

  /// An integer of its type's size. @throws Damage if fewer bytes are left.
  template <std::unsigned_integral T>
  T Take() {
    const std::string_view field = TakeBytes(sizeof(T));
    T value = 0;
    for (size_t i = 0; i < sizeof(T); ++i) {
      value |= static_cast<T>(static_cast<T>(static_cast<uint8_t>(field[i])) << (8 * i));
    }
    return value;
  }
  /// @throws Damage if fewer bytes are left.
  std::string_view TakeBytes(uint64_t count) {
    if (count > num_left()) {
      throw Damage{"a field of " + std::to_string(count) + " bytes has only " +
                   std::to_string(num_left())};
    }
    const std::string_view field = bytes_.substr(position_, count);
    position_ += count;
    return field;
  }
  /// Bytes behind their number, which is of 32 bits. @throws Damage
  std::string_view TakeString() { return TakeBytes(Take<uint32_t>()); }

  size_t position() const { return position_; }
  size_t num_left() const { return bytes_.size() - position_; }
  bool at_end() const { return num_left() == 0; }

 private:
  std::string_view bytes_;
  size_t position_ = 0;
};

/// Appends an integer, little-endian.
template <std::unsigned_integral T>
void Put(T value, std::string* bytes) {
  for (size_t i = 0; i < sizeof(T); ++i) {
    *bytes += static_cast<char>(static_cast<uint8_t>(static_cast<uint64_t>(value) >> (8 * i)));
  }
}

/// Appends text behind its number of bytes, which is of 32 bits.
inline void PutString(std::string_view text, std::string* bytes) {
  Put(static_cast<uint32_t>(text.size()), bytes);
  *bytes += text;
}

}  // namespace calibrato
