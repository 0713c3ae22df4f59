#include "calibrato/rendering/marker_bits.h"

#include <cassert>
#include <iterator>
#include <opencv2/aruco/dictionary.hpp>

#include "calibrato/sensors/board.h"

namespace calibrato {
namespace {

// OpenCV's number of a dictionary is its place in the list.
int DictionaryNumber(std::string_view name) {
  int number = 0;
  while (kMarkerDictionaries[number].name != name) {
    ++number;
    assert(number < static_cast<int>(std::size(kMarkerDictionaries)));
  }
  return number;
}

MarkerBits WithBorder(std::string_view name, int id, int border) {
  const cv::Ptr<cv::aruco::Dictionary> dictionary =
      cv::aruco::getPredefinedDictionary(DictionaryNumber(name));
  assert(id >= 0 && id < dictionary->bytesList.rows);
  const int size = dictionary->markerSize;
  const cv::Mat bits =
      cv::aruco::Dictionary::getBitsFromByteList(dictionary->bytesList.rowRange(id, id + 1), size);
  const int side = size + 2 * border;
  MarkerBits marker(side, std::vector<bool>(side, false));
  for (int row = 0; row < size; ++row) {
    for (int column = 0; column < size; ++column) {
      marker[border + row][border + column] = bits.at<uint8_t>(row, column) != 0;
    }
  }
  return marker;
}

}  // namespace

MarkerBits DictionaryMarker(std::string_view dictionary, int id) {
  return WithBorder(dictionary, id, 1);
}

MarkerBits AprilGridTag(int id) {
  const MarkerBits marker = WithBorder("DICT_APRILTAG_36h11", id, 2);
  MarkerBits turned;
  for (auto row = marker.rbegin(); row != marker.rend(); ++row) {
    turned.emplace_back(row->rbegin(), row->rend());
  }
  return turned;
}

}  // namespace calibrato
