// Real photos of boards, through strong fisheye lenses.

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "calibrato/detection/detect.h"
#include "calibrato/recording/photo.h"
#include "calibrato/recording/recording.h"

namespace calibrato {
namespace {

class BoardPhotos : public testing::Test {
 protected:
  void SetUp() override {
    const char* folder = std::getenv("CALIBRATO_DATA");
    if (folder == nullptr) GTEST_SKIP() << "needs the photos in the folder CALIBRATO_DATA";
    folder_ = folder;
  }
  std::string folder_;
};

TEST_F(BoardPhotos, ShowAllTagsOfAnAprilGridButThoseSeenFromTheSide) {
  // OpenCV's detector of ArUco markers finds 26, 29, 35 and 17 of these 36.
  const AprilGrid board{6, 6, 0.088, 0.3};
  struct Photo {
    const char* name;
    int min_corners;
  };
  for (const auto& [name, min_corners] : {Photo{"EuRoC.png", 144}, Photo{"TUM_VI.png", 144},
                                          Photo{"r45.png", 144}, Photo{"right.png", 4 * 33}}) {
    const std::optional<BoardView> view =
        DetectBoard(ReadPhoto(folder_ + "/aprilgrid_photos/" + name), board);
    ASSERT_TRUE(view) << name;
    EXPECT_GE(view->num_corners(), min_corners) << name;
  }
}

TEST_F(BoardPhotos, ShowACheckerboardInAFisheyeToItsRim) {
  const Recording recording = OpenRecording(folder_ + "/camodocal_fisheye", {});
  const auto& images = std::get<CameraImages>(recording.cameras.at(0).data);
  ImageSource source;
  for (const RecordedImage& image : images.list) source.names.push_back(image.name);
  source.load = [&](size_t k) { return GreyOf(images.reader->Read(k)); };
  const Detections detections = DetectBoards(source, Checkerboard{6, 9, 0.12, 0.12});
  EXPECT_EQ(detections.num_images, 32);
  EXPECT_GE(detections.views.size(), 31U);
}

}  // namespace
}  // namespace calibrato
