#include "calibrato/detection/marker_code.h"

#include <gtest/gtest.h>

#include <opencv2/aruco.hpp>
#include <string>

namespace calibrato {
namespace {

constexpr int kModule = 6;  // [px]
constexpr int kMargin = 20;

// OpenCV's own drawing of a marker on white.
GreyImage Draw(const std::string& dictionary, int opencv_dictionary, int id, int border) {
  const int side = kModule * (CodesOf(dictionary).bits_per_side() + 2 * border);
  cv::Mat marker;
  cv::aruco::drawMarker(cv::aruco::getPredefinedDictionary(opencv_dictionary), id, side, marker,
                        border);
  const int width = side + 2 * kMargin;
  GreyImage image{{width, width}, std::vector<uint8_t>(static_cast<size_t>(width * width), 230)};
  for (int v = 0; v < side; ++v) {
    for (int u = 0; u < side; ++u) {
      image.pixels[static_cast<size_t>((v + kMargin) * width + u + kMargin)] =
          marker.at<uint8_t>(v, u) > 0 ? 230 : 25;
    }
  }
  return image;
}

// Clockwise from the corner of this number.
Eigen::Matrix<double, 2, 4> CornersOf(const GreyImage& image, int first) {
  const double low = kMargin - 0.5;
  const double high = image.resolution.width - kMargin - 0.5;
  Eigen::Matrix<double, 2, 4> upright;
  upright << low, high, high, low, low, low, high, high;
  Eigen::Matrix<double, 2, 4> corners;
  for (int k = 0; k < 4; ++k) corners.col(k) = upright.col((k + first) % 4);
  return corners;
}

TEST(MarkerCode, IsReadInAllFourTurns) {
  const MarkerCodes& codes = CodesOf("DICT_5X5_100");
  for (const int id : {0, 42, 99}) {
    const GreyImage image = Draw("DICT_5X5_100", cv::aruco::DICT_5X5_100, id, 1);
    for (int turn = 0; turn < 4; ++turn) {
      const auto code = ReadMarker(image, CornersOf(image, turn), {5, 1, 0.0});
      ASSERT_TRUE(code);
      const auto match = codes.Identify(*code, 0);
      ASSERT_TRUE(match) << id << " " << turn;
      EXPECT_EQ(match->id, id);
      EXPECT_EQ(match->turn, turn);
      EXPECT_EQ(codes.CountErrors(*code, id, turn), 0);
    }
  }
}

// As the far corner of the small square that touches a tag of an AprilGrid: 0.3 of its side away.
TEST(MarkerCode, IsNotReadWhereOneCornerIsMistaken) {
  const GreyImage image = Draw("DICT_APRILTAG_36h11", cv::aruco::DICT_APRILTAG_36h11, 17, 2);
  const Eigen::Matrix<double, 2, 4> corners = CornersOf(image, 0);
  EXPECT_TRUE(ReadMarker(image, corners, {6, 2, 0.0}));
  const double gap = 0.3 * (corners(0, 1) - corners(0, 0));
  for (int mistaken = 0; mistaken < 4; ++mistaken) {
    Eigen::Matrix<double, 2, 4> wrong = corners;
    wrong.col(mistaken) +=
        gap * (corners.col(mistaken) - corners.col((mistaken + 2) % 4)).cwiseSign();
    EXPECT_FALSE(ReadMarker(image, wrong, {6, 2, 0.0})) << mistaken;
  }
}

TEST(MarkerCode, IsReadInsideAMargin) {
  const GreyImage image = Draw("DICT_APRILTAG_36h11", cv::aruco::DICT_APRILTAG_36h11, 17, 2);
  const double side = image.resolution.width;
  Eigen::Matrix<double, 2, 4> corners;
  corners << -0.5, side - 0.5, side - 0.5, -0.5, -0.5, -0.5, side - 0.5, side - 0.5;
  const auto code = ReadMarker(image, corners, {6, 2, kMargin / side});
  ASSERT_TRUE(code);
  const auto match = CodesOf("DICT_APRILTAG_36h11").Identify(*code, 0);
  ASSERT_TRUE(match);
  EXPECT_EQ(match->id, 17);
}

TEST(MarkerCode, MayHaveSomeErrorsButNoMore) {
  const MarkerCodes& codes = CodesOf("DICT_APRILTAG_36h11");
  const GreyImage image = Draw("DICT_APRILTAG_36h11", cv::aruco::DICT_APRILTAG_36h11, 300, 2);
  const MarkerCode code = ReadMarker(image, CornersOf(image, 0), {6, 2, 0.0}).value();
  const MarkerCode damaged = code ^ 0b1000'0010;
  EXPECT_EQ(codes.Identify(damaged, 2).value().id, 300);
  EXPECT_EQ(codes.Identify(damaged, 2).value().num_errors, 2);
  EXPECT_FALSE(codes.Identify(damaged, 1));
}

TEST(MarkerCode, TellsAMarkerFromItsMirrorImage) {
  const MarkerCodes& codes = CodesOf("DICT_6X6_250");
  const GreyImage image = Draw("DICT_6X6_250", cv::aruco::DICT_6X6_250, 5, 1);
  const Eigen::Matrix<double, 2, 4> anticlockwise = CornersOf(image, 0).rowwise().reverse();
  const MarkerCode code = ReadMarker(image, anticlockwise, {6, 1, 0.0}).value();
  EXPECT_FALSE(codes.Identify(code, 1));
  ASSERT_TRUE(codes.Identify(codes.Mirrored(code), 0));
  EXPECT_EQ(codes.Identify(codes.Mirrored(code), 0)->id, 5);
}

TEST(MarkerCode, NeedsABlackBorder) {
  const GreyImage image = Draw("DICT_5X5_100", cv::aruco::DICT_5X5_100, 3, 1);
  GreyImage inverted = image;
  for (uint8_t& pixel : inverted.pixels) pixel = static_cast<uint8_t>(255 - pixel);
  EXPECT_FALSE(ReadMarker(inverted, CornersOf(image, 0), {5, 1, 0.0}));
  const GreyImage flat{image.resolution, std::vector<uint8_t>(image.pixels.size(), 90)};
  EXPECT_FALSE(ReadMarker(flat, CornersOf(image, 0), {5, 1, 0.0}));
}

}  // namespace
}  // namespace calibrato
