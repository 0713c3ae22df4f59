#include "calibrato/recording/recording_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "calibrato/base/input_error.h"
#include "calibrato/recording/test_folder.h"

namespace calibrato {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::string kCorners =
    "#timestamp [ns],tag_id,tag_corner,u [px],v [px],x [m],y [m],z [m]\n"
    "10,0,0,1,2,0,0,0\n";

class RecordingFolderTest : public testing::Test {
 protected:
  Recording Open(const RecordingOptions& options = {}) const {
    return OpenRecordingFolder(folder_.path(), options);
  }
  std::string ErrorOf(const RecordingOptions& options = {}) const {
    try {
      static_cast<void>(Open(options));
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }
  void Touch(const std::vector<std::string>& names) const {
    for (const std::string& name : names) folder_.Write(name, "content of " + name);
  }
  static RecordingOptions Globs(const std::vector<std::string>& globs) {
    RecordingOptions options;
    options.image_globs = globs;
    return options;
  }

  TestFolder folder_;
};

const std::vector<RecordedImage>& Images(const CameraRecording& camera) {
  return std::get<CameraImages>(camera.data).list;
}

std::string ContentOf(const CameraRecording& camera, size_t k) {
  const StoredImage image = std::get<CameraImages>(camera.data).reader->Read(k);
  return std::get<EncodedFile>(image.content).bytes;
}

std::vector<std::string> Names(const CameraRecording& camera) {
  std::vector<std::string> names;
  for (const RecordedImage& file : Images(camera)) names.push_back(file.name);
  return names;
}

TEST_F(RecordingFolderTest, OpensListsOfCornersPlainAndGzip) {
  folder_.Write("cam0_corners.csv", kCorners);
  folder_.WriteGzip("cam1_corners.csv.gz", kCorners);
  Touch({"photo.png"});
  const Recording recording = Open();
  EXPECT_EQ(recording.path, folder_.path());
  ASSERT_EQ(recording.cameras.size(), 2u);
  EXPECT_EQ(recording.cameras[1].name, "cam1");
  for (const CameraRecording& camera : recording.cameras) {
    const auto& views = std::get<std::vector<BoardView>>(camera.data);
    ASSERT_EQ(views.size(), 1u);
    EXPECT_EQ(views[0].pixels.col(0), Eigen::Vector2d(1.0, 2.0));
    EXPECT_EQ(camera.resolution, std::nullopt);
  }
}

TEST_F(RecordingFolderTest, FindsTheResolutionWhereItIsNearest) {
  folder_.Write("cam0_corners.csv", kCorners);
  folder_.Write("cam1_corners.csv", kCorners);
  // An unknown lens is no reason not to read the size.
  folder_.Write("camchain.yaml",
                "cam0: {camera_model: pinhole, resolution: [1, 2]}\n"
                "cam1: {camera_model: of-tomorrow, resolution: [3, 4]}\n");
  EXPECT_EQ(Open().cameras[0].resolution, (Resolution{1, 2}));
  EXPECT_EQ(Open().cameras[1].resolution, (Resolution{3, 4}));
  folder_.Write("sensor.yaml", "sensor_type: camera\nresolution: [5, 6]\n");
  EXPECT_EQ(Open().cameras[1].resolution, (Resolution{5, 6}));
  folder_.Write("cam1/sensor.yaml", "resolution: [7, 8]\n");
  EXPECT_EQ(Open().cameras[0].resolution, (Resolution{5, 6}));
  EXPECT_EQ(Open().cameras[1].resolution, (Resolution{7, 8}));
  folder_.Write("cam1_sensor.yaml", "resolution: [9, 10]\n");
  EXPECT_EQ(Open().cameras[1].resolution, (Resolution{9, 10}));
  RecordingOptions options;
  options.resolution = Resolution{11, 12};
  EXPECT_EQ(Open(options).cameras[1].resolution, (Resolution{11, 12}));
}

TEST_F(RecordingFolderTest, RefusesAMalformedResolutionByFileAndLine) {
  folder_.Write("cam0_corners.csv", kCorners);
  folder_.Write("sensor.yaml", "sensor_type: camera\nresolution: [640]\n");
  EXPECT_THAT(ErrorOf(), AllOf(HasSubstr("sensor.yaml line 2"), HasSubstr("[width, height]")));
  folder_.Write("sensor.yaml", "resolution: [640, 0]\n");
  EXPECT_THAT(ErrorOf(), HasSubstr("resolution"));
}

TEST_F(RecordingFolderTest, TakesThePointsOfTheBoard) {
  folder_.Write("cam0_corners.csv", "#timestamp [ns],tag_id,u [px],v [px]\n10,1,3,4\n");
  RecordingOptions options;
  options.board_points_g = Eigen::Matrix3Xd::Constant(3, 2, 0.5);
  const Recording recording = Open(options);
  EXPECT_EQ(std::get<std::vector<BoardView>>(recording.cameras[0].data)[0].points_g.col(0),
            Eigen::Vector3d(0.5, 0.5, 0.5));
  EXPECT_THAT(ErrorOf(), HasSubstr("--target"));
}

TEST_F(RecordingFolderTest, OpensFoldersOfStampedImagesInOrderOfTime) {
  Touch({"cam0/data/9999999999.png", "cam0/data/10000000000.png", "cam0/data/data.csv",
         "cam0/sensor.yaml", "cam1/10000000001.PNG"});
  const Recording recording = Open();
  ASSERT_EQ(recording.cameras.size(), 2u);
  EXPECT_THAT(Names(recording.cameras[0]), ElementsAre("9999999999.png", "10000000000.png"));
  EXPECT_EQ(Images(recording.cameras[0])[0].stamp, Time::FromNanoseconds(9999999999));
  EXPECT_EQ(ContentOf(recording.cameras[0], 0), "content of cam0/data/9999999999.png");
  EXPECT_EQ(Images(recording.cameras[1])[0].stamp, Time::FromNanoseconds(10000000001));
}

TEST_F(RecordingFolderTest, LearnsFromTheSensorWhetherImagesAreMosaics) {
  Touch({"cam0/data/10000000000.png", "cam1/data/10000000000.png", "cam2/10000000000.png"});
  folder_.Write("cam0/sensor.yaml", "sensor_type: camera\nencoding: bayer_rggb8\n");
  folder_.Write("cam1/sensor.yaml", "%YAML:1.0\n{{\n");
  const Recording recording = Open();
  for (const auto& [camera, expected] :
       {std::pair(0U, "bayer_rggb8"), std::pair(1U, ""), std::pair(2U, "")}) {
    const auto& images = std::get<CameraImages>(recording.cameras[camera].data);
    EXPECT_EQ(std::get<EncodedFile>(images.reader->Read(0).content).encoding, expected);
  }
}

TEST_F(RecordingFolderTest, EntersEurocsFolderWithItsImu) {
  Touch({"mav0/cam0/data/10000000000.png", "mav0/cam0/data/10050000000.png"});
  folder_.Write("mav0/cam0/data.csv", "#timestamp [ns],filename\n");
  folder_.Write("mav0/imu0/data.csv",
                "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],"
                "a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]\n"
                "10000000000,1,2,3,4,5,6\n");
  Recording recording = Open();
  ASSERT_EQ(recording.cameras.size(), 1u);
  EXPECT_THAT(Names(recording.cameras[0]), ElementsAre("10000000000.png", "10050000000.png"));
  ASSERT_EQ(recording.imus.size(), 1u);
  EXPECT_EQ(recording.imus[0].stream.accel[0].value, Eigen::Vector3d(4.0, 5.0, 6.0));
  RecordingOptions options;
  options.with_imus = false;
  EXPECT_TRUE(Open(options).imus.empty());
}

TEST_F(RecordingFolderTest, TakesStampsFromEurocsListWhereNamesHaveNone) {
  Touch({"cam0/data/a.png", "cam0/data/b.png", "cam0/data/c.png"});
  folder_.Write("cam0/data.csv", "#timestamp [ns],filename\n30,a.png\n20, b.png\r\n");
  const Recording recording = Open();
  EXPECT_THAT(Names(recording.cameras[0]), ElementsAre("b.png", "a.png"));
  EXPECT_EQ(Images(recording.cameras[0])[0].stamp, Time::FromNanoseconds(20));
  EXPECT_TRUE(recording.imus.empty());
  folder_.Write("cam0/data.csv", "timestamp,filename\n20,b.png\n20,a.png\n");
  EXPECT_THAT(ErrorOf(), HasSubstr("two images of one stamp"));
  folder_.Write("cam0/data.csv", "30,a.png\n31,d.png\n");
  EXPECT_THAT(ErrorOf(), HasSubstr("listed image is missing"));
  folder_.Write("cam0/data.csv", "30,a.png\n31.5,b.png\n");
  EXPECT_THAT(ErrorOf(), HasSubstr("data.csv line 2"));
}

TEST_F(RecordingFolderTest, OpensPhotosOfAnyFormatInOrderOfTheirNames) {
  Touch({"b.JPG", "a.jpeg", "c.Tif", "d.tiff", "e.bmp", "f.pgm", "g.png", "notes.txt", ".h.png",
         "board.yaml"});
  const Recording recording = Open();
  ASSERT_EQ(recording.cameras.size(), 1u);
  EXPECT_EQ(recording.cameras[0].name, "cam0");
  EXPECT_THAT(Names(recording.cameras[0]),
              ElementsAre("a.jpeg", "b.JPG", "c.Tif", "d.tiff", "e.bmp", "f.pgm", "g.png"));
  EXPECT_EQ(Images(recording.cameras[0])[0].stamp, Time());
}

TEST_F(RecordingFolderTest, TakesStampsOfPhotosOnlyIfAllHaveThem) {
  Touch({"1403636579763555584.png", "1403636579813555456.png"});
  EXPECT_EQ(Images(Open().cameras[0])[1].stamp.nanoseconds(), 1403636579813555456);
  Touch({"preview.png"});
  const Recording recording = Open();
  for (const RecordedImage& file : Images(recording.cameras[0])) EXPECT_EQ(file.stamp, Time());
}

TEST_F(RecordingFolderTest, MakesOneCameraOfEachGlob) {
  Touch({"left01.jpg", "left02.jpg", "left.yml", "right01.jpg", "right02.jpg", "far/x1.png",
         "far/x2.png"});
  const Recording recording = Open(Globs({"left*", "right[0-9]*.jpg", "far/x*.png"}));
  ASSERT_EQ(recording.cameras.size(), 3u);
  EXPECT_EQ(recording.cameras[0].name, "left*");
  EXPECT_THAT(Names(recording.cameras[0]), ElementsAre("left01.jpg", "left02.jpg"));
  EXPECT_THAT(Names(recording.cameras[1]), ElementsAre("right01.jpg", "right02.jpg"));
  EXPECT_EQ(ContentOf(recording.cameras[2], 1), "content of far/x2.png");
}

TEST_F(RecordingFolderTest, RefusesAGlobThatMatchesNoImage) {
  Touch({"left01.jpg", "left02.jpg", "left.yml"});
  EXPECT_THAT(ErrorOf(Globs({"left*.jpg", "right*.jpg"})),
              AllOf(HasSubstr("'right*.jpg'"), HasSubstr(folder_.path()), HasSubstr("2 images"),
                    HasSubstr("left01.jpg")));
  EXPECT_THAT(ErrorOf(Globs({"left.yml"})), HasSubstr("'left.yml'"));
  Touch({"cam0/1403636579763555584.png"});
  std::filesystem::remove(folder_.path() + "/left01.jpg");
  std::filesystem::remove(folder_.path() + "/left02.jpg");
  EXPECT_THAT(ErrorOf(Globs({"*.jpg"})), AllOf(HasSubstr("0 images"), HasSubstr("leave --images")));
}

TEST_F(RecordingFolderTest, RefusesGlobsForListsOfCorners) {
  folder_.Write("cam0_corners.csv", kCorners);
  Touch({"left01.jpg"});
  EXPECT_THAT(ErrorOf(Globs({"left*.jpg"})),
              AllOf(HasSubstr("'left*.jpg'"), HasSubstr(folder_.path()), HasSubstr("1 images")));
}

TEST_F(RecordingFolderTest, RefusesPhotosThatCannotBePaired) {
  Touch({"left01.jpg", "left02.jpg", "right01.jpg"});
  EXPECT_THAT(ErrorOf(Globs({"left*.jpg", "right*.jpg"})),
              AllOf(HasSubstr("left*.jpg has 2"), HasSubstr("right*.jpg has 1")));
  Touch({"1403636579763555584.png"});
  EXPECT_THAT(ErrorOf(Globs({"right*.jpg", "14*.png"})), HasSubstr("stamps"));
}

TEST_F(RecordingFolderTest, PairsStampedCamerasOfUnequalLength) {
  Touch({"cam0/1403636579763555584.png", "cam0/1403636579813555456.png",
         "cam1/1403636579763555584.png"});
  EXPECT_EQ(Open().cameras.size(), 2u);
}

TEST_F(RecordingFolderTest, RefusesAStrayImageAmongStampedOnes) {
  Touch({"cam0/1403636579763555584.png", "cam0/preview.png"});
  EXPECT_THAT(ErrorOf(), HasSubstr("preview.png"));
}

TEST_F(RecordingFolderTest, RefusesTwoImagesOfOneStamp) {
  Touch({"cam0/1403636579763555584.png", "cam0/1403636579763555584.jpg"});
  EXPECT_THAT(ErrorOf(), HasSubstr("two images of one stamp"));
}

TEST_F(RecordingFolderTest, RefusesAGapAmongTheCameras) {
  folder_.Write("cam0_corners.csv", kCorners);
  folder_.Write("cam2_corners.csv", kCorners);
  EXPECT_THAT(ErrorOf(), AllOf(HasSubstr("cam2_corners.csv"), HasSubstr("no cam1")));
  folder_.Write("cam0_corners.csv.gz", kCorners);
  EXPECT_THAT(ErrorOf(), HasSubstr("two corner lists"));
}

TEST_F(RecordingFolderTest, RefusesACameraWithoutImages) {
  Touch({"cam0/1403636579763555584.png", "cam1/data/notes.txt"});
  EXPECT_THAT(ErrorOf(), AllOf(HasSubstr("cam1/data"), HasSubstr("png")));
}

TEST_F(RecordingFolderTest, SaysWhatWasLookedForWhereThereIsNoRecording) {
  EXPECT_THAT(ErrorOf(), AllOf(HasSubstr(folder_.path()), HasSubstr("cam0_corners.csv"),
                               HasSubstr("cam0/data"), HasSubstr("png")));
  EXPECT_THROW(static_cast<void>(OpenRecordingFolder(folder_.path() + "/absent", {})), InputError);
  EXPECT_THROW(static_cast<void>(OpenRecordingFolder(folder_.Write("file", ""), {})), InputError);
}

}  // namespace
}  // namespace calibrato
