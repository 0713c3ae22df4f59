// Bad input, given to the program itself: exit code 2, one line that says what to do, and nothing
// written.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "calibrato/base/files.h"
#include "calibrato/base/value.h"
#include "calibrato/cli/program_for_test.h"

namespace calibrato {
namespace {

constexpr int kBadInput = 2;

std::string InWords(const Arguments& arguments) {
  std::string text = "calibrato";
  for (const std::string& word : arguments) text += " " + word;
  return text;
}

void ExpectOneErrorLine(const Ended& ended, const std::vector<std::string>& words) {
  EXPECT_EQ(ended.exit_code, kBadInput) << "signal " << ended.signal;
  EXPECT_EQ(ended.out, "");
  EXPECT_TRUE(ended.err.starts_with("error: ")) << ended.err;
  EXPECT_EQ(std::count(ended.err.begin(), ended.err.end(), '\n'), 1) << ended.err;
  EXPECT_TRUE(ended.err.ends_with('\n')) << ended.err;
  for (const std::string& word : words) EXPECT_PRED_FORMAT2(testing::IsSubstring, word, ended.err);
}

// Appends --out, runs, and expects a refusal that has all these words and leaves nothing there.
void ExpectRefused(const ScratchFolder& scratch, Arguments arguments,
                   const std::vector<std::string>& words) {
  const std::string out = scratch.Path("out");
  arguments.insert(arguments.end(), {"--out", out});
  SCOPED_TRACE(InWords(arguments));
  ExpectOneErrorLine(RunProgram(arguments), words);
  EXPECT_FALSE(std::filesystem::exists(out)) << "something was written";
}

struct Squares {
  int rows;     ///< One more than there are inner corners.
  int columns;  ///< Likewise.
};

constexpr Squares kSquares{6, 7};

// A board seen from straight ahead: squares of 40 px, a black one at the top left, white around.
std::string BoardPgm(int width, int height, Squares squares, int left, int top) {
  constexpr int kSide = 40;
  std::string image = "P5\n" + std::to_string(width) + " " + std::to_string(height) + "\n255\n";
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      const int row = (v - top) / kSide;
      const int column = (u - left) / kSide;
      const bool is_on_board =
          v >= top && u >= left && row < squares.rows && column < squares.columns;
      image += is_on_board && (row + column) % 2 == 0 ? '\x10' : '\xf0';
    }
  }
  return image;
}

std::string BoardPgm(int left, int top) { return BoardPgm(480, 400, kSquares, left, top); }

std::string TargetYaml(int rows, int columns) {
  return "target_type: 'checkerboard'\ntargetCols: " + std::to_string(columns) +
         "\ntargetRows: " + std::to_string(rows) +
         "\nrowSpacingMeters: 0.03\ncolSpacingMeters: 0.03\n";
}

std::string TargetYaml() { return TargetYaml(kSquares.rows - 1, kSquares.columns - 1); }

// Photos of one board from three places, and the board's description.
struct PhotoRecording {
  ScratchFolder scratch;
  std::string folder = scratch.MakeFolder("photos");
  std::string target = scratch.Write("board.yaml", TargetYaml());

  PhotoRecording() {
    (void)scratch.Write("photos/a.pgm", BoardPgm(50, 50));
    (void)scratch.Write("photos/b.pgm", BoardPgm(110, 60));
    (void)scratch.Write("photos/c.pgm", BoardPgm(80, 90));
  }

  [[nodiscard]] Arguments Calibrate() const {
    return {"calibrate", "camera", folder, "--target", target};
  }
};

struct SimulationInput {
  ScratchFolder scratch;
  std::string rig = scratch.Write("rig.yaml", RigYaml());
  std::string motion = scratch.Write("motion.yaml", MotionYaml(0.1));

  [[nodiscard]] Arguments Simulate() const {
    return {"simulate", "--rig", rig, "--motion", motion};
  }

  /// Makes a recording that can be calibrated. Returns its folder.
  [[nodiscard]] std::string Record() const {
    const std::string recording = scratch.Path("recording");
    Arguments arguments = Simulate();
    arguments.insert(arguments.end(), {"--out", recording});
    EXPECT_EQ(RunProgram(arguments).exit_code, 0);
    return recording;
  }
};

