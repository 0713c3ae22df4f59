#include "calibrato/base/file_failure.h"

#include <cerrno>
#include <system_error>

#include "calibrato/base/input_error.h"

namespace calibrato {
namespace {

struct Explanation {
  std::string why;
  std::string remedy;
};

Explanation Explain(int error) {
  switch (error) {
    case ENOSPC:
      return {"the disk is full", "free some space or choose another disk"};
    case EDQUOT:
      return {"your share of the disk is used up", "free some space or choose another disk"};
    case EFBIG:
      return {"the file would exceed the size limit", "raise the limit with 'ulimit -f'"};
    case EACCES:
    case EPERM:
      return {"no permission", "choose another path or change its permissions"};
    case EROFS:
      return {"the file system is read-only", "choose a path that can be written"};
    case ENOENT:
      return {"no such file or folder", "check the spelling of the path"};
    case ENOTDIR:
      return {"a part of the path is a file, not a folder", "check the spelling of the path"};
    case EISDIR:
      return {"it is a folder", "name a file"};
    case ENAMETOOLONG:
      return {"the name is too long", "choose a shorter one"};
    case ELOOP:
      return {"its symbolic links lead in a circle", "mend the links"};
    case EMFILE:
    case ENFILE:
      return {"too many files are open", "raise the limit with 'ulimit -n'"};
    case EIO:
      return {"the disk reports an error", "copy the data to another disk"};
    default:
      return {std::generic_category().message(error), "choose another path"};
  }
}

}  // namespace

void FailFile(const std::string& what, const std::string& path, int error) {
  const Explanation explanation = Explain(error);
  throw InputError({what, path, explanation.why, explanation.remedy});
}

}  // namespace calibrato
