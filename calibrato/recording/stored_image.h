#pragma once

#include <cstddef>
#include <string>
#include <variant>

#include "calibrato/sensors/camera_model.h"
#include "calibrato/sensors/image.h"

namespace calibrato {

/// The content of an image file: in a folder, or in a message of type CompressedImage.
struct EncodedFile {
  std::string bytes;     ///< PNG, JPEG, BMP, TIFF or PGM, as its first bytes tell.
  std::string encoding;  ///< "bayer_rggb8" where a grey image is a mosaic of colours; else unused.
};

/// Pixels that are not packed: a message of type Image, or a frame of a video.
struct RawPixels {
  Resolution resolution;
  /// ROS's name for what a pixel is: mono8, mono16, rgb8, bgr8, rgba8, bgra8, bayer_rggb8,
  /// bayer_bggr8, bayer_gbrg8, bayer_grbg8, the same with 16, or OpenCV's 8UC1, 16UC1, 8UC3.
  std::string encoding;
  bool is_big_endian = false;  ///< Of samples of 16 bits.
  size_t row_bytes = 0;        ///< From the beginning of one row to that of the next.
  std::string bytes;           ///< Rows from the top, pixels from the left.
};

/// An image as the recording has it, before anything is made of its pixels. Conversion passes it on
/// unchanged; calibration asks for GreyOf.
struct StoredImage {
  std::variant<EncodedFile, RawPixels> content;
  std::string where;  ///< For errors: "cam0/data/17.png" or "a.bag, /cam0/image_raw at 17".
};

/// The image in grey of 8 bits: what detection takes.
///
/// Colour becomes luminance (0.299 R + 0.587 G + 0.114 B). A mosaic of colours is interpolated to
/// luminance at each pixel. Of 16 bits, the smallest of 8, 10, 12, 14 and 16 that holds the
/// brightest pixel becomes 0..255 (recording/photo.h).
/// @throws InputError that names `where`: not an image, truncated, damaged, another encoding, fewer
/// bytes than the size needs, more than kMaxImagePixels.
[[nodiscard]] GreyImage GreyOf(const StoredImage& image);

/// A PNG of exactly these samples: grey of 8 or 16 bits (mosaics as well), RGB or RGBA of 8.
/// @throws InputError as GreyOf does.
[[nodiscard]] std::string PngOf(const RawPixels& pixels, const std::string& where);

/// True for the encodings of a mosaic of colours.
[[nodiscard]] bool IsMosaic(const std::string& encoding);

}  // namespace calibrato
