#pragma once

#include <stdexcept>
#include <string>

namespace calibrato {

/// Bad usage or bad input, in the words of the person who can mend it. The command line prints
/// "error: what, where: why; what to try" on one line and exits with 2, having written nothing.
///
/// Of the four forms of failure this is the second. The others: our own bug is an assert; an
/// expected absence (no board in this image) is a std::optional; a solve that did not converge is a
/// `Termination` in its result.
class InputError : public std::runtime_error {
 public:
  struct Parts {
    std::string what;  ///< "cannot read image"
    std::string
        where;        ///< "photos/left03.jpg" or "board.yaml line 3, key targetCols"; may be empty
    std::string why;  ///< "the file is truncated"; may be empty
    std::string remedy;  ///< "copy it again or leave it out with --images"; may be empty
  };
  explicit InputError(const Parts& parts);
};

}  // namespace calibrato
