#include "calibrato/recording/ros_messages.h"

#include <bit>
#include <cassert>
#include <concepts>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "calibrato/recording/byte_fields.h"
#include "calibrato/recording/encoded_image.h"

namespace calibrato {
namespace {

constexpr int64_t kNanosecondsPerSecond = 1'000'000'000;
constexpr double kNoValue = -1.0;
constexpr size_t kCdrHeadBytes = 4;
constexpr size_t kCovarianceNumbers = 9;

template <typename T>
using BitsOf = std::conditional_t<sizeof(T) == 8, uint64_t,
                                  std::conditional_t<sizeof(T) == 4, uint32_t, uint8_t>>;

// Takes the fields of a message in turn.
class MessageReader {
 public:
  MessageReader(MessageEncoding encoding, std::string_view bytes)
      : is_cdr_(encoding == MessageEncoding::kCdr), fields_(bytes) {
    if (!is_cdr_) return;
    // The second byte: 0 for big-endian, 1 for little-endian; others have layouts of their own.
    const std::string_view head = fields_.TakeBytes(kCdrHeadBytes);
    if (head[0] != 0 || (head[1] != 0 && head[1] != 1)) {
      throw Damage{"a message is of a CDR that ROS 2 does not write"};
    }
    is_big_endian_ = head[1] == 0;
  }

  template <typename T>
  T Number() {
    if (is_cdr_) {
      const size_t place = fields_.position() - kCdrHeadBytes;
      fields_.TakeBytes((sizeof(T) - place % sizeof(T)) % sizeof(T));
    }
    auto bits = fields_.Take<BitsOf<T>>();
    if (is_big_endian_) {
      BitsOf<T> swapped = 0;
      for (size_t i = 0; i < sizeof(T); ++i) {
        swapped = static_cast<BitsOf<T>>(swapped << (sizeof(T) > 1 ? 8 : 0)) |
                  static_cast<BitsOf<T>>(static_cast<uint8_t>(bits >> (8 * i)));
      }
      bits = swapped;
    }
    return std::bit_cast<T>(bits);
  }
  Eigen::Vector3d Vector() {
    const auto x = Number<double>();
    const auto y = Number<double>();
    return {x, y, Number<double>()};
  }
  std::string_view Bytes() { return fields_.TakeBytes(Number<uint32_t>()); }
  std::string_view Text() {
    std::string_view text = Bytes();
    if (is_cdr_ && text.ends_with('\0')) text.remove_suffix(1);
    return text;
  }
  // The header's stamp; its frame follows.
  Time Stamp() {
    if (!is_cdr_) Number<uint32_t>();  // the sequence number
    int64_t seconds = 0;
    if (is_cdr_) {
      seconds = Number<int32_t>();
    } else {
      seconds = Number<uint32_t>();
    }
    if (seconds < 0) throw Damage{"a message's stamp lies before the year 1970"};
    return Time::FromNanoseconds(seconds * kNanosecondsPerSecond + Number<uint32_t>());
  }

 private:
  bool is_cdr_;
  bool is_big_endian_ = false;
  ByteFields fields_;
};

// Appends them in turn.
class MessageWriter {
 public:
  MessageWriter(MessageEncoding encoding, Time stamp, const std::string& frame_id,
                uint32_t sequence)
      : is_cdr_(encoding == MessageEncoding::kCdr) {
    assert(stamp >= Time());
    if (is_cdr_) {
      bytes_ = std::string("\0\1\0\0", kCdrHeadBytes);
    } else {
      Number(sequence);
    }
    Number(static_cast<uint32_t>(stamp.nanoseconds() / kNanosecondsPerSecond));
    Number(static_cast<uint32_t>(stamp.nanoseconds() % kNanosecondsPerSecond));
    Text(frame_id);
  }

  template <typename T>
  void Number(T value) {
    if (is_cdr_) {
      while ((bytes_.size() - kCdrHeadBytes) % sizeof(T) != 0) bytes_ += '\0';
    }
    Put(std::bit_cast<BitsOf<T>>(value), &bytes_);
  }
  void Vector(const Eigen::Vector3d& vector) {
    for (const double x : vector) Number(x);
  }
  void Bytes(std::string_view content) {
    Number(static_cast<uint32_t>(content.size()));
    bytes_ += content;
  }
  void Text(const std::string& text) {
    // CDR counts a zero behind the text.
    Bytes(is_cdr_ ? std::string_view(text.c_str(), text.size() + 1) : std::string_view(text));
  }
  std::string Take() { return std::move(bytes_); }

