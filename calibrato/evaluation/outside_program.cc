#include "calibrato/evaluation/outside_program.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <system_error>
#include <thread>

#include "calibrato/base/input_error.h"
#include "calibrato/base/value.h"

namespace calibrato {
namespace {

using Clock = std::chrono::steady_clock;

double SecondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// The child's process, in a group of its own so that its children end with it; nothing if there is
// no such program.
pid_t Spawn(const std::vector<std::string>& words, const std::string& folder) {
  std::vector<char*> argv;
  for (const std::string& word : words) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  const std::string output = folder + "/output.txt";
  constexpr int kOnlyMine = 0600;
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, output.c_str(),
                                   O_WRONLY | O_CREAT | O_TRUNC, kOnlyMine);
  posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  posix_spawnattr_setpgroup(&attributes, 0);
  pid_t pid = -1;
  const int error = posix_spawnp(&pid, argv[0], &actions, &attributes, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  return error == 0 ? pid : -1;
}

}  // namespace

ProgramEnd RunOutsideProgram(const std::vector<std::string>& words, const std::string& folder,
                             double limit_s) {
  const Clock::time_point start = Clock::now();
  ProgramEnd end;
  const pid_t pid = words.empty() ? -1 : Spawn(words, folder);
  if (pid < 0) {
    end.why = "cannot be started";
    return end;
  }
  int status = 0;
  while (true) {
    const pid_t ended = waitpid(pid, &status, WNOHANG);
    if (ended == pid) break;
    if (ended < 0 && errno != EINTR) {
      end.why = "lost";
      return end;
    }
    if (SecondsSince(start) > limit_s) {
      kill(-pid, SIGKILL);
      waitpid(pid, &status, 0);
      end.seconds = SecondsSince(start);
      end.why = "no end after " + FormatNumber(limit_s) + " s";
      return end;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  end.seconds = SecondsSince(start);
  if (WIFSIGNALED(status)) {
    end.why = "killed by signal " + std::to_string(WTERMSIG(status));
  } else if (WEXITSTATUS(status) != 0) {
    end.why = "exit code " + std::to_string(WEXITSTATUS(status));
  } else {
    end.is_success = true;
  }
  return end;
}

ProgramFolder::ProgramFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "calibrato-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) {
    throw InputError(
        {"cannot make a temporary folder", name, "", "set TMPDIR to a folder that can be written"});
  }
  path_ = name;
}

ProgramFolder::~ProgramFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace calibrato
