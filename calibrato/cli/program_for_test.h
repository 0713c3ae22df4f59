#pragma once

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace calibrato {

/// A folder of its own for one test, gone with it.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "calibrato-cli-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no scratch folder: " + name);
    path_ = name;
  }
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  [[nodiscard]] std::string Path(const std::string& name) const { return (path_ / name).string(); }

  /// Writes a file, and the folders above it. Returns its path.
  [[nodiscard]] std::string Write(const std::string& name, const std::string& content) const {
    const std::filesystem::path path = path_ / name;
    std::filesystem::create_directories(path.parent_path());
    std::ofstream file(path, std::ios::binary);
    file << content << std::flush;
    if (!file) throw std::runtime_error("cannot write " + path.string());
    return path.string();
  }

  /// Makes an empty folder. Returns its path.
  [[nodiscard]] std::string MakeFolder(const std::string& name) const {
    std::filesystem::create_directories(path_ / name);
    return Path(name);
  }

 private:
  std::filesystem::path path_;
};

inline std::string ContentOf(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream content;
  content << file.rdbuf();
  return content.str();
}

/// Every file below a folder: name relative to it -> content.
inline std::map<std::string, std::string> FilesBelow(const std::string& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    files[entry.path().lexically_relative(folder).string()] = ContentOf(entry.path());
  }
  return files;
}

/// How a run of the program came to its end.
struct Ended {
  int exit_code = -1;  ///< -1 if a signal ended it.
  int signal = 0;      ///< Which one; 0 if none.
  std::string out;     ///< What it wrote to stdout ...
  std::string err;     ///< ... and to stderr.
};

using Arguments = std::vector<std::string>;

/// A child process that runs calibrato, with stdout and stderr caught in files.
class RunningProgram {
 public:
  /// @param max_file_bytes  No file may become larger, as on a disk that is full; the write that
  /// goes beyond it fails.
  /// @param launcher  A command that starts it, with its own options: mpirun -n 2.
  explicit RunningProgram(const Arguments& arguments,
                          std::optional<rlim_t> max_file_bytes = std::nullopt,
                          const Arguments& launcher = {}) {
    std::vector<std::string> words = launcher;
    words.emplace_back(CALIBRATO_PROGRAM);
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    argv.reserve(words.size() + 1);
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    const std::string out = caught_.Path("stdout");
    const std::string err = caught_.Path("stderr");
    pid_ = fork();
    if (pid_ < 0) throw std::runtime_error("cannot fork");
    if (pid_ > 0) return;
    // The child: only calls that are safe between fork and exec.
    constexpr int kOnlyMine = 0600;
    constexpr int kFlags = O_WRONLY | O_CREAT | O_TRUNC;
    const bool is_caught = dup2(open("/dev/null", O_RDONLY), STDIN_FILENO) >= 0 &&
                           dup2(open(out.c_str(), kFlags, kOnlyMine), STDOUT_FILENO) >= 0 &&
                           dup2(open(err.c_str(), kFlags, kOnlyMine), STDERR_FILENO) >= 0;
    if (max_file_bytes) {
      signal(SIGXFSZ, SIG_IGN);
      const rlimit limit{*max_file_bytes, *max_file_bytes};
      if (setrlimit(RLIMIT_FSIZE, &limit) != 0) _exit(kNotStarted);
    }
    if (is_caught) execvp(argv[0], argv.data());
    _exit(kNotStarted);
  }
  ~RunningProgram() {
    if (pid_ <= 0) return;
    kill(pid_, SIGKILL);
    (void)WaitForStatus();
  }
  RunningProgram(const RunningProgram&) = delete;
  RunningProgram& operator=(const RunningProgram&) = delete;

  void Signal(int signal) const { kill(pid_, signal); }

  /// The processes that it started itself, as a launcher does.
  [[nodiscard]] std::vector<pid_t> Children() const {
    const std::string pid = std::to_string(pid_);
    std::istringstream listed(ContentOf("/proc/" + pid + "/task/" + pid + "/children"));
    std::vector<pid_t> children;
    for (pid_t child = 0; listed >> child;) children.push_back(child);
    return children;
  }

  [[nodiscard]] bool IsRunning() const {
    siginfo_t info{};
    return waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED | WNOHANG | WNOWAIT) == 0 &&
           info.si_pid == 0;
  }

  /// Waits for its end.
  Ended Wait() {
    const int status = WaitForStatus();
    Ended ended;
    if (WIFEXITED(status)) ended.exit_code = WEXITSTATUS(status);
    if (WIFSIGNALED(status)) ended.signal = WTERMSIG(status);
    ended.out = ContentOf(caught_.Path("stdout"));
    ended.err = ContentOf(caught_.Path("stderr"));
    return ended;
  }

 private:
  static constexpr int kNotStarted = 127;

  int WaitForStatus() {
    int status = 0;
    while (waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
    }
    pid_ = -1;
    return status;
  }

  ScratchFolder caught_;
  pid_t pid_ = -1;
};

inline Ended RunProgram(const Arguments& arguments,
                        std::optional<rlim_t> max_file_bytes = std::nullopt) {
  return RunningProgram(arguments, max_file_bytes).Wait();
}

/// A rig whose camera sees its board well from the base pose of SmallMotion().
inline std::string RigYaml() {
  return R"(cameras:
  cam0:
    camera_model: pinhole
    intrinsics: [585.756, 585.756, 320.5, 240.5]
    distortion_model: radtan5
    distortion_coeffs: [-0.05, 0.02, 0, 0, 0]
    resolution: [640, 480]
imu:
  update_rate: 200
  accelerometer_noise_density: 2.83e-4
  accelerometer_random_walk: 1.41e-4
  gyroscope_noise_density: 2.40e-5
  gyroscope_random_walk: 9.1e-7
  T_cam_imu:
    - [0, -1, 0, 0.06]
    - [1, 0, 0, 0]
    - [0, 0, 1, -0.1]
    - [0, 0, 0, 1]
board:
  target_type: checkerboard
  targetCols: 7
  targetRows: 6
  rowSpacingMeters: 0.06
  colSpacingMeters: 0.06
  T_w_g:
    - [0, 0, 1, -2.0]
    - [1, 0, 0, -0.5]
    - [0, 1, 0, 0.32]
    - [0, 0, 0, 1]
T_e_c0:
  - [-0.70710678, 0.70710678, 0, 0.0212132]
  - [-0.70710678, -0.70710678, 0, 0.0212132]
  - [0, 0, 1, 0.1584]
  - [0, 0, 0, 1]
)";
}

/// One loop; `way_m` is the coefficient of cos(2 theta) in x [m]: 0.1 fits the free carrier, 1 is
/// out of its reach.
inline std::string MotionYaml(double way_m) {
  std::ostringstream text;
  text << R"(carrier: free
base_pose:
  xyz_m: [0.4, 0.3, 0.47]
  rpy_rad: [1.5708, 0.8, 1.5708]
loops:
  - duration_s: 5.0
    coefficients: [0, 0, )"
       << way_m << R"(, 0, 0, 0,
                   0, 0, 0, 0, 0, 0,
                   0, 0.1, 0, 0, 0, 0,
                   0, -0.25, 0, 0, 0, 0,
                   0, 0, 0, 0, 0, 0,
                   0, 0, 0, 0, 0, 0]
)";
  return text.str();
}

}  // namespace calibrato
