#include "calibrato/mdp/original_mistakes.h"

#include <optional>

#include "calibrato/base/input_error.h"
#include "calibrato/base/nearest_name.h"

namespace calibrato {
namespace {

// In the order of the enum.
const std::vector<std::string>& Names() {
  static const std::vector<std::string> names = {
      "constant-accuracy",      "carried-coverage", "lost-coverage",    "duration-entropy",
      "conditional-covariance", "swapped-noise",    "wrong-truth",      "silent-refusals",
      "frozen-swarm",           "masked-histories", "tests-remembered", "last-test"};
  return names;
}

Mistake MistakeFromName(const std::string& name) {
  const std::vector<std::string>& names = Names();
  std::string list;
  for (size_t i = 0; i < names.size(); ++i) {
    if (names[i] == name) return static_cast<Mistake>(i);
    list += (i == 0 ? "" : ", ") + names[i];
  }
  const std::optional<std::string> nearest = NearestName(name, names);
  throw InputError({"unknown mistake '" + name + "'", "", "there are " + list,
                    nearest ? "did you mean " + *nearest + "?" : "choose among them, or all"});
}

}  // namespace

std::string MistakeName(Mistake mistake) { return Names()[static_cast<size_t>(mistake)]; }

std::vector<std::string> MistakeNames() { return Names(); }

Mistakes MistakesFromNames(std::string_view names) {
  Mistakes mistakes;
  if (names == "all") {
    for (size_t i = 0; i < Names().size(); ++i) mistakes.insert(static_cast<Mistake>(i));
    return mistakes;
  }
  while (!names.empty()) {
    const size_t comma = names.find(',');
    mistakes.insert(MistakeFromName(std::string(names.substr(0, comma))));
    names = comma == std::string_view::npos ? std::string_view() : names.substr(comma + 1);
  }
  return mistakes;
}

std::string NamesOf(const Mistakes& mistakes) {
  if (mistakes.empty()) return "none";
  std::string names;
  for (const Mistake mistake : mistakes) names += (names.empty() ? "" : ",") + MistakeName(mistake);
  return names;
}

}  // namespace calibrato
