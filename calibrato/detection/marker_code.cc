#include "calibrato/detection/marker_code.h"

#include <Eigen/LU>
#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <iterator>
#include <map>
#include <mutex>
#include <numeric>
#include <opencv2/aruco.hpp>

#include "calibrato/sensors/board.h"

namespace calibrato {
namespace {

constexpr double kMinContrast = 12.0;  // [grey levels]

// The code read by someone who begins at the next corner, clockwise.
MarkerCode Turned(MarkerCode code, int bits_per_side) {
  const int n = bits_per_side;
  MarkerCode turned = 0;
  for (int row = 0; row < n; ++row) {
    for (int column = 0; column < n; ++column) {
      const int from = column * n + (n - 1 - row);
      turned = turned << 1 | (code >> (n * n - 1 - from) & 1);
    }
  }
  return turned;
}

// The homography from the square (0, 0), (1, 0), (1, 1), (0, 1) to four corners.
Eigen::Matrix3d SquareToCorners(const Eigen::Matrix<double, 2, 4>& corners) {
  // The fourth corner's homogeneous coordinates are those of a parallelogram but for the factors of
  // the others: a (x0, 1) - b (x1, 1) + c (x2, 1) - (x3, 1) = 0.
  Eigen::Matrix3d three;
  three << corners.leftCols<3>(), Eigen::RowVector3d::Ones();
  const Eigen::Vector3d factors =
      three.inverse() * Eigen::Vector3d(corners(0, 3), corners(1, 3), 1.0);
  const Eigen::Vector3d h0 = factors(0) * three.col(0);
  const Eigen::Vector3d h1 = -factors(1) * three.col(1);
  const Eigen::Vector3d h3(corners(0, 3), corners(1, 3), 1.0);
  Eigen::Matrix3d H;
  H << h1 - h0, h3 - h0, h0;
  return H;
}

class Sampler {
 public:
  Sampler(const GreyImage& image, const Eigen::Matrix3d& H) : image_(image), H_(H) {}

  // The mean brightness about a place of the square, of five samples `reach` apart.
  double Mean(double x, double y, double reach) const {
    return 0.2 * (At(x, y) + At(x - reach, y - reach) + At(x + reach, y - reach) +
                  At(x - reach, y + reach) + At(x + reach, y + reach));
  }

 private:
  double At(double x, double y) const {
    const Eigen::Vector3d h = H_ * Eigen::Vector3d(x, y, 1.0);
    if (!(std::abs(h.z()) > 1e-12)) return 0.0;  // beyond the horizon
    const auto& [width, height] = image_.resolution;
    const double u = std::clamp(h.x() / h.z(), 0.0, width - 1.001);
    const double v = std::clamp(h.y() / h.z(), 0.0, height - 1.001);
    const auto column = static_cast<size_t>(u);
    const auto row = static_cast<size_t>(v);
    const double du = u - static_cast<double>(column);
    const double dv = v - static_cast<double>(row);
    const auto stride = static_cast<size_t>(width);
    const uint8_t* pixel = image_.pixels.data() + row * stride + column;
    return (1.0 - dv) * ((1.0 - du) * pixel[0] + du * pixel[1]) +
           dv * ((1.0 - du) * pixel[stride] + du * pixel[stride + 1]);
  }

