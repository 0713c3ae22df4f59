#include "calibrato/rendering/draw_board.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/aruco.hpp>
#include <opencv2/aruco/charuco.hpp>
#include <opencv2/imgcodecs.hpp>
#include <regex>

#include "calibrato/base/input_error_testing.h"
#include "calibrato/rendering/board_pattern.h"

namespace calibrato {
namespace {

cv::Mat Decoded(const std::string& png) {
  return cv::imdecode(std::vector<uint8_t>(png.begin(), png.end()), cv::IMREAD_GRAYSCALE);
}

uint32_t BigEndian(const std::string& bytes, size_t at) {
  uint32_t number = 0;
  for (size_t k = at; k < at + 4; ++k) number = number << 8U | static_cast<uint8_t>(bytes[k]);
  return number;
}

TEST(DrawBoard, PngSaysItsResolutionAndPageSize) {
  const std::string png =
      DrawBoard(Checkerboard{5, 6, 0.02, 0.02}, DrawingFormat::kPng, {.dpi = 254.0});
  const size_t chunk = png.find("pHYs");
  ASSERT_NE(chunk, std::string::npos);
  EXPECT_EQ(BigEndian(png, chunk + 4), 10'000U);
  EXPECT_EQ(BigEndian(png, chunk + 8), 10'000U);
  EXPECT_EQ(png[chunk + 12], 1);  // a metre
  const cv::Mat image = Decoded(png);
  EXPECT_EQ(image.size(), cv::Size(2100, 2970));  // A4, upright
}

// The leftmost dark pixels of a row and how far it is to the rightmost, to parts of a pixel.
TEST(DrawBoard, PngIsOfTrueSize) {
  // 254 dpi are 10 px a millimetre. Nine squares of 20.03 mm across, eight of 21.07 mm down.
  const Checkerboard board{7, 8, 0.02107, 0.02003};
  const cv::Mat image = Decoded(DrawBoard(board, DrawingFormat::kPng, {.dpi = 254.0}));
  // The ink along a line through the first row of squares: five black ones of 200.3 px.
  const auto ink = [](const cv::Mat& line) {
    double sum = 0.0;
    for (int k = 0; k < static_cast<int>(line.total()); ++k) {
      sum += 1.0 - line.at<uint8_t>(k) / 255.0;
    }
    return sum;
  };
  int first_row = 0;
  while (ink(image.row(first_row).clone()) < 900.0) ++first_row;
  EXPECT_NEAR(ink(image.row(first_row + 100).clone()), 5 * 200.3, 0.1);
  int first_column = 0;
  const cv::Mat above_strip = image.rowRange(0, first_row + static_cast<int>(8.5 * 210.7));
  while (ink(above_strip.col(first_column).clone()) < 700.0) ++first_column;
  EXPECT_NEAR(ink(above_strip.col(first_column + 100).clone()), 4 * 210.7, 0.1);
}

TEST(DrawBoard, StandsUprightAndNotMirrored) {
  // Tag 0 at the lower left, tag 5 at the upper right.
  const cv::Mat image =
      Decoded(DrawBoard(AprilGrid{2, 3, 0.03, 0.3}, DrawingFormat::kPng, {.dpi = 150.0}));
  const auto parameters = cv::aruco::DetectorParameters::create();
  parameters->markerBorderBits = 2;
  std::vector<std::vector<cv::Point2f>> corners;
  std::vector<int> ids;
  cv::aruco::detectMarkers(image,
                           cv::aruco::getPredefinedDictionary(cv::aruco::DICT_APRILTAG_36h11),
                           corners, ids, parameters);
  ASSERT_EQ(ids.size(), 6U);
  const auto place = [&](int id) {
    return corners[std::find(ids.begin(), ids.end(), id) - ids.begin()][0];
  };
  EXPECT_LT(place(0).x + 150.0F, place(1).x);
  EXPECT_NEAR(place(0).y, place(1).y, 5.0);
  EXPECT_GT(place(0).y, place(3).y + 150.0F);
  EXPECT_NEAR(place(0).x, place(3).x, 5.0);
}

TEST(DrawBoard, CharucoIsWhatOpenCvDraws) {
  // OpenCV draws 7 x 5 squares of 40 px; ours, at 40 px a square, stands somewhere on the page.
  const cv::Ptr<cv::aruco::CharucoBoard> theirs = cv::aruco::CharucoBoard::create(
      7, 5, 0.01F, 0.0075F, cv::aruco::getPredefinedDictionary(cv::aruco::DICT_5X5_50));
  cv::Mat expected;
  theirs->draw({280, 200}, expected, 0, 1);
  const cv::Mat page = Decoded(
      DrawBoard(Charuco{5, 7, 0.01, 0.0075, "DICT_5X5_50"}, DrawingFormat::kPng, {.dpi = 101.6}));
  const int left = (page.cols - 280) / 2;
  int top = 0;
  while (page.at<uint8_t>(top, left + 20) > 128) ++top;
  int num_different = 0;
  for (int v = 0; v < 200; ++v) {
    for (int u = 0; u < 280; ++u) {
      num_different +=
          std::abs(page.at<uint8_t>(top + v, left + u) - expected.at<uint8_t>(v, u)) > 128;
    }
  }
  EXPECT_LT(num_different, 200 * 280 / 50);
}

TEST(DrawBoard, TakesTheSmallestPageThatFits) {
  const auto page = [](const Board& board) {
    const std::string svg = DrawBoard(board, DrawingFormat::kSvg);
    std::smatch match;
    EXPECT_TRUE(
        std::regex_search(svg, match, std::regex("width=\"([0-9.]+)pt\" height=\"([0-9.]+)pt\"")));
    return cv::Size(cvRound(std::stod(match[1]) / 72.0 * 25.4),
                    cvRound(std::stod(match[2]) / 72.0 * 25.4));
  };
  EXPECT_EQ(page(Checkerboard{5, 6, 0.02, 0.02}), cv::Size(210, 297));
  EXPECT_EQ(page(Checkerboard{5, 9, 0.024, 0.024}), cv::Size(297, 210));
  EXPECT_EQ(page(Checkerboard{6, 7, 0.06, 0.06}), cv::Size(594, 841));
  // 20 x 6 tags at 130 mm, the gaps around them, the white around these; the strip below.
  EXPECT_EQ(page(AprilGrid{6, 20, 0.1, 0.3}), cv::Size(2690, 898));
}

TEST(DrawBoard, GivesTheSameBytesAgain) {
  for (const DrawingFormat format :
       {DrawingFormat::kPdf, DrawingFormat::kSvg, DrawingFormat::kPng}) {
    const auto draw = [&] {
      return DrawBoard(CircleGrid{11, 4, 0.015, true}, format, {.dpi = 72.0});
    };
    EXPECT_EQ(draw(), draw());
  }
  const std::string pdf = DrawBoard(CircleGrid{11, 4, 0.015, true}, DrawingFormat::kPdf);
  EXPECT_EQ(pdf.find("CreationDate"), std::string::npos);
}

TEST(DrawBoard, RefusesWhatNoPageOrMemoryHolds) {
  const auto error = [](const Board& board, DrawingFormat format) {
    return InputErrorOf([&] { (void)DrawBoard(board, format, {.dpi = 2400.0}); });
  };
  const Board millimetres = Checkerboard{6, 7, 60.0, 60.0};
  EXPECT_NE(error(millimetres, DrawingFormat::kPdf).find("in metres"), std::string::npos);
  EXPECT_NE(error(AprilGrid{6, 6, 0.088, 0.3}, DrawingFormat::kPng).find("--dpi"),
            std::string::npos);
}

}  // namespace
}  // namespace calibrato
