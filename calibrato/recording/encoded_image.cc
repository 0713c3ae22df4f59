#include "calibrato/recording/encoded_image.h"

#include <zlib.h>

#include <cstdint>
#include <map>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "calibrato/base/files.h"
#include "calibrato/base/input_error.h"

namespace calibrato {
namespace {

using namespace std::string_view_literals;

// The largest file that a hundred megapixels of three 16-bit samples can fill, with some room.
constexpr size_t kMaxFileBytes = size_t{1} << 30;
constexpr int64_t kMaxSide = 1'000'000;

// Thrown by the walks below and given its file by ReadEncodedImage.
struct Flaw {
  std::string why;
  std::string remedy;
};

[[noreturn]] void FailTruncated() {
  throw Flaw{"the file is truncated", "copy it again or leave it out with --images"};
}

[[noreturn]] void FailDamaged(const std::string& why) {
  throw Flaw{"the file is damaged: " + why, "copy it again or leave it out with --images"};
}

// Bytes at a position; asking for more than there are means that the file is truncated.
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : bytes_(bytes) {}

  uint8_t Byte(size_t position) const {
    if (position >= bytes_.size()) FailTruncated();
    return static_cast<uint8_t>(bytes_[position]);
  }
  uint32_t BigEndian(size_t position, int count) const {
    uint32_t value = 0;
    for (int i = 0; i < count; ++i) {
      value = value << 8 | Byte(position + static_cast<size_t>(i));
    }
    return value;
  }
  uint32_t LittleEndian(size_t position, int count) const {
    uint32_t value = 0;
    for (int i = 0; i < count; ++i) {
      value |= uint32_t{Byte(position + static_cast<size_t>(i))} << (8 * i);
    }
    return value;
  }
  std::string_view Part(size_t position, size_t count) const {
    if (position > bytes_.size() || count > bytes_.size() - position) FailTruncated();
    return bytes_.substr(position, count);
  }
  size_t size() const { return bytes_.size(); }

