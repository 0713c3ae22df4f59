// Photos that are not as one expects, given to the program itself: each gives a line that says what
// is wrong, or a count in the result.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <utility>
#include <vector>

#include "calibrato/base/value.h"
#include "calibrato/cli/program_for_test.h"

namespace calibrato {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr int kWidth = 640;
constexpr int kHeight = 480;
constexpr int kNumPoses = 8;
const char* const kCheckerboard =
    "target_type: 'checkerboard'\ntargetCols: 7\ntargetRows: 6\nrowSpacingMeters: 0.03\n"
    "colSpacingMeters: 0.03\n";
const char* const kAprilGrid =
    "target_type: 'aprilgrid'\ntagCols: 4\ntagRows: 3\ntagSize: 0.04\ntagSpacing: 0.3\n";
const char* const kAprilGridSwapped =
    "target_type: 'aprilgrid'\ntagCols: 3\ntagRows: 4\ntagSize: 0.04\ntagSpacing: 0.3\n";
const char* const kCharuco =
    "target_type: 'charuco'\ntargetCols: 8\ntargetRows: 6\nsquareSizeMeters: 0.03\n"
    "markerSizeMeters: 0.022\ndictionary: 'DICT_5X5_100'\n";
const char* const kCharucoOfAnotherFamily =
    "target_type: 'charuco'\ntargetCols: 8\ntargetRows: 6\nsquareSizeMeters: 0.03\n"
    "markerSizeMeters: 0.022\ndictionary: 'DICT_6X6_250'\n";

cv::Matx33d Rotation(const cv::Vec3d& turn) {
  const double angle = cv::norm(turn);
  if (angle == 0.0) return cv::Matx33d::eye();
  const cv::Vec3d a = turn / angle;
  const cv::Matx33d cross(0, -a[2], a[1], a[2], 0, -a[0], -a[1], a[0], 0);
  return cv::Matx33d::eye() + std::sin(angle) * cross + (1.0 - std::cos(angle)) * cross * cross;
}

// Photos that a pinhole camera took of a printed page, and the command that calibrates from them.
class OddPhotos : public testing::Test {
 protected:
  // The page as the program prints it, without its ruler.
  cv::Mat Page(const std::string& target) const {
    const std::string yaml = scratch_.Write("page.yaml", target);
    const std::string path = scratch_.Path("page.png");
    const Ended ended = RunProgram({"board", "--target", yaml, "--out", path, "--dpi", "150"});
    EXPECT_EQ(ended.exit_code, 0) << ended.err;
    return cv::imread(path, cv::IMREAD_GRAYSCALE);
  }

  // One of eight photos of it, each from another side.
  static cv::Mat Photo(const cv::Mat& page, int pose, double distance = 1.0, double shift = 0.0) {
    const double side = 2.0 * CV_PI * pose / kNumPoses;
    const double tilt = pose == 0 ? 0.0 : 0.55;
    const cv::Matx33d R = Rotation({tilt * std::cos(side), tilt * std::sin(side), 0.0});
    // Page pixels to a page of width 1 about its middle, 1.1 of these away.
    const double scale = 1.0 / page.cols;
    const cv::Matx33d place(scale, 0, -0.5, 0, scale, -0.5 * page.rows * scale, 0, 0, 1);
    const cv::Vec3d t(0.08 * std::cos(2.0 * side) + shift, 0.06 * std::sin(3.0 * side),
                      distance * (1.1 + 0.15 * std::sin(side)));
    const cv::Matx33d motion(R(0, 0), R(0, 1), t[0], R(1, 0), R(1, 1), t[1], R(2, 0), R(2, 1),
                             t[2]);
    const cv::Matx33d K(520, 0, 320, 0, 520, 240, 0, 0, 1);
    cv::Mat smooth;
    cv::GaussianBlur(page, smooth, {}, 0.35 * page.cols / 520.0);
    cv::Mat photo;
    cv::warpPerspective(smooth, photo, cv::Mat(K * motion * place), {kWidth, kHeight},
                        cv::INTER_LINEAR, cv::BORDER_CONSTANT, cv::Scalar(200));
    return photo;
  }

