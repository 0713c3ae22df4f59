// calibrato plan from a photo of the board, as its users run it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <regex>
#include <string>
#include <vector>

#include "calibrato/base/value.h"
#include "calibrato/cli/program_for_test.h"

namespace calibrato {
namespace {

using testing::HasSubstr;

// What the camera of RigYaml() sees from the start pose; empty where nothing can be rendered.
std::string PhotoFromTheStartPose(const ScratchFolder& scratch) {
  const std::string rig = scratch.Write("truth.yaml", RigYaml());
  std::string motion = MotionYaml(0.01);
  motion.replace(motion.find("5.0"), 3, "0.2");
  const Ended ended =
      RunProgram({"simulate", "--rig", rig, "--motion", scratch.Write("short.yaml", motion),
                  "--fidelity", "rendered", "--out", scratch.Path("dry-run")});
  if (ended.exit_code != 0) return "";
  std::vector<std::string> images;
  for (const auto& entry : std::filesystem::directory_iterator(scratch.Path("dry-run/cam0/data"))) {
    if (entry.path().extension() == ".png") images.push_back(entry.path().string());
  }
  return *std::ranges::min_element(images);
}

// T_w_g of a rig's file, its twelve numbers.
std::vector<double> BoardPose(const std::string& rig_path) {
  std::vector<double> pose;
  const Value rig = ParseYaml(ContentOf(rig_path), rig_path);
  for (const Value& row : rig.At("board").At("T_w_g").elements()) {
    for (const double number : row.AsDoubles(4)) pose.push_back(number);
  }
  return pose;
}

TEST(PlanCommand, PlansBeforeTheBoardOfAPhoto) {
  const ScratchFolder scratch;
  const std::string photo = PhotoFromTheStartPose(scratch);
  if (photo.empty()) GTEST_SKIP() << "nothing to render with";
  // The file has the board 0.2 m away from where it is.
  std::string elsewhere = RigYaml();
  elsewhere.replace(elsewhere.find("-0.5]"), 4, "-0.3");
  const std::string rig = scratch.Write("rig.yaml", elsewhere);
  const std::string rig_out = scratch.Path("seen.yaml");
  const std::vector<std::string> plan = {
      "plan",      "--rig",         rig, "--method", "best-of-1000", "--photo",
      photo,       "--evaluations", "4", "--json",   "--out",        scratch.Path("motion.yaml"),
      "--rig-out", rig_out};
  const Ended ended = RunProgram(plan);
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  const Value board = ParseJson(ended.out, "stdout").At("board");
  EXPECT_EQ(board.At("num_corners").AsInt(), 42);
  EXPECT_LT(board.At("reprojection_rms_px").AsDouble(), 0.3);
  // The board is 1.47 m away; each figure states its own error.
  EXPECT_GT(board.At("distance_m").AsDouble(), 1.4);
  EXPECT_LT(board.At("distance_m").AsDouble(), 1.55);
  const std::vector<double> seen = BoardPose(rig_out);
  const std::vector<double> truth = BoardPose(scratch.Path("truth.yaml"));
  ASSERT_EQ(seen.size(), 16U);
  const double sigma_m = board.At("translation_sigma_m").AsDouble();
  const double sigma_rad = board.At("rotation_sigma_rad").AsDouble();
  EXPECT_LT(sigma_m, 0.01);
  for (size_t row = 0; row < 3; ++row) {
    for (size_t column = 0; column < 3; ++column) {
      EXPECT_NEAR(seen[4 * row + column], truth[4 * row + column], 4.0 * sigma_rad);
    }
    // The turn moves the origin of the board too, which is not in its middle.
    EXPECT_NEAR(seen[4 * row + 3], truth[4 * row + 3], 4.0 * sigma_m + 0.2 * sigma_rad);
  }
  // A guess of the lens serves as well, if not as well as the lens. From where the photo is taken
  // to be is said.
  std::vector<std::string> guessed = plan;
  std::erase(guessed, "--json");
  guessed.insert(guessed.end(), {"--force", "--hfov", "1.0"});
  const Ended said = RunProgram(guessed);
  EXPECT_EQ(said.exit_code, 0) << said.err;
  EXPECT_THAT(said.out, HasSubstr("photo: from the start pose, the controlled frame at 0.400 0.300 "
                                  "0.470 m, rpy 1.571 0.800 1.571 rad"));
}

TEST(PlanCommand, RefusesPhotosThatDoNotServe) {
  const ScratchFolder scratch;
  const std::string rig = scratch.Write("rig.yaml", RigYaml());
  // Nothing but grey.
  const std::string small =
      scratch.Write("small.pgm", "P5 320 240 255\n" + std::string(76800, '\x80'));
  const std::string grey =
      scratch.Write("grey.pgm", "P5 640 480 255\n" + std::string(307200, '\x80'));
  const std::string out = scratch.Path("motion.yaml");
  const std::vector<std::string> plan = {"plan",     "--rig",     rig,
                                         "--method", "fisher",    "--out",
                                         out,        "--rig-out", scratch.Path("seen.yaml")};
  const auto refused = [&](const std::vector<std::string>& more, const std::string& why) {
    std::vector<std::string> words = plan;
    words.insert(words.end(), more.begin(), more.end());
    const Ended ended = RunProgram(words);
    EXPECT_EQ(ended.exit_code, 2) << why;
    EXPECT_THAT(ended.err, HasSubstr(why));
    EXPECT_EQ(std::ranges::count(ended.err, '\n'), 1) << ended.err;
    EXPECT_FALSE(std::filesystem::exists(out));
    EXPECT_FALSE(std::filesystem::exists(scratch.Path("seen.yaml")));
  };
  refused({"--photo", small}, "the photo is not of this camera");
  refused({"--photo", grey}, "no board found");
  refused({}, "--rig-out has no use here");
  refused({"--photo", grey, "--photo-joints", "0,0,0,1,0,0,0"}, "bad --photo-joints");
  refused({"--photo", grey, "--photo-joints", "0,0,nan,-1,0,1,0"}, "bad --photo-joints");
  refused({"--photo", grey, "--hfov", "1.0", "--cameras", rig}, "say the same thing");
}

TEST(PlanCommand, WritesNothingWhereOneOfItsFilesCannotBe) {
  const ScratchFolder scratch;
  const std::string rig = scratch.Write("rig.yaml", RigYaml());
  const std::string photo =
      scratch.Write("photo.pgm", "P5 640 480 255\n" + std::string(307200, '\x80'));
  const auto before = FilesBelow(scratch.Path(""));
  const auto refused = [&](const std::string& out, const std::string& rig_out,
                           const std::string& why) {
    const Ended ended = RunProgram({"plan", "--rig", rig, "--method", "fisher", "--photo", photo,
                                    "--out", out, "--rig-out", rig_out, "--force"});
    EXPECT_EQ(ended.exit_code, 2) << why;
    EXPECT_THAT(ended.err, HasSubstr(why));
    EXPECT_EQ(std::ranges::count(ended.err, '\n'), 1) << ended.err;
    EXPECT_EQ(FilesBelow(scratch.Path("")), before);
  };
  const std::string out = scratch.Path("motion.yaml");
  refused(out, scratch.Path("./motion.yaml"), "it is that of --out and that of --rig-out");
  refused(rig, scratch.Path("seen.yaml"), "it is that of --rig and that of --out");
  refused(out, photo, "it is that of --photo and that of --rig-out");
  refused(out, scratch.Path("nowhere/seen.yaml"), "cannot write file");
}

TEST(PlanCommand, PlansForAnArmByItsUrdfAndExportsIt) {
  const ScratchFolder scratch;
  const std::string rig = scratch.Write("rig.yaml", RigYaml());
  const std::string arm = std::string(CALIBRATO_EXAMPLES) + "/arms/ur5e.yaml";
  const std::string motion = scratch.Path("motion.yaml");
  const Arguments plan = {"plan",         "--rig",         rig, "--arm",  arm,         "--method",
                          "best-of-1000", "--evaluations", "4", "--task", "extrinsic", "--out",
                          motion};
  const Ended planned = RunProgram(plan);
  ASSERT_EQ(planned.exit_code, 0) << planned.err;
  const std::string out = scratch.Path("trajectory.yaml");
  const std::string page = scratch.Path("dry-run.html");
  Arguments write = {"export", motion, "--rig", rig, "--arm",    arm,
                     "--html", page,   "--out", out, "--format", "moveit"};
  const Ended ended = RunProgram(write);
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  const Value trajectory = ParseYaml(ContentOf(out), out).At("joint_trajectory");
  EXPECT_EQ(trajectory.At("joint_names").elements().front().AsString(), "shoulder_pan_joint");
  EXPECT_EQ(trajectory.At("joint_names").size(), 6U);
  EXPECT_THAT(ContentOf(page), HasSubstr("wrist_3_joint"));
  // A Panda's commands are not for it.
  write.back() = "franka-csv";
  const Ended refused = RunProgram(write);
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, HasSubstr("no franka-csv for the arm UR5e"));
}

// "half the path  1.69 m  49.1 s  ..": its seconds.
double SecondsOf(const std::string& what, const std::string& text) {
  std::smatch found;
  const bool is_said =
      std::regex_search(text, found, std::regex(what + R"( +[0-9.]+ m +([0-9.]+) s)"));
  EXPECT_TRUE(is_said) << what << " in " << text;
  return is_said ? std::stod(found[1]) : 0.0;
}

TEST(PlanCommand, SaysHowLongTheArmTakesForHalfThePath) {
  const ScratchFolder scratch;
  const std::string rig = scratch.Write("rig.yaml", RigYaml());
  const std::string arms = std::string(CALIBRATO_EXAMPLES) + "/arms/";
  std::string slow = ContentOf(arms + "ur5e.yaml");
  slow.replace(slow.find("ur5e.urdf"), 9, arms + "ur5e.urdf");
  slow += "max_velocity_rad_s: [0.1, 0.1, 0.1, 0.1, 0.1, 0.1]\n";
  const Ended ended = RunProgram({"plan", "--rig", rig, "--arm", scratch.Write("slow.yaml", slow),
                                  "--method", "best-of-1000", "--evaluations", "4", "--task",
                                  "extrinsic", "--out", scratch.Path("motion.yaml")});
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  // At the limit of its speed, half the way takes half the time; a hand takes far less.
  const double whole_s = SecondsOf("this motion", ended.out);
  const double half_s = SecondsOf("half the path", ended.out);
  EXPECT_GT(whole_s, 60.0);
  EXPECT_NEAR(half_s / whole_s, 0.5, 0.1);
  EXPECT_NEAR(SecondsOf("twice this motion", ended.out), 2.0 * whole_s, 0.2);
}

}  // namespace
}  // namespace calibrato
