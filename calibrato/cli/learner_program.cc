// Commands that need libtorch, whose loading alone takes half a second, belong to a program of
// their own beside this one. Asked for one of them, this process becomes that program: same process
// id, same words, so that signals, exit codes and mpirun notice nothing.

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "calibrato/base/input_error.h"
#include "calibrato/cli/command.h"

namespace calibrato {
namespace {

[[noreturn]] void BecomeLearner(char** words) {
  const auto program =
      std::filesystem::read_symlink("/proc/self/exe").replace_filename("calibrato-learner");
  execv(program.c_str(), words);
  throw InputError({std::string("cannot be run: ") + std::strerror(errno), program.string(), "",
                    "install calibrato anew, with all its programs"});
}

// As soon as the command's word is read: its help and its options are the other program's.
Action HandOver(CLI::App& app, const GlobalOptions& global) {
  app.preparse_callback([&global](size_t) { BecomeLearner(global.words); });
  return {};  // Nobody comes back to call it.
}

}  // namespace

Action SetUpLearn(CLI::App& app, const GlobalOptions& global) { return HandOver(app, global); }
Action SetUpPlan(CLI::App& app, const GlobalOptions& global) { return HandOver(app, global); }
Action SetUpEvaluateAblation(CLI::App& app, const GlobalOptions& global) {
  return HandOver(app, global);
}
Action SetUpEvaluatePlanners(CLI::App& app, const GlobalOptions& global) {
  return HandOver(app, global);
}

}  // namespace calibrato