  const GreyImage& image_;
  const Eigen::Matrix3d& H_;
};

}  // namespace

MarkerCodes::MarkerCodes(std::string_view dictionary) {
  const auto* known = std::find_if(std::begin(kMarkerDictionaries), std::end(kMarkerDictionaries),
                                   [&](const auto& other) { return other.name == dictionary; });
  assert(known != std::end(kMarkerDictionaries));
  const auto markers = cv::aruco::getPredefinedDictionary(
      static_cast<int>(std::distance(std::begin(kMarkerDictionaries), known)));
  bits_per_side_ = markers->markerSize;
  for (int id = 0; id < markers->bytesList.rows; ++id) {
    const cv::Mat bits = cv::aruco::Dictionary::getBitsFromByteList(
        markers->bytesList.rowRange(id, id + 1), bits_per_side_);
    MarkerCode code = std::accumulate(
        bits.begin<uint8_t>(), bits.end<uint8_t>(), MarkerCode{0},
        [](MarkerCode sum, uint8_t bit) { return sum << 1 | (bit != 0 ? 1U : 0U); });
    for (int turn = 0; turn < 4; ++turn) {
      codes_.push_back(code);
      code = Turned(code, bits_per_side_);
    }
  }
}

int MarkerCodes::CountErrors(MarkerCode code, int id, int turn) const {
  return std::popcount(code ^ codes_[4 * static_cast<size_t>(id) + static_cast<size_t>(turn)]);
}

std::optional<MarkerMatch> MarkerCodes::Identify(MarkerCode code, int max_errors) const {
  std::optional<MarkerMatch> best;
  for (size_t k = 0; k < codes_.size(); ++k) {
    const int num_errors = std::popcount(code ^ codes_[k]);
    if (num_errors > max_errors || (best && num_errors >= best->num_errors)) continue;
    best = {static_cast<int>(k / 4), static_cast<int>(k % 4), num_errors};
  }
  return best;
}

MarkerCode MarkerCodes::Mirrored(MarkerCode code) const {
  const int n = bits_per_side_;
  MarkerCode mirrored = 0;
  for (int row = 0; row < n; ++row) {
    for (int column = 0; column < n; ++column) {
      mirrored = mirrored << 1 | (code >> (n * n - 1 - (column * n + row)) & 1);
    }
  }
  return mirrored;
}

const MarkerCodes& CodesOf(std::string_view dictionary) {
  static std::mutex mutex;
  static std::map<std::string_view, MarkerCodes> known;
  const std::lock_guard lock(mutex);
  const auto found = known.find(dictionary);
  if (found != known.end()) return found->second;
  // The key outlives its caller's.
  const auto* name = std::find_if(std::begin(kMarkerDictionaries), std::end(kMarkerDictionaries),
                                  [&](const auto& other) { return other.name == dictionary; });
  assert(name != std::end(kMarkerDictionaries));
  return known.emplace(name->name, MarkerCodes(dictionary)).first->second;
}

std::optional<MarkerCode> ReadMarker(const GreyImage& image,
                                     const Eigen::Matrix<double, 2, 4>& corners,
                                     const MarkerLayout& layout) {
  if (image.resolution.width < 2 || image.resolution.height < 2) return std::nullopt;
  const Eigen::Matrix3d H = SquareToCorners(corners);
  if (!H.allFinite()) return std::nullopt;
  const Sampler sampler(image, H);
  const int num_modules = layout.bits_per_side + 2 * layout.border_modules;
  const double module = (1.0 - 2.0 * layout.margin) / num_modules;
  std::vector<double> bits;
  std::vector<double> border;
  const int first = layout.border_modules - 1;  // of the innermost ring of the border
  const int last = first + layout.bits_per_side + 1;
  for (int row = first; row <= last; ++row) {
    for (int column = first; column <= last; ++column) {
      const double brightness = sampler.Mean(layout.margin + (column + 0.5) * module,
                                             layout.margin + (row + 0.5) * module, 0.2 * module);
      const bool is_border = row == first || row == last || column == first || column == last;
      (is_border ? border : bits).push_back(brightness);
    }
  }
  std::vector<double> sorted = bits;
  std::sort(sorted.begin(), sorted.end());
  const double white = sorted[sorted.size() - 1 - sorted.size() / 10];
  std::sort(border.begin(), border.end());
  const double black = border[border.size() / 4];
  const double threshold = 0.5 * (black + white);
  if (!(white - black >= kMinContrast) || border[border.size() * 9 / 10] > threshold) {
    return std::nullopt;
  }
  // Where a corner was mistaken, as for the far one of the small square that touches it, the bits
  // may be right still, but two sides leave the black border: a quarter of its outermost ring is
  // bright. Blur alone does not do so much.
  std::vector<double> rim;
  for (int k = 0; layout.border_modules > 1 && k + 1 < num_modules; ++k) {
    const double along = layout.margin + (k + 0.5) * module;
    const double near = layout.margin + 0.5 * module;
    const double far = 1.0 - near;
    for (const auto& [x, y] : {std::pair(along, near), std::pair(far, along),
                               std::pair(1.0 - along, far), std::pair(near, 1.0 - along)}) {
      rim.push_back(sampler.Mean(x, y, 0.2 * module));
    }
  }
  std::sort(rim.begin(), rim.end());
  if (!rim.empty() && rim[rim.size() * 5 / 6] > threshold) return std::nullopt;
  return std::accumulate(bits.begin(), bits.end(), MarkerCode{0},
                         [&](MarkerCode code, double brightness) {
                           return code << 1 | (brightness > threshold ? 1U : 0U);
                         });
}

}  // namespace calibrato