  // All of them, as a0.png to a7.png.
  void WritePhotos(const cv::Mat& page) const {
    for (int k = 0; k < kNumPoses; ++k) Write("a" + std::to_string(k) + ".png", Photo(page, k));
  }

  void Write(const std::string& name, const cv::Mat& image, const std::string& format = ".png",
             const std::vector<int>& parameters = {}) const {
    WriteBytes(name, Encoded(image, format, parameters));
  }
  void WriteBytes(const std::string& name, const std::string& bytes) const {
    (void)scratch_.Write("photos/" + name, bytes);
  }
  static std::string Encoded(const cv::Mat& image, const std::string& format,
                             const std::vector<int>& parameters = {}) {
    std::vector<uint8_t> bytes;
    cv::imencode(format, image, bytes, parameters);
    return {bytes.begin(), bytes.end()};
  }

  Ended Calibrate(const std::string& target, const std::string& photos = "photos") const {
    return RunProgram({"calibrate", "camera", scratch_.Path(photos), "--target",
                       scratch_.Write("board.yaml", target), "--model", "pinhole-none", "--json",
                       "--out", scratch_.Path("out")});
  }
  // The first camera of a result that was reached, and the findings.
  std::pair<Value, std::string> Result(const std::string& target) const {
    const Ended ended = Calibrate(target);
    EXPECT_TRUE(ended.exit_code == 0 || ended.exit_code == 1) << ended.err;
    const Value result = ParseJson(ended.out, "stdout");
    return {result.At("cameras").elements()[0], ToJson(result.At("findings"))};
  }
  static int64_t Rejected(const Value& camera, const std::string& what) {
    return camera.At("rejected").At("detection").At(what).AsInt();
  }
  // One line on stderr, and nothing written.
  std::string Refusal(const std::string& target, const std::string& photos = "photos") const {
    const Ended ended = Calibrate(target, photos);
    EXPECT_EQ(ended.exit_code, 2) << ended.out;
    EXPECT_EQ(ended.out, "");
    EXPECT_EQ(std::count(ended.err.begin(), ended.err.end(), '\n'), 1) << ended.err;
    EXPECT_FALSE(std::filesystem::exists(scratch_.Path("out")));
    return ended.err;
  }

