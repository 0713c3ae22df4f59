#include "calibrato/simulation/headless_gl.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "calibrato/base/files.h"
#include "calibrato/base/input_error.h"
#include "calibrato/motion/paper_scene.h"
#include "calibrato/simulation/arm_scene.h"
#include "calibrato/simulation/scene_view.h"

namespace calibrato {
namespace {

// Runs a test of this program in a process of its own: one process has one way.
int RunInItsOwnProcess(const std::string& environment, const std::string& test,
                       const std::string& output = "/dev/null") {
  const std::string program = std::filesystem::read_symlink("/proc/self/exe");
  return std::system(
      (environment + " '" + program + "' --gtest_filter=" + test + " > '" + output + "' 2>&1")
          .c_str());
}

TEST(HeadlessGl, EveryWayDraws) {
  const std::string test = "SceneView.DepthIsAlongTheAxisInMetres";
  EXPECT_EQ(RunInItsOwnProcess("MUJOCO_GL=egl", test), 0);
  EXPECT_EQ(RunInItsOwnProcess("MUJOCO_GL=osmesa", test), 0);
  EXPECT_NE(RunInItsOwnProcess("MUJOCO_GL=off", test), 0);
}

// In a folder of its own, until it goes.
class Folder {
 public:
  explicit Folder(const std::string& name)
      : path_(std::filesystem::path(testing::TempDir()) / (name + std::to_string(getpid()))) {
    std::filesystem::create_directories(path_);
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

// What the test that draws says of how.
std::string WayIn(const std::string& environment) {
  const Folder folder("way_");
  const std::string said = (folder.path() / "said").string();
  EXPECT_EQ(RunInItsOwnProcess(environment, "SceneView.DepthIsAlongTheAxisInMetres", said), 0);
  const std::string text = ReadFile(said, 1'000'000);
  const std::string before = "drawn by ";
  const size_t at = text.find(before);
  if (at == std::string::npos) return text;
  return text.substr(at + before.size(), text.find('\n', at) - at - before.size());
}

TEST(HeadlessGl, FallsBackToOsMesa) {
  EXPECT_EQ(WayIn("MUJOCO_GL="), "egl");
  // An EGL that finds no driver.
  EXPECT_EQ(WayIn("__EGL_VENDOR_LIBRARY_FILENAMES=/nowhere.json"), "osmesa");
  // None at all: a library of its name that is none, in front of the system's.
  const Folder folder("no_egl_");
  std::ofstream(folder.path() / "libEGL.so.1") << "none";
  EXPECT_EQ(WayIn("LD_LIBRARY_PATH='" + folder.path().string() + "'"), "osmesa");
}

TEST(HeadlessGl, SaysWhatIsMissing) {
  try {
    const HeadlessGl gl(std::vector<std::string>{});
    FAIL();
  } catch (const InputError& error) {
    const std::string what = error.what();
    EXPECT_NE(what.find("libosmesa6"), std::string::npos) << what;
    EXPECT_NE(what.find("--fidelity fast"), std::string::npos) << what;
  }
  EXPECT_THROW(HeadlessGl({"vulkan"}), InputError);
}

// Libraries of these names that are none, in front of those of the system.
TEST(HeadlessGl, WithoutEglAndOsMesaOnlyImagesAreMissing) {
  const Folder folder("no_gl_");
  for (const char* name : {"libEGL.so.1", "libOSMesa.so.8"}) {
    std::ofstream(folder.path() / name) << "none";
  }
  const std::string environment = "LD_LIBRARY_PATH='" + folder.path().string() + "'";
  const std::filesystem::path said = folder.path() / "said";
  EXPECT_NE(RunInItsOwnProcess(environment, "SceneView.DepthIsAlongTheAxisInMetres", said), 0);
  EXPECT_NE(ReadFile(said.string(), 1'000'000)
                .find("libEGL.so.1 is not installed; libOSMesa.so.8 is not installed"),
            std::string::npos)
      << ReadFile(said.string(), 1'000'000);
  EXPECT_EQ(RunInItsOwnProcess(environment, "SimulateRun.ThePhysicalArmComesClose*"), 0);
}

TEST(HeadlessGlWays, FollowTheEnvironment) {
  setenv("MUJOCO_GL", "off", 1);
  EXPECT_TRUE(HeadlessGlWays().empty());
  setenv("MUJOCO_GL", "osmesa", 1);
  EXPECT_EQ(HeadlessGlWays(), std::vector<std::string>({"osmesa"}));
  unsetenv("MUJOCO_GL");
  EXPECT_EQ(HeadlessGlWays(), std::vector<std::string>({"egl", "osmesa"}));
}

// Depth is that of the scene: the camera looks straight at the wall behind the arm, 1.5 m behind
// the base.
TEST(SceneView, DepthIsAlongTheAxisInMetres) {
  const HeadlessGl gl;
  std::printf("drawn by %s\n", gl.way().c_str());
  const ArmScene scene(PaperRig());
  SceneView view(scene, gl);
  Rigid3 T_w_c{Eigen::Matrix3d::Zero(), {-2.0, 0.9, 1.4}};
  T_w_c.R.col(0) = -Eigen::Vector3d::UnitY();
  T_w_c.R.col(1) = -Eigen::Vector3d::UnitZ();
  T_w_c.R.col(2) = Eigen::Vector3d::UnitX();
  const SceneImage image = view.Draw(T_w_c, {{320, 240}, 0.3, 0.225}, std::nullopt);
  for (const size_t k : {size_t{0}, size_t{319}, size_t{320 * 120 + 160}, size_t{320 * 240 - 1}}) {
    EXPECT_NEAR(image.depth[k], 3.5, 0.01);
  }
}

}  // namespace
}  // namespace calibrato