 private:
  std::string_view bytes_;
};

Resolution CheckedResolution(int64_t width, int64_t height) {
  if (width <= 0 || height <= 0) FailDamaged("its header gives no image size");
  if (width > kMaxSide || height > kMaxSide || width * height > kMaxImagePixels) {
    throw Flaw{"it claims " + std::to_string(width) + " x " + std::to_string(height) +
                   " pixels, the limit is 100 megapixels",
               "reduce it to the camera's own resolution"};
  }
  return {static_cast<int>(width), static_cast<int>(height)};
}

std::optional<ImageFormat> Recognise(std::string_view bytes) {
  if (bytes.starts_with("\x89PNG\r\n\x1a\n"sv)) return ImageFormat::kPng;
  if (bytes.starts_with("\xff\xd8\xff"sv)) return ImageFormat::kJpeg;
  if (bytes.starts_with("II*\0"sv) || bytes.starts_with("MM\0*"sv)) return ImageFormat::kTiff;
  if (bytes.starts_with("BM"sv)) return ImageFormat::kBmp;
  if (bytes.size() > 2 && bytes[0] == 'P' && (bytes[1] == '2' || bytes[1] == '5') &&
      " \t\r\n#"sv.find(bytes[2]) != std::string_view::npos) {
    return ImageFormat::kPgm;
  }
  return std::nullopt;
}

// Source: PNG specification, 5.3 (chunk layout) and 11.2.2 (IHDR). Ancillary chunks (their first
// letter is small) carry colour profiles and comments, of which the decoder would only complain.
EncodedImage WalkPng(const std::string& bytes) {
  const ByteReader reader(bytes);
  EncodedImage image{ImageFormat::kPng, {}, bytes.substr(0, 8)};
  bool has_pixels = false;
  size_t position = 8;
  while (true) {
    const size_t length = reader.BigEndian(position, 4);
    const std::string_view type = reader.Part(position + 4, 4);
    const std::string_view chunk = reader.Part(position, length + 12);
    const bool is_critical = (type[0] & 0x20) == 0;
    if (is_critical) {
      const auto* checked = reinterpret_cast<const Bytef*>(chunk.data() + 4);
      if (crc32_z(0, checked, length + 4) != reader.BigEndian(position + 8 + length, 4)) {
        FailDamaged("the checksum of a part does not match");
      }
      image.bytes += chunk;
    }
    if (position == 8) {
      if (type != "IHDR" || length < 8) FailDamaged("it does not begin with a header");
      image.resolution =
          CheckedResolution(reader.BigEndian(position + 8, 4), reader.BigEndian(position + 12, 4));
    }
    has_pixels = has_pixels || type == "IDAT";
    if (type == "IEND") break;
    position += length + 12;
  }
  if (!has_pixels) FailDamaged("it holds no pixels");
  return image;
}

// The position of the next marker at or behind the entropy-coded bytes from `position` on. In
// these, FF 00 stands for the byte FF, and FF D0 to FF D7 are restart markers.
size_t EndOfScan(std::string_view bytes, size_t position) {
  while (true) {
    position = bytes.find('\xff', position);
    if (position == std::string_view::npos || position + 1 >= bytes.size()) FailTruncated();
    const auto next = static_cast<uint8_t>(bytes[position + 1]);
    const bool is_data = next == 0x00 || (next >= 0xd0 && next <= 0xd7);
    if (!is_data && next != 0xff) return position;
    position += is_data ? 2 : 1;
  }
}

// Source: ITU-T T.81, annex B. An end marker inside a segment belongs to a thumbnail, which is why
// the segments are skipped by their length instead of searching the file for FF D9.
EncodedImage WalkJpeg(const std::string& bytes) {
  const ByteReader reader(bytes);
  std::optional<Resolution> resolution;
  size_t position = 2;
  while (true) {
    position = bytes.find('\xff', position);
    if (position == std::string::npos) FailTruncated();
    const uint8_t marker = reader.Byte(position + 1);
    if (marker == 0xff) {
      ++position;
      continue;
    }
    position += 2;
    if (marker == 0xd9) break;
    const bool has_no_length = marker <= 0x01 || (marker >= 0xd0 && marker <= 0xd8);
    if (has_no_length) continue;
    const size_t length = reader.BigEndian(position, 2);
    if (length < 2) FailDamaged("a segment has no length");
    const bool is_frame_header =
        marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
    if (is_frame_header) {
      resolution =
          CheckedResolution(reader.BigEndian(position + 5, 2), reader.BigEndian(position + 3, 2));
      // Four are inks (CMYK), of which decoders disagree whether 0 or 255 is white.
      const uint8_t num_components = reader.Byte(position + 7);
      if (num_components > 3) {
        throw Flaw{"it has " + std::to_string(num_components) + " colour components, as for print",
                   "convert it to grey or RGB"};
      }
    }
    static_cast<void>(reader.Part(position, length));
    position += length;
    if (marker == 0xda) {
      if (!resolution) FailDamaged("its pixels come before its header");
      position = EndOfScan(bytes, position);
    }
  }
  if (!resolution) FailDamaged("its header gives no image size");
  return {ImageFormat::kJpeg, *resolution, bytes.substr(0, position)};
}

Resolution WalkBmp(std::string_view bytes) {
  const ByteReader reader(bytes);
  const bool is_os2 = reader.LittleEndian(14, 4) == 12;
  Resolution resolution;
  size_t bits_per_pixel = 0;
  uint32_t compression = 0;
  if (is_os2) {
    resolution = CheckedResolution(reader.LittleEndian(18, 2), reader.LittleEndian(20, 2));
    bits_per_pixel = reader.LittleEndian(24, 2);
  } else {
    // A negative height means that the rows run from top to bottom.
    const int64_t width = static_cast<int32_t>(reader.LittleEndian(18, 4));
    const int64_t height = static_cast<int32_t>(reader.LittleEndian(22, 4));
    resolution = CheckedResolution(width, height < 0 ? -height : height);
    bits_per_pixel = reader.LittleEndian(28, 2);
    compression = reader.LittleEndian(30, 4);
  }
  const bool is_run_length_coded = compression == 1 || compression == 2;
  if (is_run_length_coded) {
    static_cast<void>(reader.Part(0, reader.LittleEndian(2, 4)));
  } else {
    const size_t row_bytes = (static_cast<size_t>(resolution.width) * bits_per_pixel + 31) / 32 * 4;
    static_cast<void>(reader.Part(reader.LittleEndian(10, 4),
                                  row_bytes * static_cast<size_t>(resolution.height)));
  }
  return resolution;
}

// Source: TIFF 6.0, section 2. The first directory gives the size (ImageWidth 256, ImageLength 257)
// and where the pixels are, in strips (273 and 279) or tiles (324 and 325).
Resolution WalkTiff(std::string_view bytes) {
  const ByteReader reader(bytes);
  const bool is_little = bytes[0] == 'I';
  const auto number = [&](size_t position, size_t count) {
    return is_little ? reader.LittleEndian(position, static_cast<int>(count))
                     : reader.BigEndian(position, static_cast<int>(count));
  };
  // The numbers of an entry: of two bytes or four, in the entry itself where they fit.
  const auto numbers = [&](size_t entry) {
    constexpr uint32_t kShort = 3;
    const size_t size = number(entry + 2, 2) == kShort ? 2 : 4;
    const size_t count = number(entry + 4, 4);
    const size_t begin = count * size <= 4 ? entry + 8 : number(entry + 8, 4);
    static_cast<void>(reader.Part(begin, count * size));
    std::vector<uint32_t> values(count);
    for (size_t i = 0; i < count; ++i) values[i] = number(begin + i * size, size);
    return values;
  };
  const size_t directory = number(4, 4);
  const size_t num_entries = number(directory, 2);
  static_cast<void>(reader.Part(directory + 2, 12 * num_entries + 4));  // and the next one's place
  std::map<uint32_t, std::vector<uint32_t>> entries;
  for (size_t i = 0; i < num_entries; ++i) {
    const size_t entry = directory + 2 + 12 * i;
    const uint32_t tag = number(entry, 2);
    for (const uint32_t wanted : {256, 257, 273, 279, 324, 325}) {
      if (tag == wanted) entries[tag] = numbers(entry);
    }
  }
  for (const auto& [offsets, counts] : {std::pair(273, 279), std::pair(324, 325)}) {
    if (entries[offsets].size() != entries[counts].size()) FailDamaged("it has parts of no size");
    for (size_t i = 0; i < entries[offsets].size(); ++i) {
      static_cast<void>(reader.Part(entries[offsets][i], entries[counts][i]));
    }
  }
  const auto first = [&](uint32_t tag) { return entries[tag].empty() ? 0 : entries[tag].front(); };
  return CheckedResolution(first(256), first(257));
}

// Source: the Netpbm format PGM; white space and comments from '#' to the end of a line separate
// numbers.
Resolution WalkPgm(std::string_view bytes) {
  const ByteReader reader(bytes);
  size_t position = 2;
  const auto next_number = [&] {
    while (true) {
      const uint8_t byte = reader.Byte(position);
      if (byte == '#') {
        while (reader.Byte(position) != '\n') ++position;
      } else if (byte != ' ' && (byte < '\t' || byte > '\r')) {
        break;
      }
      ++position;
    }
    const size_t begin = position;
    int64_t number = 0;
    for (; reader.Byte(position) >= '0' && reader.Byte(position) <= '9'; ++position) {
      if (number <= kMaxSide) number = 10 * number + (reader.Byte(position) - '0');
    }
    if (position == begin) FailDamaged("a number is missing");
    return number;
  };
  const int64_t width = next_number();
  const int64_t height = next_number();
  const Resolution resolution = CheckedResolution(width, height);
  const int64_t largest = next_number();
  const auto num_pixels = static_cast<size_t>(width * height);
  const bool is_binary = bytes[1] == '5';
  if (is_binary) {
    static_cast<void>(reader.Part(position + 1, num_pixels * (largest > 255 ? 2 : 1)));
  } else {
    for (size_t i = 0; i < num_pixels; ++i) static_cast<void>(next_number());
  }
  return resolution;
}

// May empty `bytes`.
EncodedImage Walk(std::string& bytes) {
  if (bytes.empty()) throw Flaw{"the file is empty", "copy it again or leave it out with --images"};
  const std::optional<ImageFormat> format = Recognise(bytes);
  if (!format) {
    throw Flaw{"it is not an image that calibrato reads", "give PNG, JPEG, BMP, TIFF or PGM"};
  }
  switch (*format) {
    case ImageFormat::kPng:
      return WalkPng(bytes);
    case ImageFormat::kJpeg:
      return WalkJpeg(bytes);
    case ImageFormat::kBmp:
      return {*format, WalkBmp(bytes), std::move(bytes)};
    case ImageFormat::kTiff:
      return {*format, WalkTiff(bytes), std::move(bytes)};
    case ImageFormat::kPgm:
      return {*format, WalkPgm(bytes), std::move(bytes)};
  }
  throw Flaw{};
}

}  // namespace

EncodedImage ReadEncodedImage(const std::string& path) {
  return ExamineEncodedImage(ReadFile(path, kMaxFileBytes), path);
}

EncodedImage ExamineEncodedImage(std::string bytes, const std::string& where) {
  try {
    return Walk(bytes);
  } catch (const Flaw& flaw) {
    throw InputError({"cannot read image", where, flaw.why, flaw.remedy});
  }
}

std::string ImageExtension(std::string_view bytes) {
  const std::optional<ImageFormat> format = Recognise(bytes);
  if (!format) return "";
  switch (*format) {
    case ImageFormat::kPng:
      return "png";
    case ImageFormat::kJpeg:
      return "jpg";
    case ImageFormat::kBmp:
      return "bmp";
    case ImageFormat::kTiff:
      return "tiff";
    case ImageFormat::kPgm:
      return "pgm";
  }
  return "";
}

}  // namespace calibrato
