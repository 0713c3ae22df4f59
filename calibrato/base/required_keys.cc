#include "calibrato/base/required_keys.h"

#include <algorithm>
#include <optional>

#include "calibrato/base/nearest_name.h"
#include "calibrato/base/scalar_text.h"

namespace calibrato {
namespace {

bool Holds(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace

std::vector<std::string> KeysOf(const Value& value) {
  std::vector<std::string> keys;
  if (value.IsNull()) return keys;
  for (const auto& [key, member] : value.members()) keys.push_back(key);
  return keys;
}

std::string KeysInWords(const Value& value) {
  constexpr size_t kMaxKeys = 12;
  const std::vector<std::string> keys = KeysOf(value);
  std::string list;
  for (size_t i = 0; i < std::min(keys.size(), kMaxKeys); ++i) {
    if (i > 0) list += ", ";
    list += ShortenText(keys[i]);
  }
  return keys.size() > kMaxKeys ? list + ", ..." : list;
}

void RequireKeys(const Value& value, const std::vector<std::string>& keys) {
  const std::vector<std::string> present = KeysOf(value);
  std::vector<std::string> candidates = present;
  std::erase_if(candidates, [&](const std::string& key) { return Holds(keys, key); });
  for (const std::string& key : keys) {
    if (!Holds(present, key)) FailMissingKey(value, key, candidates);
  }
}

void FailMissingKey(const Value& value, const std::string& key,
                    const std::vector<std::string>& candidates) {
  const std::optional<std::string> nearest = NearestName(key, candidates);
  value.Fail(
      "missing key " + key,
      value.size() == 0 ? "there are no keys here" : "the keys here are " + KeysInWords(value),
      nearest ? "did you mean " + key + " where " + *nearest + " stands?"
              : "add '" + key + ": ...'");
}

}  // namespace calibrato
