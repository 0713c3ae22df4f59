#pragma once

#include <string>

#include "calibrato/base/input_error.h"

namespace calibrato {

/// For tests: the message of the InputError that `call` throws; "" if it throws none.
template <typename Call>
std::string InputErrorOf(const Call& call) {
  try {
    call();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace calibrato
