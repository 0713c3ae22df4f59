#pragma once

#include <string>

#include "calibrato/recording/stored_image.h"
#include "calibrato/sensors/image.h"

namespace calibrato {

/// Reads a PNG, JPEG, BMP, TIFF or PGM as grey. Colour becomes luminance; the EXIF orientation is
/// ignored, since calibration is about the sensor's own pixels, and so is transparency. What a file
/// is, its first bytes tell, not its name. Of animated PNGs and TIFFs of several pages the first
/// picture is read.
///
/// Images of 16 bits are scaled to 8: the smallest of 8, 10, 12, 14 and 16 bits that holds the
/// brightest pixel becomes 0..255, because industrial cameras store 10 or 12 bits in files of 16,
/// which would be all but black otherwise.
/// @throws InputError that names the file: unreadable, a folder, empty, truncated, not an image,
/// or more than 100 megapixels (judged by its header, before any memory is spent on pixels).
[[nodiscard]] GreyImage ReadPhoto(const std::string& path);

/// The same of a file's content; `where` stands in for its path.
[[nodiscard]] GreyImage DecodePhoto(const EncodedFile& file, const std::string& where);

/// The content of a PNG that reads back to the same pixels.
[[nodiscard]] std::string EncodePng(const GreyImage& image);
[[nodiscard]] std::string EncodePng(const RgbImage& image);

/// The content of a JPEG, small enough to be sent ten times a second: to be looked at, not
/// measured.
[[nodiscard]] std::string EncodeJpeg(const GreyImage& image);

}  // namespace calibrato
