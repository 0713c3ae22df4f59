#pragma once

#include <string>
#include <vector>

#include "calibrato/base/value.h"

namespace calibrato {

/// That all of these keys stand in an object, before they are asked for one by one.
/// @throws InputError for the first that is missing, in the words of Value::At; but none of the
/// others is taken for it misspelt. Where targetCols is missing, targetRows is where it belongs.
void RequireKeys(const Value& value, const std::vector<std::string>& keys);

/// The keys of an object, in the order of its file; none of a null.
[[nodiscard]] std::vector<std::string> KeysOf(const Value& value);

/// "a, b, c", the first dozen of them.
[[nodiscard]] std::string KeysInWords(const Value& value);

/// @param candidates  Keys of the object that may be the missing one, misspelt.
/// @throws InputError "missing key ..", always.
[[noreturn]] void FailMissingKey(const Value& value, const std::string& key,
                                 const std::vector<std::string>& candidates);

}  // namespace calibrato
