#pragma once

#include <string>

namespace calibrato {

/// @throws InputError: `what` at `path`, why the operating system says so, and what to try.
/// @param error  An errno.
[[noreturn]] void FailFile(const std::string& what, const std::string& path, int error);

}  // namespace calibrato
