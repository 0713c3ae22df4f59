#include "calibrato/simulation/fidelity.h"

#include <optional>
#include <vector>

#include "calibrato/base/input_error.h"
#include "calibrato/base/nearest_name.h"

namespace calibrato {
namespace {

// In the order of the enum.
const std::vector<std::string> kNames = {"fast", "physical", "rendered"};

}  // namespace

std::string FidelityName(Fidelity fidelity) { return kNames[static_cast<size_t>(fidelity)]; }

Fidelity FidelityFromName(const std::string& name) {
  for (size_t i = 0; i < kNames.size(); ++i) {
    if (kNames[i] == name) return static_cast<Fidelity>(i);
  }
  const std::optional<std::string> nearest = NearestName(name, kNames);
  throw InputError({"unknown fidelity '" + name + "'", "", "there are fast, physical and rendered",
                    nearest ? "did you mean " + *nearest + "?" : "choose one of them"});
}

}  // namespace calibrato
