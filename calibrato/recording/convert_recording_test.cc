#include "calibrato/recording/convert_recording.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "calibrato/base/files.h"
#include "calibrato/base/input_error_testing.h"
#include "calibrato/recording/bag_for_test.h"
#include "calibrato/recording/test_folder.h"

namespace calibrato {
namespace {

using testing::AllOf;
using testing::HasSubstr;

namespace fs = std::filesystem;

constexpr int64_t kStart = 1'600'000'000'123'456'789;

// A bag by hand: a camera of every raw kind that has a PNG, one of JPEGs, an IMU with awkward
// numbers, samples out of order.
std::string SourceBag() {
  const std::string jpeg = "\xff\xd8\xff\xe0 not decoded here";
  std::string records = BagConnection(0, "/cam0/image_raw", "sensor_msgs/Image") +
                        BagConnection(1, "/cam1/image_raw", "sensor_msgs/Image") +
                        BagConnection(2, "/cam2/image_raw", "sensor_msgs/CompressedImage") +
                        BagConnection(3, "/imu0", "sensor_msgs/Imu");
  const auto add = [&](unsigned topic, int64_t stamp, const std::string& message) {
    records += BagMessage(topic, stamp, message);
  };
  add(0, kStart, Ros1Image(kStart, 3, 3, "bayer_gbrg8", 3, "abcdefghi"));
  add(0, kStart + 1, Ros1Image(kStart + 1, 3, 3, "bayer_gbrg8", 3, "ABCDEFGHI"));
  add(1, kStart + 1, Ros1Image(kStart + 1, 1, 2, "rgb8", 8, "rgbRGB--"));
  add(1, kStart + 3, Ros1Image(kStart + 3, 1, 2, "mono16", 4, "ABCD"));
  add(2, kStart + 2, Ros1CompressedImage(kStart + 2, "jpeg", jpeg));
  add(3, kStart + 5, Ros1Imu(kStart + 5, {0.1, -2e-9, 3e300, 1.0 / 3.0, -0.0, 5e-324}));
  add(3, kStart + 4, Ros1Imu(kStart + 4, {1, 2, 3, 4, 5, 6}));
  return Bag({BagChunk("none", records, records.size())}, 1, BagConnection(0, "/a", "b"));
}

// All that calibration would read of a recording, as text that can be compared.
std::vector<std::string> Measurements(const Recording& recording, bool with_pixels_as_grey) {
  std::vector<std::string> lines;
  for (const CameraRecording& camera : recording.cameras) {
    const auto& images = std::get<CameraImages>(camera.data);
    for (size_t k = 0; k < images.list.size(); ++k) {
      std::string line = std::to_string(images.list[k].stamp.nanoseconds()) + " ";
      const StoredImage image = images.reader->Read(k);
      if (const auto* raw = std::get_if<RawPixels>(&image.content); raw && !with_pixels_as_grey) {
        line += raw->encoding + " " + raw->bytes;
      } else if (const auto* file = std::get_if<EncodedFile>(&image.content);
                 file && !file->bytes.starts_with("\x89PNG")) {
        line += file->bytes;
      } else {
        const GreyImage grey = GreyOf(image);
        line.append(grey.pixels.begin(), grey.pixels.end());
      }
      lines.push_back(line);
    }
  }
  for (const ImuRecording& imu : recording.imus) {
    for (const auto& samples : {imu.stream.gyro, imu.stream.accel}) {
      for (const VectorSample& sample : samples) {
        std::string line = std::to_string(sample.stamp.nanoseconds());
        for (const double x : sample.value) line += F64(x);
        lines.push_back(line);
      }
    }
  }
  return lines;
}

std::string Path(const TestFolder& folder, const std::string& name) {
  return folder.path() + "/" + name;
}

class ConvertTest : public testing::Test {
 protected:
  ConvertTest() : source_(OpenRecording(folder_.Write("source.bag", SourceBag()), {})) {}
  std::string ErrorOf(const Recording& recording, const std::string& name, bool replace = false) {
    return InputErrorOf([&] {
      ConvertRecording(recording, RecordingForm::kRosbag1, Path(folder_, name), replace);
    });
  }
  TestFolder folder_;
  Recording source_;
};

TEST_F(ConvertTest, KeepsEveryBitInBags) {
  const std::vector<std::string> expected = Measurements(source_, false);
  ASSERT_EQ(expected.size(), 9U);
  for (const RecordingForm form : {RecordingForm::kRosbag1, RecordingForm::kMcap}) {
    const std::string path = Path(folder_, "copy");
    const ConversionResult result = ConvertRecording(source_, form, path, true);
    EXPECT_EQ(result.num_images, 5);
    EXPECT_EQ(result.num_imu_samples, 2);
    const Recording copy = OpenRecording(path, {});
    EXPECT_EQ(copy.cameras[2].name, "/cam2/image_raw");
    EXPECT_EQ(Measurements(copy, false), expected);
  }
}

TEST_F(ConvertTest, GoesThroughAllFormsAndBackToTheSameBytes) {
  const std::vector<std::string> expected = Measurements(source_, true);
  const std::string folder = Path(folder_, "folder");
  ConvertRecording(source_, RecordingForm::kFolder, folder, false);
  const Recording first = OpenRecording(folder, {});
  EXPECT_EQ(Measurements(first, true), expected);
  ConvertRecording(first, RecordingForm::kMcap, Path(folder_, "a"), false);
  const Recording second = OpenRecording(Path(folder_, "a"), {});
  EXPECT_EQ(Measurements(second, true), expected);
  ConvertRecording(second, RecordingForm::kRosbag1, Path(folder_, "b"), false);
  const Recording third = OpenRecording(Path(folder_, "b"), {});
  EXPECT_EQ(third.cameras[0].name, "/cam0/image_raw/compressed");
  EXPECT_EQ(Measurements(third, true), expected);
  const std::string back = Path(folder_, "back");
  ConvertRecording(third, RecordingForm::kFolder, back, false);
  size_t num_files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    ++num_files;
    const fs::path other = back / entry.path().lexically_relative(folder);
    EXPECT_EQ(ReadFile(entry.path().string()), ReadFile(other.string())) << other;
  }
  EXPECT_EQ(num_files, 5U + 1U + 1U);  // images, cam0/sensor.yaml, imu0.csv
}

TEST_F(ConvertTest, KeepsSensorsWithStampsOfTheirOwn) {
  TestFolder other;
  other.Write("cam0/1600000000000000000.png", "\x89PNG\r\n\x1a\n");
  other.Write("gyro0.csv", "5,1,2,3\n7,1,2,3\n");
  other.Write("accel0.csv", "6,4,5,6\n");
  const Recording recording = OpenRecording(other.path(), {});
  for (const RecordingForm form :
       {RecordingForm::kRosbag1, RecordingForm::kMcap, RecordingForm::kFolder}) {
    const std::string path = Path(folder_, "copy" + std::to_string(static_cast<int>(form)));
    ConvertRecording(recording, form, path, true);
    const Recording copy = OpenRecording(path, {});
    ASSERT_EQ(copy.imus.size(), 1U);
    EXPECT_EQ(copy.imus[0].stream.gyro.size(), 2U);
    ASSERT_EQ(copy.imus[0].stream.accel.size(), 1U);
    EXPECT_EQ(copy.imus[0].stream.accel[0].stamp.nanoseconds(), 6);
    EXPECT_EQ(copy.imus[0].stream.accel[0].value, Eigen::Vector3d(4, 5, 6));
  }
}

TEST_F(ConvertTest, WritesManyChunks) {
  TestFolder other;
  const std::string noise(300'000, 'n');
  for (int k = 0; k < 12; ++k) {
    other.Write("cam0/" + std::to_string(kStart + k) + ".png",
                "\x89PNG\r\n\x1a\n" + std::to_string(k) + noise);
  }
  const Recording recording = OpenRecording(other.path(), {});
  for (const RecordingForm form : {RecordingForm::kRosbag1, RecordingForm::kMcap}) {
    const std::string path = Path(folder_, "many");
    ConvertRecording(recording, form, path, true);
    const Recording copy = OpenRecording(path, {});
    const auto& images = std::get<CameraImages>(copy.cameras[0].data);
    ASSERT_EQ(images.list.size(), 12U);
    for (size_t k = 0; k < 12; ++k) {
      EXPECT_EQ(std::get<EncodedFile>(images.reader->Read(k).content).bytes,
                "\x89PNG\r\n\x1a\n" + std::to_string(k) + noise);
    }
  }
}

TEST_F(ConvertTest, GivesTheSameBytesTwice) {
  for (const RecordingForm form : {RecordingForm::kRosbag1, RecordingForm::kMcap}) {
    ConvertRecording(source_, form, Path(folder_, "one"), true);
    ConvertRecording(source_, form, Path(folder_, "two"), true);
    EXPECT_EQ(ReadFile(Path(folder_, "one")), ReadFile(Path(folder_, "two")));
  }
}

TEST_F(ConvertTest, ReplacesOnlyWhenAskedAndOnlyRecordings) {
  const std::string path = folder_.Write("there", "precious");
  EXPECT_THAT(ErrorOf(source_, "there"), AllOf(HasSubstr(path), HasSubstr("--force")));
  EXPECT_EQ(ReadFile(path), "precious");
  folder_.Write("thesis/chapter1.txt", "precious");
  EXPECT_THAT(InputErrorOf([&] {
                ConvertRecording(source_, RecordingForm::kFolder, Path(folder_, "thesis"), true);
              }),
              HasSubstr("holds no recording"));
  EXPECT_EQ(ReadFile(Path(folder_, "thesis/chapter1.txt")), "precious");
  // A recording may be replaced, also by what it is read from.
  const std::string folder = Path(folder_, "folder");
  ConvertRecording(source_, RecordingForm::kFolder, folder, false);
  ConvertRecording(OpenRecording(folder, {}), RecordingForm::kFolder, folder, true);
  EXPECT_EQ(Measurements(OpenRecording(folder, {}), true), Measurements(source_, true));
}

TEST_F(ConvertTest, LeavesNothingBehindWhenAnImageCannotBeRead) {
  TestFolder other;
  const std::string image = other.Write("cam0/1600000000000000001.png", "\x89PNG\r\n\x1a\n");
  other.Write("cam0/1600000000000000000.png", "\x89PNG\r\n\x1a\n");
  const Recording recording = OpenRecording(other.path(), {});
  fs::remove(image);
  const auto num_entries = [&] {
    return std::distance(fs::directory_iterator(folder_.path()), fs::directory_iterator());
  };
  const auto before = num_entries();
  for (const RecordingForm form :
       {RecordingForm::kRosbag1, RecordingForm::kMcap, RecordingForm::kFolder}) {
    EXPECT_THAT(
        InputErrorOf([&] { ConvertRecording(recording, form, Path(folder_, "never"), false); }),
        HasSubstr("1600000000000000001.png"));
    EXPECT_EQ(num_entries(), before);
  }
}

TEST_F(ConvertTest, RefusesStampsThatWouldNotFit) {
  // 2^31 s fit into a header of ROS 1, not of ROS 2; 2^32 s into neither.
  for (const auto& [stamp, fits_ros1] :
       {std::pair("2147483648000000000", true), std::pair("4294967296000000000", false)}) {
    TestFolder late;
    late.Write("cam0/" + std::string(stamp) + ".png", "\x89PNG\r\n\x1a\n");
    const Recording recording = OpenRecording(late.path(), {});
    EXPECT_EQ(ErrorOf(recording, "late.bag", true).empty(), fits_ros1);
    EXPECT_THAT(InputErrorOf([&] {
                  ConvertRecording(recording, RecordingForm::kMcap, Path(folder_, "late"), true);
                }),
                HasSubstr("too late"));
  }
}

TEST_F(ConvertTest, RefusesWhatBagsHaveNoFormFor) {
  TestFolder corners;
  corners.Write("cam0_corners.csv", "timestamp,tag_id,u,v,x,y,z\n5,0,1,2,0,0,0\n");
  EXPECT_THAT(ErrorOf(OpenRecording(corners.path(), {}), "x"), HasSubstr("corner lists"));
  TestFolder photos;
  photos.Write("left01.png", "");
  photos.Write("left02.png", "");
  EXPECT_THAT(ErrorOf(OpenRecording(photos.path(), {}), "x"), HasSubstr("without stamps"));
  EXPECT_THAT(InputErrorOf([] { static_cast<void>(RecordingFormFromName("zip")); }),
              AllOf(HasSubstr("'zip'"), HasSubstr("folder, rosbag1 or mcap")));
}

}  // namespace
}  // namespace calibrato
