#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "calibrato/sensors/camera_model.h"

namespace calibrato {

enum class ImageFormat { kPng, kJpeg, kBmp, kTiff, kPgm };

/// An image file before it is decoded: what it claims to be, from its first bytes, not its name.
struct EncodedImage {
  ImageFormat format;
  Resolution resolution;  ///< As its header says: known before any memory is spent on pixels.
  std::string bytes;      ///< All that a decoder needs, and nothing that would make it complain.
};

/// The most pixels that an image may claim to have. A file of a few kilobytes can claim billions.
inline constexpr int64_t kMaxImagePixels = 100'000'000;

/// Reads an image file and walks through its parts without decoding them. Decoders answer a JPEG
/// that ends too early with an image that is grey from there on, and others with lines on stderr,
/// so its end is looked for here:
/// - JPEG: every segment up to the marker of its end (an end inside the thumbnail does not count);
/// - PNG: every chunk up to IEND, the checksum of those that carry the image; the others are left
///   out;
/// - BMP, TIFF, PGM: the pixels that the header announces.
/// Bytes behind the end are ignored. Of an animated PNG that is the first picture, of a TIFF of
/// several pages the first page; a GIF is not read.
/// @throws InputError that names the file: missing, a folder, empty, not an image of these formats,
/// truncated, damaged, more than kMaxImagePixels, a JPEG of inks (CMYK).
[[nodiscard]] EncodedImage ReadEncodedImage(const std::string& path);

/// The same of a file's content; `where` stands in for its path.
[[nodiscard]] EncodedImage ExamineEncodedImage(std::string bytes, const std::string& where);

/// The format as the first bytes tell it: "png", "jpg", "bmp", "tiff", "pgm"; empty if it is none.
[[nodiscard]] std::string ImageExtension(std::string_view bytes);

}  // namespace calibrato
