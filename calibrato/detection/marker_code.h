#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "calibrato/sensors/image.h"

// Square markers of black and white modules, as the families of ArUco and AprilTag. A marker's
// corners are numbered clockwise as seen from the front, from the corner at which OpenCV's drawing
// of it begins.

namespace calibrato {

/// The modules of a marker that carry bits, 1 for white, row by row, the last one in the lowest
/// bit.
using MarkerCode = uint64_t;

/// A marker that was recognised in four corners of an image.
struct MarkerMatch {
  int id = 0;
  int turn = 0;  ///< The first of the four corners is the marker's corner of this number.
  int num_errors = 0;
};

/// The markers of one dictionary.
class MarkerCodes {
 public:
  /// @pre `dictionary` is one of kMarkerDictionaries.
  explicit MarkerCodes(std::string_view dictionary);

  int bits_per_side() const { return bits_per_side_; }
  /// The marker nearest to a code, in whichever of the four turns; nothing where that takes more
  /// than so many errors.
  std::optional<MarkerMatch> Identify(MarkerCode code, int max_errors) const;
  /// How many bits of a code differ from a marker's.
  int CountErrors(MarkerCode code, int id, int turn) const;
  /// The code that a marker's mirror image shows to whom reads `code` from the marker.
  MarkerCode Mirrored(MarkerCode code) const;

 private:
  int bits_per_side_ = 0;
  std::vector<MarkerCode> codes_;  // four turns of each marker
};

/// The codes of a dictionary, made once in the program.
[[nodiscard]] const MarkerCodes& CodesOf(std::string_view dictionary);

/// How a marker lies in a square of side 1.
struct MarkerLayout {
  int bits_per_side = 6;
  int border_modules = 2;  ///< Black modules on each side of the bits.
  double margin = 0.0;     ///< Between the square's sides and the black border.
};

/// The code of the marker in a square of the image; nothing where it has no black border, or black
/// and white differ by less than 12 grey levels.
/// @param corners  Of the square, clockwise as the image shows it, 2 x 4 [px], inside the image.
[[nodiscard]] std::optional<MarkerCode> ReadMarker(const GreyImage& image,
                                                   const Eigen::Matrix<double, 2, 4>& corners,
                                                   const MarkerLayout& layout);

}  // namespace calibrato
