// The same recording as a folder and in bags that other programs wrote: ROS's own rosbag, SQLite
// from Python, @mcap/core. What is measured and what is calibrated is the same, to the byte.

#include <gtest/gtest.h>

#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include "broken_recordings.h"
#include "calibrato/base/files.h"
#include "calibrato/cli/program_for_test.h"
#include "calibrato/recording/recording.h"

namespace calibrato {
namespace {

constexpr char kPython[] = "/usr/bin/python3";

bool Succeeds(const std::string& command) {
  return std::system((command + " >/dev/null 2>&1").c_str()) == 0;
}

std::string Quoted(const std::string& path) { return "'" + path + "'"; }

std::string Script(const std::string& name) {
  return Quoted(std::string(OTHER_WRITERS_FOLDER "/") + name);
}

class OtherWriters : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    scratch_ = new ScratchFolder;
    const PlainRecording clean = CleanImages();
    OutputFolder png(scratch_->Path("png"));
    for (auto& [name, content] : FilesOf(clean)) png.Add(name, content);
    png.Commit();
    // The same pixels without packing, for those who write raw images.
    OutputFolder pgm(scratch_->Path("pgm"));
    const Recording recording = OpenRecording(png.path(), {});
    const auto& images = std::get<CameraImages>(recording.cameras.at(0).data);
    for (size_t k = 0; k < images.list.size(); ++k) {
      const GreyImage grey = GreyOf(images.reader->Read(k));
      const std::string header = "P5\n" + std::to_string(grey.resolution.width) + " " +
                                 std::to_string(grey.resolution.height) + "\n255\n";
      pgm.Add("cam0/" + std::to_string(images.list[k].stamp.nanoseconds()) + ".pgm",
              header + std::string(grey.pixels.begin(), grey.pixels.end()));
    }
    pgm.Add("imu0.csv", FilesOf(clean).at("imu0.csv"));
    pgm.Commit();
    calibrated_ = Calibrated("png");
  }
  static void TearDownTestSuite() { delete scratch_; }

  // The results, but for wall times and pictures.
  static std::map<std::string, std::string> Calibrated(const std::string& recording) {
    const std::string out = scratch_->Path("calibrated-" + recording);
    const Ended ended = RunProgram({"calibrate", "camera-imu", scratch_->Path(recording),
                                    "--target", scratch_->Path("png/target.yaml"), "--cameras",
                                    scratch_->Path("png/camchain.yaml"), "--imu",
                                    scratch_->Path("png/imu.yaml"), "--quiet", "--out", out});
    EXPECT_EQ(ended.exit_code, 0) << ended.err;
    std::map<std::string, std::string> files = FilesBelow(out);
    EXPECT_TRUE(files.contains("camchain-imucam.yaml"));
    for (const char* name : {"timing.json", "report.html", "plots.json"}) files.erase(name);
    return files;
  }

  static void ExpectTheSame(const std::string& recording) {
    const Recording one = OpenRecording(scratch_->Path("png"), {});
    const Recording other = OpenRecording(scratch_->Path(recording), {});
    ASSERT_EQ(other.cameras.size(), 1U);
    ASSERT_EQ(other.imus.size(), 1U);
    const auto& images = std::get<CameraImages>(one.cameras[0].data);
    const auto& others = std::get<CameraImages>(other.cameras[0].data);
    ASSERT_EQ(others.list.size(), images.list.size());
    for (size_t k = 0; k < images.list.size(); ++k) {
      EXPECT_EQ(others.list[k].stamp, images.list[k].stamp);
      EXPECT_EQ(GreyOf(others.reader->Read(k)).pixels, GreyOf(images.reader->Read(k)).pixels);
    }
    const auto expect_samples = [](const std::vector<VectorSample>& a,
                                   const std::vector<VectorSample>& b) {
      ASSERT_EQ(a.size(), b.size());
      for (size_t k = 0; k < a.size(); ++k) {
        EXPECT_EQ(a[k].stamp, b[k].stamp);
        EXPECT_EQ(a[k].value, b[k].value);
      }
    };
    expect_samples(one.imus[0].stream.gyro, other.imus[0].stream.gyro);
    expect_samples(one.imus[0].stream.accel, other.imus[0].stream.accel);
    EXPECT_EQ(Calibrated(recording), calibrated_);
  }

  static ScratchFolder* scratch_;
  static std::map<std::string, std::string> calibrated_;
};
ScratchFolder* OtherWriters::scratch_ = nullptr;
std::map<std::string, std::string> OtherWriters::calibrated_;

TEST_F(OtherWriters, Rosbag1OfPythonsRosbagIsTheSame) {
  const std::string python = kPython;
  if (!Succeeds(python + " -c 'import rosbag, sensor_msgs.msg'")) {
    GTEST_SKIP() << "needs Debian's python3-rosbag and python3-sensor-msgs";
  }
  ASSERT_TRUE(Succeeds(python + " " + Script("write_rosbag1.py") + " " +
                       Quoted(scratch_->Path("pgm")) + " " + Quoted(scratch_->Path("a.bag"))));
  ExpectTheSame("a.bag");
}

TEST_F(OtherWriters, Rosbag2OfPythonsSqliteIsTheSame) {
  const std::string python = kPython;
  if (!Succeeds(python + " -c 'import sqlite3'")) GTEST_SKIP() << "needs Debian's python3";
  ASSERT_TRUE(Succeeds(python + " " + Script("write_rosbag2.py") + " " +
                       Quoted(scratch_->Path("pgm")) + " " + Quoted(scratch_->Path("a.db3"))));
  ExpectTheSame("a.db3");
}

TEST_F(OtherWriters, McapOfMcapCoreIsTheSame) {
  ASSERT_TRUE(Succeeds("cd " MCAP_NODE_FOLDER " && node write.mjs " +
                       Quoted(scratch_->Path("png")) + " " + Quoted(scratch_->Path("a.mcap"))));
  ExpectTheSame("a.mcap");
}

TEST_F(OtherWriters, OurOwnFormsAreTheSame) {
  for (const std::string form : {"rosbag1", "mcap"}) {
    const std::string name = "ours-" + form;
    const Ended ended =
        RunProgram({"convert", scratch_->Path("png"), "--to", form, "--out", scratch_->Path(name)});
    ASSERT_EQ(ended.exit_code, 0) << ended.err;
    ExpectTheSame(name);
  }
}

TEST_F(OtherWriters, McapCoreReadsWhatIsConverted) {
  const std::string ours = scratch_->Path("read-back.mcap");
  ASSERT_EQ(RunProgram({"convert", scratch_->Path("png"), "--to", "mcap", "--out", ours}).exit_code,
            0);
  const std::string said = scratch_->Path("said");
  ASSERT_EQ(std::system(("cd " MCAP_NODE_FOLDER " && node read.mjs " + Quoted(ours) + " " +
                         Quoted(scratch_->Path("png")) + " >" + Quoted(said))
                            .c_str()),
            0);
  EXPECT_EQ(ContentOf(said), "60 images, 1200 samples\n");
}

}  // namespace
}  // namespace calibrato