 private:
  bool is_cdr_;
  std::string bytes_;
};

std::optional<Eigen::Vector3d> VectorWithCovariance(MessageReader* reader) {
  const Eigen::Vector3d vector = reader->Vector();
  const auto first = reader->Number<double>();
  for (size_t k = 1; k < kCovarianceNumbers; ++k) reader->Number<double>();
  if (first == kNoValue) return std::nullopt;
  return vector;
}

void PutVectorWithCovariance(const std::optional<Eigen::Vector3d>& vector, MessageWriter* writer) {
  writer->Vector(vector.value_or(Eigen::Vector3d::Zero()));
  writer->Number(vector ? 0.0 : kNoValue);
  for (size_t k = 1; k < kCovarianceNumbers; ++k) writer->Number(0.0);
}

int SideFromMessage(uint32_t side) {
  if (side > static_cast<uint32_t>(std::numeric_limits<int>::max())) {
    throw Damage{"an image claims a side of " + std::to_string(side) + " pixels"};
  }
  return static_cast<int>(side);
}

}  // namespace

Time StampOfMessage(MessageEncoding encoding, std::string_view bytes) {
  return MessageReader(encoding, bytes).Stamp();
}

ImageMessage ReadImageMessage(MessageEncoding encoding, std::string_view bytes) {
  MessageReader reader(encoding, bytes);
  ImageMessage image;
  image.stamp = reader.Stamp();
  image.frame_id = reader.Text();
  image.pixels.resolution.height = SideFromMessage(reader.Number<uint32_t>());
  image.pixels.resolution.width = SideFromMessage(reader.Number<uint32_t>());
  image.pixels.encoding = reader.Text();
  image.pixels.is_big_endian = reader.Number<uint8_t>() != 0;
  image.pixels.row_bytes = reader.Number<uint32_t>();
  image.pixels.bytes = reader.Bytes();
  return image;
}

std::string ImageMessageBytes(MessageEncoding encoding, const ImageMessage& image,
                              uint32_t sequence) {
  MessageWriter writer(encoding, image.stamp, image.frame_id, sequence);
  writer.Number(static_cast<uint32_t>(image.pixels.resolution.height));
  writer.Number(static_cast<uint32_t>(image.pixels.resolution.width));
  writer.Text(image.pixels.encoding);
  writer.Number(static_cast<uint8_t>(image.pixels.is_big_endian ? 1 : 0));
  writer.Number(static_cast<uint32_t>(image.pixels.row_bytes));
  writer.Bytes(image.pixels.bytes);
  return writer.Take();
}

CompressedImageMessage ReadCompressedImageMessage(MessageEncoding encoding,
                                                  std::string_view bytes) {
  MessageReader reader(encoding, bytes);
  CompressedImageMessage image;
  image.stamp = reader.Stamp();
  image.frame_id = reader.Text();
  const std::string_view format = reader.Text();
  const std::string original(format.substr(0, format.find(';')));
  if (IsMosaic(original)) image.file.encoding = original;
  image.file.bytes = reader.Bytes();
  return image;
}

std::string CompressedImageMessageBytes(MessageEncoding encoding,
                                        const CompressedImageMessage& image, uint32_t sequence) {
  MessageWriter writer(encoding, image.stamp, image.frame_id, sequence);
  const std::string extension = ImageExtension(image.file.bytes);
  const std::string format = extension == "jpg" ? "jpeg" : extension;
  writer.Text(IsMosaic(image.file.encoding) ? image.file.encoding + "; " + format + " compressed "
                                            : format);
  writer.Bytes(image.file.bytes);
  return writer.Take();
}

ImuMessage ReadImuMessage(MessageEncoding encoding, std::string_view bytes) {
  MessageReader reader(encoding, bytes);
  ImuMessage imu;
  imu.stamp = reader.Stamp();
  imu.frame_id = reader.Text();
  constexpr size_t kOrientationNumbers = 4 + kCovarianceNumbers;
  for (size_t k = 0; k < kOrientationNumbers; ++k) reader.Number<double>();
  imu.gyro = VectorWithCovariance(&reader);
  imu.accel = VectorWithCovariance(&reader);
  return imu;
}

std::string ImuMessageBytes(MessageEncoding encoding, const ImuMessage& imu, uint32_t sequence) {
  MessageWriter writer(encoding, imu.stamp, imu.frame_id, sequence);
  for (const double x : {0.0, 0.0, 0.0, 1.0, kNoValue}) writer.Number(x);
  for (size_t k = 1; k < kCovarianceNumbers; ++k) writer.Number(0.0);
  PutVectorWithCovariance(imu.gyro, &writer);
  PutVectorWithCovariance(imu.accel, &writer);
  return writer.Take();
}

}  // namespace calibrato