  ScratchFolder scratch_;
};

cv::Mat Mirrored(const cv::Mat& image) {
  cv::Mat mirrored;
  cv::flip(image, mirrored, 1);
  return mirrored;
}

cv::Mat Coloured(const cv::Mat& image) {
  cv::Mat coloured;
  cv::cvtColor(image, coloured, cv::COLOR_GRAY2BGR);
  cv::multiply(coloured, cv::Scalar(0.9, 0.8, 1.0), coloured);
  return coloured;
}

TEST_F(OddPhotos, OfSixteenBitsInColourOrWithAWrongSuffixAreAsGoodAsOthers) {
  const cv::Mat page = Page(kCheckerboard);
  std::vector<cv::Mat> photos;
  for (int k = 0; k < kNumPoses; ++k) photos.push_back(Photo(page, k));
  cv::Mat deep;
  photos[0].convertTo(deep, CV_16U, 257.0);
  Write("p0.png", deep);
  photos[1].convertTo(deep, CV_16U, 16.0);  // Twelve bits in sixteen.
  Write("p1.tiff", deep, ".tiff");
  photos[2].convertTo(deep, CV_16U, 257.0);
  Write("p2.pgm", deep, ".pgm");
  Write("p3.png", Coloured(photos[3]));
  Write("p4.jpg", Coloured(photos[4]), ".jpg");
  Write("p5.jpg", photos[5], ".png");  // These two are not what their names say.
  Write("p6.png", photos[6], ".jpg");
  Write("p7.bmp", photos[7], ".bmp");
  const auto [camera, text] = Result(kCheckerboard);
  EXPECT_EQ(camera.At("num_views").AsInt(), kNumPoses) << text;
  EXPECT_EQ(camera.At("num_corners").AsInt() + camera.At("rejected").At("num_corners").AsInt(),
            42 * kNumPoses);
  EXPECT_NEAR(camera.At("intrinsics").AsDoubles(4)[0], 520.0, 2.0);
}

TEST_F(OddPhotos, OfInksAreRefusedByName) {
  const cv::Mat page = Page(kCheckerboard);
  WritePhotos(page);
  std::string jpeg = Encoded(Coloured(Photo(page, 0)), ".jpg");
  // Four components in the frame's header, as cyan, magenta, yellow and black have.
  const size_t frame = jpeg.find("\xff\xc0");
  ASSERT_NE(frame, std::string::npos);
  jpeg[frame + 9] = '\x4';
  WriteBytes("print.jpg", jpeg);
  EXPECT_THAT(Refusal(kCheckerboard), AllOf(HasSubstr("print.jpg"), HasSubstr("4 colour"),
                                            HasSubstr("convert it to grey")));
}

TEST_F(OddPhotos, TwentyThousandPixelsWideAreSearchedLikeOthers) {
  WritePhotos(Page(kCheckerboard));
  Write("panorama.png", cv::Mat(300, 20'000, CV_8UC1, cv::Scalar(128)));
  const auto [camera, text] = Result(kCheckerboard);
  EXPECT_EQ(camera.At("num_views").AsInt(), kNumPoses) << text;
  EXPECT_EQ(camera.At("rejected").At("images_without_board").AsInt(), 1);
}

TEST_F(OddPhotos, ThatMoveAreRefusedUnlessTheirFirstPictureIsClear) {
  const cv::Mat page = Page(kCheckerboard);
  WritePhotos(page);
  // An animated PNG: its parts acTL and fcTL are of no concern to who shows one picture.
  std::string png = Encoded(Photo(page, 3), ".png");
  const size_t data = png.find("IDAT") - 4;
  const auto chunk = [](const std::string& type, const std::string& content,
                        const std::string& checksum) {
    return std::string("\0\0\0", 3) + static_cast<char>(content.size()) + type + content + checksum;
  };
  // Two pictures, played for ever.
  png.insert(data, chunk("acTL", std::string("\0\0\0\2\0\0\0\0", 8), "\xf3\x8d\x93\x70"));
  WriteBytes("a3.png", png);
  const auto [camera, text] = Result(kCheckerboard);
  EXPECT_EQ(camera.At("num_views").AsInt(), kNumPoses) << text;
  std::filesystem::remove_all(scratch_.Path("out"));

  WriteBytes("film.jpg", "GIF89a" + std::string(100, '\0'));
  EXPECT_THAT(Refusal(kCheckerboard), AllOf(HasSubstr("film.jpg"), HasSubstr("give PNG")));
  WriteBytes("film.jpg", std::string("RIFF\x64\0\0\0WEBPVP8X", 16) + std::string(100, '\0'));
  EXPECT_THAT(Refusal(kCheckerboard), AllOf(HasSubstr("film.jpg"), HasSubstr("give PNG")));
}

TEST_F(OddPhotos, CutShortOrEmptyAreRefusedByName) {
  const cv::Mat page = Page(kCheckerboard);
  WritePhotos(page);
  const std::string jpeg = Encoded(Photo(page, 0), ".jpg");
  WriteBytes("z.jpg", jpeg.substr(0, jpeg.size() / 2));
  EXPECT_THAT(Refusal(kCheckerboard), AllOf(HasSubstr("z.jpg"), HasSubstr("truncated")));
  WriteBytes("z.jpg", "");
  EXPECT_THAT(Refusal(kCheckerboard), AllOf(HasSubstr("z.jpg"), HasSubstr("empty")));
}

TEST_F(OddPhotos, OfAMirroredBoardAreCounted) {
  const cv::Mat page = Page(kAprilGrid);
  WritePhotos(page);
  Write("mirror.png", Mirrored(Photo(page, 1)));
  const auto [camera, text] = Result(kAprilGrid);
  EXPECT_EQ(camera.At("num_views").AsInt(), kNumPoses) << text;
  EXPECT_EQ(Rejected(camera, "images_with_mirrored_board"), 1);
  EXPECT_THAT(text, HasSubstr("1 images show the board mirrored"));
}

TEST_F(OddPhotos, OfAMirroredBoardAloneAreRefused) {
  WritePhotos(Mirrored(Page(kAprilGrid)));
  EXPECT_THAT(Refusal(kAprilGrid),
              AllOf(HasSubstr("a mirrored one was seen in 8"), HasSubstr("turn off mirroring")));
}

TEST_F(OddPhotos, OfTwoBoardsAreCounted) {
  for (const char* target : {kCheckerboard, kAprilGrid}) {
    const cv::Mat page = Page(target);
    WritePhotos(page);
    cv::Mat two = Photo(page, 0, 2.2, -0.65);
    const cv::Rect right(kWidth / 2, 0, kWidth / 2, kHeight);
    Photo(page, 0, 2.2, 0.65)(right).copyTo(two(right));
    Write("two.png", two);
    const auto [camera, text] = Result(target);
    EXPECT_EQ(camera.At("num_views").AsInt(), kNumPoses) << text;
    EXPECT_EQ(Rejected(camera, "images_with_two_boards"), 1) << text;
    EXPECT_THAT(text, HasSubstr("1 images show two such boards"));
  }
}

TEST_F(OddPhotos, OfABoardWithRowsAndColumnsSwapped) {
  WritePhotos(Page(kAprilGrid));
  EXPECT_THAT(Refusal(kAprilGridSwapped), HasSubstr("tagRows: 3 and tagCols: 4"));
  // A checkerboard is the same board, whichever way it is counted; it is told by its colours.
  WritePhotos(Page(kCheckerboard));
  const auto [camera, text] = Result(
      "target_type: 'checkerboard'\ntargetCols: 6\ntargetRows: 7\nrowSpacingMeters: 0.03\n"
      "colSpacingMeters: 0.03\n");
  EXPECT_EQ(camera.At("num_views").AsInt(), kNumPoses) << text;
}

TEST_F(OddPhotos, OfTagsOfAnotherFamily) {
  WritePhotos(Page(kCharucoOfAnotherFamily));
  EXPECT_THAT(Refusal(kCharuco), AllOf(HasSubstr("another family"), HasSubstr("--target")));
  WritePhotos(Page(kCharuco));
  Write("other.png", Photo(Page(kCharucoOfAnotherFamily), 0));
  const auto [camera, text] = Result(kCharuco);
  EXPECT_EQ(camera.At("num_views").AsInt(), kNumPoses) << text;
  EXPECT_GT(Rejected(camera, "tags_of_another_family"), 5);
  EXPECT_THAT(text, HasSubstr("tags are of another family"));
}

TEST_F(OddPhotos, OfOneStampAreRefused) {
  const cv::Mat page = Page(kCheckerboard);
  for (int k = 0; k < 3; ++k) {
    Write("cam0/data/" + std::to_string(1'403'636'579'000'000'000 + k) + ".png", Photo(page, k));
  }
  Write("cam0/data/1403636579000000001.jpg", Photo(page, 3), ".jpg");
  EXPECT_THAT(Refusal(kCheckerboard),
              AllOf(HasSubstr("two images of one stamp"), HasSubstr("1403636579000000001")));
}

TEST_F(OddPhotos, OfACameraThatSawNoBoardDoNotSpoilTheOthers) {
  WritePhotos(Page(kCheckerboard));
  for (int k = 0; k < kNumPoses; ++k) {
    Write("b" + std::to_string(k) + ".png", cv::Mat(kHeight, kWidth, CV_8UC1, cv::Scalar(90)));
  }
  const Ended ended =
      RunProgram({"calibrate", "camera", scratch_.Path("photos"), "--images", "a*.png", "--images",
                  "b*.png", "--target", scratch_.Write("board.yaml", kCheckerboard), "--model",
                  "pinhole-none", "--json", "--out", scratch_.Path("out")});
  EXPECT_EQ(ended.exit_code, 1) << ended.err;
  const Value result = ParseJson(ended.out, "stdout");
  EXPECT_EQ(result.At("cameras").elements()[0].At("num_views").AsInt(), kNumPoses);
  EXPECT_EQ(result.At("verdict").AsString(), "fail");
  EXPECT_THAT(ended.out, HasSubstr("cam1: no board found in any image: searched 8 images"));
}

}  // namespace
}  // namespace calibrato