Arguments With(Arguments arguments, const Arguments& more) {
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

// Recordings --------------------------------------------------------------------------------------

TEST(CalibrateCamera, RefusesAFolderThatIsNotThere) {
  const ScratchFolder scratch;
  ExpectRefused(scratch, {"calibrate", "camera", scratch.Path("nowhere")},
                {"nowhere", "no such file or folder"});
}

TEST(CalibrateCamera, RefusesAnEmptyFolderAndSaysWhatItLookedFor) {
  const ScratchFolder scratch;
  ExpectRefused(scratch, {"calibrate", "camera", scratch.MakeFolder("empty")},
                {"empty", "cam0_corners.csv", "png"});
}

TEST(CalibrateCamera, RefusesImagesWithoutABoard) {
  const PhotoRecording photos;
  ExpectRefused(photos.scratch, {"calibrate", "camera", photos.folder}, {"--target"});
}

TEST(CalibrateCamera, NamesAnImageOfNoBytes) {
  const PhotoRecording photos;
  (void)photos.scratch.Write("photos/b.pgm", "");
  ExpectRefused(photos.scratch, photos.Calibrate(), {"b.pgm", "empty"});
}

TEST(CalibrateCamera, NamesATruncatedImage) {
  const PhotoRecording photos;
  const std::string whole = BoardPgm(110, 60);
  (void)photos.scratch.Write("photos/b.pgm", whole.substr(0, whole.size() / 2));
  ExpectRefused(photos.scratch, photos.Calibrate(), {"b.pgm", "truncated"});
}

TEST(CalibrateCamera, NamesATruncatedPng) {
  const PhotoRecording photos;
  // The first 45 of the 67 bytes of an image of one white pixel: up to amid its pixels.
  constexpr std::array<unsigned char, 45> kPng = {
      0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44,
      0x52, 0x00, 0x00, 0x00, 0x01, 0x00, 0x00, 0x00, 0x01, 0x08, 0x00, 0x00, 0x00, 0x00, 0x3a,
      0x7e, 0x9b, 0x55, 0x00, 0x00, 0x00, 0x0a, 0x49, 0x44, 0x41, 0x54, 0x78, 0x9c, 0x63, 0xf8};
  (void)photos.scratch.Write("photos/d.png", std::string(kPng.begin(), kPng.end()));
  ExpectRefused(photos.scratch, photos.Calibrate(), {"d.png", "truncated"});
}

TEST(CalibrateCamera, NamesAnImageThatIsText) {
  const PhotoRecording photos;
  (void)photos.scratch.Write("photos/b.pgm", "this is not an image\n");
  ExpectRefused(photos.scratch, photos.Calibrate(), {"b.pgm", "image"});
}

TEST(CalibrateCamera, RefusesBoardsInImagesOfTwoSizes) {
  const PhotoRecording photos;
  (void)photos.scratch.Write("photos/c.pgm", BoardPgm(640, 480, kSquares, 100, 100));
  ExpectRefused(photos.scratch, photos.Calibrate(), {"c.pgm", "480 x 400", "640 x 480"});
}

TEST(CalibrateCamera, SaysWhatItSearchedForWhenNoImageShowsABoard) {
  const PhotoRecording photos;
  for (const char* name : {"photos/a.pgm", "photos/b.pgm", "photos/c.pgm"}) {
    (void)photos.scratch.Write(name, BoardPgm(480, 400, {0, 0}, 0, 0));
  }
  ExpectRefused(photos.scratch, photos.Calibrate(),
                {"no board found", "searched 3 images", "5 rows x 6 columns", "--target"});
}

TEST(CalibrateCamera, SuggestsTheBoardWhenSquaresWereCounted) {
  const PhotoRecording photos;
  (void)photos.scratch.Write("board.yaml", TargetYaml(kSquares.rows, kSquares.columns));
  ExpectRefused(photos.scratch, photos.Calibrate(),
                {"searched 3 images", "6 rows x 7 columns", "targetRows: 5", "targetCols: 6",
                 "inner corners"});
}

TEST(CalibrateCamera, RefusesFewerThanThreeViews) {
  const PhotoRecording photos;
  std::filesystem::remove(photos.folder + "/c.pgm");
  ExpectRefused(photos.scratch, photos.Calibrate(), {"too few views", "found in 2", "at least 3"});
}

TEST(CalibrateCamera, CountsViewsNotImages) {
  const PhotoRecording photos;
  (void)photos.scratch.Write("photos/c.pgm", BoardPgm(480, 400, {0, 0}, 0, 0));
  ExpectRefused(photos.scratch, photos.Calibrate(), {"too few views", "found in 2", "at least 3"});
}

TEST(CalibrateCamera, RefusesAnUnknownSelection) {
  const PhotoRecording photos;
  ExpectRefused(photos.scratch, With(photos.Calibrate(), {"--select", "best"}),
                {"best", "coverage", "information"});
}

TEST(CalibrateCamera, RefusesTimesOfPhotosWithoutStamps) {
  const PhotoRecording photos;
  ExpectRefused(photos.scratch, With(photos.Calibrate(), {"--from", "1"}), {"stamps", "--from"});
}

TEST(CalibrateCamera, RefusesToUseEveryZerothFrame) {
  const PhotoRecording photos;
  ExpectRefused(photos.scratch, With(photos.Calibrate(), {"--every", "0"}), {"--every 0"});
}

// Boards ------------------------------------------------------------------------------------------

void ExpectTargetRefused(const std::string& yaml, const std::vector<std::string>& words) {
  const PhotoRecording photos;
  (void)photos.scratch.Write("board.yaml", yaml);
  ExpectRefused(photos.scratch, photos.Calibrate(), words);
}

TEST(Target, NamesTheNearestKeyOfATypo) {
  ExpectTargetRefused(
      "target_type: 'checkerboard'\ntargetColls: 6\ntargetRows: 5\nrowSpacingMeters: 0.03\n"
      "colSpacingMeters: 0.03\n",
      {"board.yaml", "line 1", "did you mean targetCols where targetColls stands?"});
}

TEST(Target, NamesAMissingKey) {
  ExpectTargetRefused(
      "target_type: 'checkerboard'\ntargetCols: 6\ntargetRows: 5\nrowSpacingMeters: 0.03\n",
      {"board.yaml", "line 1", "missing key colSpacingMeters"});
}

TEST(Target, TakesNoKeyThatIsWantedForAMissingOne) {
  ExpectTargetRefused(
      "target_type: 'checkerboard'\ntargetRows: 5\nrowSpacingMeters: 0.03\n"
      "colSpacingMeters: 0.03\n",
      {"board.yaml", "missing key targetCols", "add 'targetCols: ...'"});
  ExpectTargetRefused("target_type: 'aprilgrid'\ntagCols: 6\ntagSize: 0.088\ntagSpacing: 0.3\n",
                      {"board.yaml", "missing key tagRows", "add 'tagRows: ...'"});
}

TEST(Target, NamesAWrongTypeWithLineAndKey) {
  ExpectTargetRefused(
      "target_type: 'checkerboard'\ntargetCols: six\ntargetRows: 5\nrowSpacingMeters: 0.03\n"
      "colSpacingMeters: 0.03\n",
      {"board.yaml", "line 2", "targetCols", "whole number", "six"});
}

TEST(Target, NamesANegativeSizeWithLineAndKey) {
  ExpectTargetRefused(
      "target_type: 'checkerboard'\ntargetCols: 6\ntargetRows: 5\nrowSpacingMeters: -0.03\n"
      "colSpacingMeters: 0.03\n",
      {"board.yaml", "line 4", "rowSpacingMeters", "-0.03"});
}

TEST(Target, NamesANegativeNumberOfCornersWithLineAndKey) {
  ExpectTargetRefused(
      "target_type: 'checkerboard'\ntargetCols: 6\ntargetRows: -5\nrowSpacingMeters: 0.03\n"
      "colSpacingMeters: 0.03\n",
      {"board.yaml", "line 3", "targetRows", "-5"});
}

TEST(Target, NamesTheLineOfTextThatIsNotYaml) {
  ExpectTargetRefused("target_type: 'checkerboard'\ntargetCols: [6\ntargetRows: }{\n",
                      {"board.yaml", "line 3"});
}

TEST(Target, RefusesAFileThatIsNotThere) {
  const PhotoRecording photos;
  std::filesystem::remove(photos.target);
  ExpectRefused(photos.scratch, photos.Calibrate(), {"board.yaml", "no such file"});
}

// Where results go --------------------------------------------------------------------------------

TEST(OutputFolder, BelowAFileIsRefused) {
  const PhotoRecording photos;
  const std::string out = photos.target + "/below";
  ExpectOneErrorLine(RunProgram(With(photos.Calibrate(), {"--out", out})),
                     {"board.yaml", "is a file, not a folder"});
  EXPECT_EQ(ContentOf(photos.target), TargetYaml());
}

TEST(OutputFolder, ThatIsAFileIsRefused) {
  const PhotoRecording photos;
  ExpectOneErrorLine(RunProgram(With(photos.Calibrate(), {"--out", photos.target})),
                     {"board.yaml", "is a file, not a folder"});
  EXPECT_EQ(ContentOf(photos.target), TargetYaml());
}

TEST(OutputFolder, InAReadOnlyFolderIsRefused) {
  if (geteuid() == 0) GTEST_SKIP() << "root may write anywhere";
  namespace fs = std::filesystem;
  const PhotoRecording photos;
  const std::string locked = photos.scratch.MakeFolder("locked");
  fs::permissions(locked, fs::perms::owner_read | fs::perms::owner_exec);
  const std::string out = locked + "/out";
  ExpectOneErrorLine(RunProgram(With(photos.Calibrate(), {"--out", out})), {"locked"});
  EXPECT_FALSE(fs::exists(out));
  fs::permissions(locked, fs::perms::owner_all);
}

void ExpectRefusedByAFullDisk(const ScratchFolder& scratch, const Arguments& command) {
  constexpr rlim_t kMaxFileBytes = 1000;
  const std::string out = scratch.Path("out");
  SCOPED_TRACE(InWords(command));
  ExpectOneErrorLine(RunProgram(With(command, {"--out", out}), kMaxFileBytes),
                     {"cannot write file", "out"});
  EXPECT_FALSE(std::filesystem::exists(out)) << "something was written";
}

TEST(FullDisk, LeavesNothingOfACalibration) {
  const SimulationInput input;
  ExpectRefusedByAFullDisk(input.scratch, {"calibrate", "camera", input.Record()});
}

TEST(FullDisk, LeavesNothingOfASimulation) {
  const SimulationInput input;
  ExpectRefusedByAFullDisk(input.scratch, input.Simulate());
}

TEST(FullDisk, LeavesNothingOfAnEvaluation) {
  const ScratchFolder scratch;
  ExpectRefusedByAFullDisk(scratch,
                           {"evaluate", "table1", "--task", "intrinsic", "--num-rigs", "2"});
}

TEST(FullDisk, LeavesNothingOfLearning) {
  const ScratchFolder scratch;
  ExpectRefusedByAFullDisk(scratch, {"learn", "intrinsic", "--preset", "paper", "--episodes", "2"});
}

TEST(FullDisk, LeavesAnEarlierResultAsItWas) {
  constexpr rlim_t kMaxFileBytes = 1000;
  const SimulationInput input;
  const std::string out = input.scratch.Path("out");
  const Arguments calibrate = {"calibrate", "camera", input.Record(), "--out", out};
  ASSERT_LE(RunProgram(calibrate).exit_code, 1);
  const auto before = FilesBelow(out);
  ASSERT_TRUE(before.count("result.json"));
  ExpectOneErrorLine(RunProgram(With(calibrate, {"--model", "pinhole-none"}), kMaxFileBytes),
                     {"cannot write file"});
  EXPECT_TRUE(FilesBelow(out) == before);
}

// Words -------------------------------------------------------------------------------------------

TEST(CommandLine, NamesAnUnknownModelAndThoseThereAre) {
  const PhotoRecording photos;
  ExpectRefused(photos.scratch, With(photos.Calibrate(), {"--model", "pinhole-radtn"}),
                {"pinhole-radtn", "pinhole-radtan"});
}

TEST(CommandLine, NamesAnUnknownParameterToFixAndThoseThereAre) {
  const SimulationInput input;
  ExpectRefused(input.scratch, {"calibrate", "camera", input.Record(), "--fix", "k1,k9"},
                {"'k9'", "fu", "k1"});
}

TEST(CommandLine, NamesAnUnknownOption) {
  const PhotoRecording photos;
  ExpectRefused(photos.scratch, With(photos.Calibrate(), {"--bogus"}),
                {"--bogus", "calibrato calibrate camera --help"});
}

TEST(CommandLine, NamesAMissingOption) {
  const PhotoRecording photos;
  ExpectOneErrorLine(RunProgram(photos.Calibrate()),
                     {"--out", "calibrato calibrate camera --help"});
  ExpectRefused(photos.scratch, {"simulate", "--rig", photos.target},
                {"--motion", "calibrato simulate --help"});
}

TEST(CommandLine, NamesAValueThatIsNoNumber) {
  const PhotoRecording photos;
  ExpectRefused(photos.scratch, With(photos.Calibrate(), {"--seed", "many"}), {"--seed", "many"});
  ExpectRefused(photos.scratch, With(photos.Calibrate(), {"--threads", "-4"}), {"--threads", "-4"});
}

TEST(CommandLine, NamesAnUnknownCommand) {
  const ScratchFolder scratch;
  ExpectRefused(scratch, {"kalibrate", "camera"}, {"kalibrate", "calibrato --help"});
  ExpectRefused(scratch, {"calibrate", "lens"}, {"lens", "calibrato calibrate --help"});
}

TEST(CommandLine, AsksForACommand) { ExpectOneErrorLine(RunProgram({}), {"calibrato --help"}); }

// Simulation --------------------------------------------------------------------------------------

TEST(Simulate, NamesTheLimitAndTheWayPointThatDoNotFit) {
  const SimulationInput input;
  (void)input.scratch.Write("motion.yaml", MotionYaml(1.0));
  ExpectRefused(input.scratch, input.Simulate(),
                {"motion.yaml", "reach from the shoulder", "loop 1, way-point", "0.75 m",
                 "of 62 way-points", "--scale-to-fit"});
}

TEST(Simulate, NamesAFidelityThatIsNotThere) {
  const SimulationInput input;
  ExpectRefused(input.scratch, With(input.Simulate(), {"--fidelity", "renderd"}),
                {"renderd", "did you mean rendered?"});
}

TEST(Simulate, NamesAnEffectThatIsNotThere) {
  const SimulationInput input;
  ExpectRefused(input.scratch, With(input.Simulate(), {"--effects", "jitter,drop"}),
                {"drop", "did you mean drops?"});
}

TEST(Simulate, KeepsTheEffectsInTheRigOfTheRecording) {
  const SimulationInput input;
  const std::string recording = input.scratch.Path("recording");
  const Ended ended = RunProgram(
      With(input.Simulate(), {"--effects", "stand-motion,lens-residual", "--out", recording}));
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  const Value rig = ParseYaml(ReadFile(recording + "/rig.yaml"), "rig.yaml");
  EXPECT_EQ(rig.At("stand_motion_m").AsDouble(), 2e-4);
  EXPECT_EQ(rig.At("lens_residual").At("rms_px").AsDouble(), 0.1);
}

TEST(Simulate, NamesAMistakeInTheRig) {
  const SimulationInput input;
  for (const auto& [text, word] :
       {std::pair<std::string, std::string>(RigYaml().substr(0, RigYaml().size() / 3), "rig.yaml"),
        {"cameras: [", "line"},
        {std::string("\xff\xfe\x00rig", 6), "rig.yaml"}}) {
    (void)input.scratch.Write("rig.yaml", text);
    ExpectRefused(input.scratch, input.Simulate(), {word});
  }
}

TEST(Simulate, NamesTheArmWhereThereAreNoDynamics) {
  const SimulationInput input;
  ExpectRefused(input.scratch, With(input.Simulate(), {"--fidelity", "physical"}),
                {"physical", "--carrier arm", "--fidelity fast"});
}

TEST(Simulate, WritesAPhysicalRecordingAndSaysHowTheArmFollowed) {
  const SimulationInput input;
  const std::string recording = input.scratch.Path("recording");
  const Ended ended =
      RunProgram(With(input.Simulate(), {"--carrier", "arm", "--fidelity", "physical",
                                         "--scale-to-fit", "--json", "--out", recording}));
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  for (const char* key : {"\"fidelity\": \"physical\"", "max_position_error_m",
                          "max_rotation_error_rad", "max_torque_share"}) {
    EXPECT_NE(ended.out.find(key), std::string::npos) << ended.out;
  }
  EXPECT_TRUE(FilesBelow(recording).contains("cam0_corners.csv"));
}

TEST(Simulate, WritesARenderedRecordingWithItsVideo) {
  const SimulationInput input;
  const std::string recording = input.scratch.Path("recording");
  const Ended ended =
      RunProgram(With(input.Simulate(), {"--fidelity", "rendered", "--video", "--out", recording}));
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  const auto files = FilesBelow(recording);
  EXPECT_TRUE(files.contains("video.avi"));
  EXPECT_TRUE(files.contains("truth_poses.csv"));
  EXPECT_FALSE(files.contains("cam0_corners.csv"));
  EXPECT_TRUE(files.contains("cam0/data/1600000000000000000.png"));
}

TEST(Simulate, SaysThatOnlyRenderedImagesMakeAVideo) {
  const SimulationInput input;
  ExpectRefused(input.scratch, With(input.Simulate(), {"--video"}),
                {"--video", "fidelity fast has none", "add --fidelity rendered"});
}

TEST(Simulate, SaysWhatRenderingLacksAndDoesWithoutIt) {
  const SimulationInput input;
  setenv("MUJOCO_GL", "off", 1);
  ExpectRefused(input.scratch, With(input.Simulate(), {"--fidelity", "rendered"}),
                {"without a screen", "libosmesa6", "--fidelity fast"});
  const Ended ended = RunProgram(With(input.Simulate(), {"--out", input.scratch.Path("out")}));
  unsetenv("MUJOCO_GL");
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
}

TEST(Simulate, NamesAnUnknownCarrier) {
  const SimulationInput input;
  ExpectRefused(input.scratch, With(input.Simulate(), {"--carrier", "crane"}),
                {"crane", "free", "arm"});
}

TEST(Simulate, NamesAMistakeInTheMotion) {
  const SimulationInput input;
  std::string text = MotionYaml(0.1);
  text.replace(text.find("duration_s: 5.0"), 15, "duration_s: 0.0");
  (void)input.scratch.Write("motion.yaml", text);
  ExpectRefused(input.scratch, input.Simulate(), {"motion.yaml", "line 6", "duration_s"});
}

TEST(Simulate, ReplacesNoFolderUnasked) {
  const SimulationInput input;
  const std::string precious = input.scratch.Write("recording/precious.txt", "mine");
  const std::string out = input.scratch.Path("recording");
  ExpectOneErrorLine(RunProgram(With(input.Simulate(), {"--out", out})), {"recording", "--force"});
  EXPECT_EQ(FilesBelow(out).size(), 1U);
  EXPECT_EQ(ContentOf(precious), "mine");
  EXPECT_EQ(RunProgram(With(input.Simulate(), {"--out", out, "--force"})).exit_code, 0);
  EXPECT_GT(FilesBelow(out).size(), 1U);
}

// Learning, evaluation, report --------------------------------------------------------------------

// Cameras and IMUs --------------------------------------------------------------------------------

constexpr const char* kChainYaml =
    "cam0:\n  camera_model: pinhole\n  intrinsics: [585.756, 585.756, 320.5, 240.5]\n"
    "  distortion_model: none\n  distortion_coeffs: []\n  resolution: [640, 480]\n";

TEST(CalibrateCameraImu, TakesACameraResultAndWritesWhatKalibrReads) {
  const SimulationInput input;
  const std::string recording = input.Record();
  const std::string target = input.scratch.Path("recording/target.yaml");
  const std::string cameras = input.scratch.Path("cameras");
  const Ended alone =
      RunProgram({"calibrate", "camera", recording, "--target", target, "--out", cameras});
  ASSERT_LE(alone.exit_code, 1) << alone.err;
  const std::string out = input.scratch.Path("out");
  const Ended both = RunProgram({"calibrate", "camera-imu", recording, "--target", target,
                                 "--camera-result", cameras, "--imu",
                                 input.scratch.Path("recording/imu.yaml"), "--json", "--out", out});
  // One loop says little: whether it is enough is not the question here.
  ASSERT_LE(both.exit_code, 1) << both.err;
  EXPECT_EQ(both.out, ReadFile(out + "/result.json"));
  EXPECT_EQ(ParseJson(both.out, "result.json").At("kind").AsString(), "camera-imu");
  const Value camera = ReadYaml(out + "/camchain-imucam.yaml").At("cam0");
  EXPECT_EQ(camera.At("T_cam_imu").AsDoubles(16).size(), 16u);
  EXPECT_NE(camera.Find("timeshift_cam_imu"), nullptr);
  EXPECT_EQ(ReadYaml(out + "/imu.yaml").At("imu0").At("update_rate").AsDouble(), 200.0);
  EXPECT_TRUE(ReadFile(out + "/trajectory.csv").starts_with("timestamp [ns],x,y,z,qw,qx,qy,qz\n"));
}

TEST(CalibrateCameraImu, NeedsCamerasAndAnImuFileForEachImu) {
  const SimulationInput input;
  const std::string recording = input.Record();
  const Arguments calibrate = {"calibrate", "camera-imu", recording, "--imu",
                               input.scratch.Path("recording/imu.yaml")};
  ExpectRefused(input.scratch, calibrate, {"no cameras given", "--cameras", "--camera-result"});
  const std::string chain = input.scratch.Write("chain.yaml", kChainYaml);
  ExpectRefused(
      input.scratch,
      With(calibrate, {"--cameras", chain, "--imu", input.scratch.Path("recording/imu.yaml")}),
      {"wrong number of --imu", "2 given", "recording's 1"});
  ExpectRefused(input.scratch, With(calibrate, {"--cameras", chain, "--imu-model", "perfect"}),
                {"perfect", "scale-misalignment"});
}

TEST(CalibrateCameraImu, RefusesARecordingWithoutAnImu) {
  const SimulationInput input;
  const std::string recording = input.Record();
  const std::string imu = input.scratch.Write("imu.yaml", ReadFile(recording + "/imu.yaml"));
  std::filesystem::remove(recording + "/imu0.csv");
  const std::string chain = input.scratch.Write("chain.yaml", kChainYaml);
  ExpectRefused(input.scratch,
                {"calibrate", "camera-imu", recording, "--cameras", chain, "--imu", imu},
                {"no IMU in the recording", "imu0.csv", "calibrate camera"});
}

TEST(Learn, ResumesNothingWithoutACheckpoint) {
  const ScratchFolder scratch;
  ExpectRefused(scratch, {"learn", "intrinsic", "--preset", "paper", "--episodes", "8", "--resume"},
                {"nothing to resume", "checkpoint.bin", "--resume"});
}

TEST(Learn, NamesATaskThatIsNotThere) {
  const ScratchFolder scratch;
  ExpectRefused(scratch, {"learn", "knitting"},
                {"knitting", "there are intrinsic, extrinsic and joint"});
}

TEST(Learn, NamesWhatItsOptionsMayBe) {
  const ScratchFolder scratch;
  const auto refuse = [&](const std::string& option, const std::string& value,
                          const std::vector<std::string>& words) {
    ExpectRefused(scratch,
                  {"learn", "intrinsic", "--preset", "paper", "--episodes", "2", option, value},
                  words);
  };
  refuse("--planner", "icen", {"unknown planner 'icen'", "icem", "q-library", "sac"});
  refuse("--mistakes", "frozen-swarm,lost-coverag", {"'lost-coverag'", "lost-coverage"});
  refuse("--reward", "applause", {"unknown reward", "reprojection"});
  refuse("--criterion", "f", {"unknown criterion", "a, d and e"});
  refuse("--fidelity", "physical", {"physical", "--carrier arm"});
  ExpectRefused(scratch, {"learn", "intrinsic", "--preset", "cheap"}, {"unknown preset 'cheap'"});
  ExpectRefused(
      scratch,
      {"learn", "joint", "--preset", "paper", "--episodes", "2", "--mistakes", "wrong-truth"},
      {"wrong-truth", "no joint task"});
}

TEST(Learn, PresetBestRefusesOptionsOfThePaper) {
  const ScratchFolder scratch;
  for (const auto& [option, value] :
       std::vector<std::pair<std::string, std::string>>{{"--planner", "cem"},
                                                        {"--round", "2"},
                                                        {"--mistakes", "all"},
                                                        {"--reward", "reprojection"}}) {
    ExpectRefused(scratch, {"learn", "intrinsic", option, value},
                  {"preset best has no " + option, "--preset paper"});
  }
}

TEST(Learn, PresetPaperRefusesOptionsOfTheBest) {
  const ScratchFolder scratch;
  for (const auto& [option, value] : std::vector<std::pair<std::string, std::string>>{
           {"--believed", "3"}, {"--max-path", "2"}, {"--max-time", "10"}}) {
    ExpectRefused(scratch, {"learn", "intrinsic", "--preset", "paper", option, value},
                  {"preset paper has no " + option, "preset best"});
  }
}

// NaN passes no check.
TEST(Learn, RefusesNumbersThatAreNone) {
  const ScratchFolder scratch;
  for (const char* value : {"nan", "-1", "inf"}) {
    ExpectRefused(scratch,
                  {"learn", "extrinsic", "--preset", "paper", "--information-weight", value},
                  {"--information-weight", value});
    ExpectRefused(scratch, {"learn", "extrinsic", "--max-path", value}, {"--max-path", value});
    ExpectRefused(scratch, {"board", "--target", "none.yaml", "--dpi", value}, {"--dpi", value});
  }
}

// A policy's motion, its task in the header.
std::string PolicyFolder(const ScratchFolder& scratch, const std::string& task) {
  (void)scratch.Write("policy/motion.yaml", MotionYaml(0.1));
  (void)scratch.Write("policy/policy.yaml",
                      "format_version: 1\npreset: best\ntask: " + task + "\n");
  return scratch.Path("policy");
}

TEST(Plan, RefusesOptionsThatHaveNoUse) {
  const SimulationInput input;
  const std::string policy = PolicyFolder(input.scratch, "extrinsic");
  const Arguments by_policy = {"plan", "--rig", input.rig, "--policy", policy};
  ExpectRefused(input.scratch, With(by_policy, {"--task", "intrinsic"}),
                {"policy of another task", "learned for the extrinsic task", "--task extrinsic"});
  for (const auto& [option, value] :
       std::vector<std::pair<std::string, std::string>>{{"--rigs", "paper"},
                                                        {"--believed", "3"},
                                                        {"--evaluations", "50"},
                                                        {"--max-path", "2"},
                                                        {"--max-time", "9"}}) {
    ExpectRefused(input.scratch, With(by_policy, {option, value}), {option + " has no use here"});
  }
  ExpectRefused(input.scratch, With(by_policy, {"--executed", "1"}), {"nothing is left to plan"});
  const Arguments by_method = {"plan", "--rig", input.rig, "--method", "fisher"};
  ExpectRefused(input.scratch, With(by_method, {"--believed", "3"}),
                {"--believed has no use here", "--rigs"});
  ExpectRefused(input.scratch, With(by_method, {"--executed", "1"}),
                {"--executed has no use here", "--policy"});
}

// The loop that was executed stays, the others are designed anew within the motion's own path.
TEST(Plan, PlansTheRestOfAPolicysMotionAnew) {
  const SimulationInput input;
  const std::string first = input.scratch.Path("policy/motion.yaml");
  (void)input.scratch.MakeFolder("policy");
  const Ended planned =
      RunProgram({"plan", "--rig", input.rig, "--method", "random-shooting", "--task", "extrinsic",
                  "--evaluations", "30", "--json", "--out", first});
  ASSERT_EQ(planned.exit_code, 0) << planned.err;
  const std::string again = input.scratch.Path("again.yaml");
  const Ended ended =
      RunProgram({"plan", "--rig", input.rig, "--policy", input.scratch.Path("policy"), "--task",
                  "extrinsic", "--executed", "1", "--evaluations", "60", "--json", "--out", again});
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  const auto loops = [](const std::string& path) { return ReadYaml(path).At("loops").elements(); };
  ASSERT_EQ(loops(again).size(), loops(first).size());
  EXPECT_EQ(ToJsonLine(loops(again)[0].At("coefficients")),
            ToJsonLine(loops(first)[0].At("coefficients")));
  EXPECT_NE(ToJsonLine(loops(again)[1].At("coefficients")),
            ToJsonLine(loops(first)[1].At("coefficients")));
  const Value before = ParseJson(planned.out, "stdout");
  const Value after = ParseJson(ended.out, "stdout");
  EXPECT_LE(after.At("path_length_m").AsDouble(), before.At("path_length_m").AsDouble() * 1.001);
  EXPECT_LT(after.At("expected").At("rotation_sigma_rad").AsDouble(),
            before.At("expected").At("rotation_sigma_rad").AsDouble());
}

TEST(Plan, RefusesWhatItCannotPlan) {
  const SimulationInput input;
  const Arguments plan = {"plan", "--rig", input.rig};
  ExpectRefused(input.scratch, plan, {"--method", "--policy"});
  ExpectRefused(input.scratch, With(plan, {"--method", "guess"}), {"guess"});
  ExpectRefused(input.scratch, With(plan, {"--method", "sac"}), {"sac", "--policy"});
  ExpectRefused(input.scratch, With(plan, {"--policy", input.scratch.MakeFolder("empty")}),
                {"no policy", "empty"});
  ExpectRefused(input.scratch, With(plan, {"--method", "fisher", "--max-path", "-1"}),
                {"--max-path"});
}

TEST(Plan, WritesAMotionThatFits) {
  const SimulationInput input;
  const std::string motion = input.scratch.Path("planned.yaml");
  const Arguments plan = {"plan",   "--rig",     input.rig,       "--method", "random-shooting",
                          "--task", "extrinsic", "--evaluations", "30",       "--out",
                          motion};
  const Ended ended = RunProgram(With(plan, {"--json"}));
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  const Value result = ParseJson(ended.out, "stdout");
  EXPECT_EQ(result.At("kind").AsString(), "plan");
  EXPECT_EQ(result.At("information_evaluations").AsInt(), 30);
  // At most the handcrafted motion's path.
  EXPECT_LE(result.At("path_length_m").AsDouble(), 3.3790);
  EXPECT_GT(result.At("expected").At("rotation_sigma_rad").AsPositive(), 0.0);
  // Simulated as it is, without scaling.
  EXPECT_EQ(RunProgram({"simulate", "--rig", input.rig, "--motion", motion, "--out",
                        input.scratch.Path("of_plan")})
                .exit_code,
            0);
  // Not written over.
  EXPECT_EQ(RunProgram(plan).exit_code, 2);
}

TEST(Learn, NamesRigsThatAreNotThere) {
  const ScratchFolder scratch;
  ExpectRefused(scratch, {"learn", "intrinsic", "--rigs", "nowhere.yaml"}, {"nowhere.yaml"});
}

TEST(Evaluate, RefusesAFolderWithoutAPolicy) {
  const ScratchFolder scratch;
  ExpectRefused(scratch,
                {"evaluate", "table1", "--num-rigs", "2", "--policy", scratch.MakeFolder("empty")},
                {"no policy", "empty", "calibrato learn"});
}

TEST(Report, RefusesAnEmptyFolderAndWritesNothingThere) {
  const ScratchFolder scratch;
  const std::string empty = scratch.MakeFolder("empty");
  ExpectOneErrorLine(RunProgram({"report", empty}), {"nothing to report", "empty", "result.json"});
  EXPECT_TRUE(FilesBelow(empty).empty());
}

// What works --------------------------------------------------------------------------------------

TEST(CommandLine, HelpOfEveryCommandNamesItsOptions) {
  const std::vector<std::pair<Arguments, std::vector<std::string>>> commands = {
      {{}, {"--version", "calibrate", "simulate", "learn", "evaluate", "report"}},
      {{"calibrate"}, {"camera", "camera-imu"}},
      {{"calibrate", "camera"},
       {"recording", "--target", "--images", "--model", "--resolution", "--fix", "--select",
        "--out"}},
      {{"calibrate", "camera-imu"},
       {"recording", "--target", "--cameras", "--camera-result", "--imu", "--imu-model",
        "--estimate-noise", "--joint-intrinsics", "--max-iterations", "--gravity", "--out"}},
      {{"simulate"},
       {"--rig", "--motion", "--carrier", "--timing", "--fidelity", "--effects", "--scale-to-fit",
        "--video", "--out"}},
      {{"export"},
       {"what", "--format", "--rig", "--timing", "--scale-to-fit", "--camera-rate", "--out"}},
      {{"learn"},
       {"task", "--preset", "--carrier", "--fidelity", "--rigs", "--reward", "--criterion",
        "--information-weight", "--mistakes", "--planner", "--evaluations", "--round", "--episodes",
        "--live", "--resume", "--out"}},
      {{"evaluate"},
       {"table1", "table6", "figure4", "figure5", "figure7", "pareto", "rivals", "rows", "planners",
        "ablation", "all"}},
      {{"evaluate", "planners"}, {"--budgets", "--repetitions", "--believed", "--max-path"}},
      {{"evaluate", "ablation"}, {"--episodes", "--variants"}},
      {{"plan"}, {"--rig", "--policy", "--method", "--task", "--executed", "--evaluations"}},
      {{"evaluate", "table1"},
       {"--task", "--policy", "--motion", "--trajectory", "--carrier", "--fidelity", "--rigs",
        "--rig-file", "--num-rigs", "--quick", "--out"}},
      {{"evaluate", "rivals"}, {"--outside", "--policy", "--out"}},
      {{"diff"}, {"first", "second", "--level", "--out"}},
      {{"merge"}, {"folders", "--out"}},
      {{"report"}, {"folder"}}};
  for (const auto& [command, names] : commands) {
    SCOPED_TRACE(InWords(command));
    const Ended ended = RunProgram(With(command, {"--help"}));
    EXPECT_EQ(ended.exit_code, 0);
    EXPECT_EQ(ended.err, "");
    for (const std::string& name : names)
      EXPECT_PRED_FORMAT2(testing::IsSubstring, name, ended.out);
    const bool is_group = ended.out.find("SUBCOMMAND") != std::string::npos;
    if (is_group) continue;
    for (const char* name : {"--seed", "--threads", "--json", "--quiet", "--force"}) {
      EXPECT_PRED_FORMAT2(testing::IsSubstring, name, ended.out);
    }
  }
}

// Parses strictly: anything before, between or after the document is an error.
void ExpectJson(const Arguments& arguments, const std::string& kind) {
  SCOPED_TRACE(InWords(arguments));
  const Ended ended = RunProgram(With(arguments, {"--json"}));
  EXPECT_LE(ended.exit_code, 1);
  EXPECT_GE(ended.exit_code, 0);
  try {
    EXPECT_EQ(ParseJson(ended.out, "stdout").At("kind").AsString(), kind);
  } catch (const std::exception& error) {
    ADD_FAILURE() << error.what() << "\n" << ended.out;
  }
}

TEST(CommandLine, JsonIsAllThatIsOnStdout) {
  const SimulationInput input;
  const auto out = [&](const std::string& name) { return input.scratch.Path(name); };
  ExpectJson(With(input.Simulate(), {"--out", out("recording")}), "simulation");
  ExpectJson({"calibrate", "camera", out("recording"), "--out", out("camera")}, "camera");
  ExpectJson(
      {"evaluate", "table1", "--task", "intrinsic", "--num-rigs", "2", "--out", out("table")},
      "table1");
  ExpectJson(
      {"learn", "intrinsic", "--preset", "paper", "--episodes", "2", "--out", out("learned")},
      "learn");
  ExpectJson({"learn", "joint", "--preset", "paper", "--episodes", "2", "--round", "2", "--out",
              out("joint")},
             "learn");
  ExpectJson({"report", out("table")}, "report");
}

TEST(CommandLine, JsonIsTheResultThatIsWritten) {
  const SimulationInput input;
  const std::string out = input.scratch.Path("camera");
  const Ended ended = RunProgram({"calibrate", "camera", input.Record(), "--json", "--out", out});
  EXPECT_NE(ended.out, "");
  EXPECT_EQ(ended.out, ContentOf(out + "/result.json"));
}

TEST(CommandLine, QuietSaysNothing) {
  const SimulationInput input;
  const std::string out = input.scratch.Path("out");
  const Ended ended = RunProgram(With(input.Simulate(), {"--quiet", "--out", out}));
  EXPECT_EQ(ended.exit_code, 0);
  EXPECT_EQ(ended.out + ended.err, "");
  EXPECT_TRUE(std::filesystem::exists(out + "/cam0_corners.csv"));
}

}  // namespace
}  // namespace calibrato
