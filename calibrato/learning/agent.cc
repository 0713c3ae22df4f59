#include "calibrato/learning/agent.h"

#include "calibrato/learning/model_based_agent.h"
#include "calibrato/learning/q_library_agent.h"
#include "calibrato/learning/sac_agent.h"

namespace calibrato {
namespace {

constexpr const char* kQLibrary = "q-library";
constexpr const char* kSac = "sac";

}  // namespace

std::unique_ptr<Agent> MakeAgent(const LearnOptions& options, int observation_size, int horizon,
                                 Rng rng) {
  const std::string& name = options.planning.planner;
  if (name == kQLibrary) return std::make_unique<QLibraryAgent>(options, horizon);
  if (name == kSac) return std::make_unique<SacAgent>(options, observation_size, horizon, rng);
  return std::make_unique<ModelBasedAgent>(options, observation_size, horizon, rng);
}

std::vector<std::string> AgentNames() {
  std::vector<std::string> names = ModelPlannerNames();
  names.insert(names.end(), {kQLibrary, kSac});
  return names;
}

}  // namespace calibrato
