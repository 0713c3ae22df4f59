// `calibrato convert`, and every kind of recording through `calibrate`, as their users run them.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "calibrato/cli/program_for_test.h"

namespace calibrato {
namespace {

namespace fs = std::filesystem;

// Two images of three pixels, an IMU.
void WriteRecording(const ScratchFolder& scratch) {
  (void)scratch.Write("folder/cam0/1600000000000000001.pgm", "P5 3 1 255\nabc");
  (void)scratch.Write("folder/cam0/1600000000050000002.pgm", "P5 3 1 255\ndef");
  (void)scratch.Write("folder/imu0.csv",
                      "#timestamp [ns],w_x [rad/s],w_y [rad/s],w_z [rad/s],a_x [m/s^2],a_y [m/s^2],"
                      "a_z [m/s^2]\n1600000000000000003,0.1,0.2,0.3,0,-0.5,9.81\n");
}

Ended Convert(const ScratchFolder& scratch, const std::string& from, const std::string& form,
              const std::string& to, const Arguments& more = {}) {
  Arguments arguments = {"convert", scratch.Path(from), "--to", form, "--out", scratch.Path(to)};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return RunProgram(arguments);
}

TEST(ConvertCommand, GoesThroughAllFormsAndBackToTheSameFiles) {
  const ScratchFolder scratch;
  WriteRecording(scratch);
  const Ended first = Convert(scratch, "folder", "rosbag1", "a.bag");
  EXPECT_EQ(first.exit_code, 0) << first.err;
  EXPECT_NE(first.out.find("2 images of 1 cameras, 1 samples of 1 IMUs"), std::string::npos)
      << first.out;
  const Ended second = Convert(scratch, "a.bag", "mcap", "b.mcap", {"--json"});
  EXPECT_EQ(second.exit_code, 0) << second.err;
  EXPECT_NE(second.out.find("\"num_images\": 2"), std::string::npos) << second.out;
  const Ended third = Convert(scratch, "b.mcap", "folder", "back");
  EXPECT_EQ(third.exit_code, 0) << third.err;
  const auto files = FilesBelow(scratch.Path("folder"));
  EXPECT_EQ(files.size(), 3U);
  EXPECT_EQ(FilesBelow(scratch.Path("back")), files);
}

TEST(ConvertCommand, RefusesInOneLineAndWritesNothing) {
  const ScratchFolder scratch;
  WriteRecording(scratch);
  const auto refused = [&](const Ended& ended) {
    EXPECT_EQ(ended.exit_code, 2);
    EXPECT_EQ(std::count(ended.err.begin(), ended.err.end(), '\n'), 1) << ended.err;
    return ended.err;
  };
  EXPECT_NE(refused(Convert(scratch, "folder", "zip", "a.zip")).find("'zip'"), std::string::npos);
  EXPECT_FALSE(fs::exists(scratch.Path("a.zip")));
  const std::string there = scratch.Write("there", "precious");
  EXPECT_NE(refused(Convert(scratch, "folder", "mcap", "there")).find("--force"),
            std::string::npos);
  EXPECT_EQ(ContentOf(there), "precious");
  EXPECT_EQ(Convert(scratch, "folder", "mcap", "there", {"--force"}).exit_code, 0);
  const std::string whole = ContentOf(there);
  (void)scratch.Write("cut", whole.substr(0, whole.size() / 2));
  EXPECT_NE(refused(Convert(scratch, "cut", "folder", "never")).find("truncated"),
            std::string::npos);
  EXPECT_FALSE(fs::exists(scratch.Path("never")));
}

// Photos of a checkerboard that came with OpenCV, named by stamps.
class CalibrateFromAnywhere : public testing::Test {
 protected:
  void SetUp() override {
    const fs::path photos = "/usr/share/doc/opencv-doc/examples/data";
    if (!fs::exists(photos / "left01.jpg")) GTEST_SKIP() << "opencv-doc has no photos here";
    for (const char* number : {"01", "02", "03", "04", "05", "06", "07", "08", "09"}) {
      (void)scratch_.Write("folder/cam0/16000000000000000" + std::string(number) + ".jpg",
                           ContentOf(photos / ("left" + std::string(number) + ".jpg")));
    }
    target_ = scratch_.Write("board.yaml",
                             "target_type: 'checkerboard'\ntargetCols: 9\ntargetRows: 6\n"
                             "rowSpacingMeters: 0.025\ncolSpacingMeters: 0.025\n");
  }
  std::string ChainOf(const std::string& recording) {
    const std::string out = recording + "_result";
    const Ended ended = RunProgram({"calibrate", "camera", scratch_.Path(recording), "--target",
                                    target_, "--out", scratch_.Path(out)});
    EXPECT_NE(ended.exit_code, 2) << ended.err;
    return ContentOf(scratch_.Path(out + "/camchain.yaml"));
  }
  ScratchFolder scratch_;
  std::string target_;
};

TEST_F(CalibrateFromAnywhere, GivesTheSameCamera) {
  const std::string expected = ChainOf("folder");
  ASSERT_NE(expected, "");
  EXPECT_EQ(Convert(scratch_, "folder", "rosbag1", "a.bag").exit_code, 0);
  EXPECT_EQ(ChainOf("a.bag"), expected);
  EXPECT_EQ(Convert(scratch_, "folder", "mcap", "a.mcap").exit_code, 0);
  EXPECT_EQ(ChainOf("a.mcap"), expected);
}

}  // namespace
}  // namespace calibrato
