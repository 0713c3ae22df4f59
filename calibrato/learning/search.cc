#include "calibrato/learning/search.h"

#include <array>
#include <utility>

#include "calibrato/base/input_error.h"
#include "calibrato/learning/search_progress.h"

namespace calibrato {
namespace {

constexpr int kRound = 100;

constexpr std::array<std::pair<std::string_view, Search>, 6> kSearches = {{
    {"random-shooting", &SearchByRandomShooting},
    {"pso", &SearchByPlainSwarm},
    {"pso-p", &SearchByPsoP},
    {"cem", &SearchByCem},
    {"icem", &SearchByIcem},
    {"cma-es", &SearchByCmaEs},
}};

}  // namespace

SearchResult SearchByRandomShooting(const SearchObjective& objective, int dimension,
                                    const SearchOptions& options, Rng& rng) {
  SearchProgress progress(objective, options);
  SearchOptions fresh = options;
  while (!progress.done()) {
    const int count = progress.Allowed(kRound);
    (void)progress.Evaluate(SearchProgress(objective, fresh).Start(dimension, count, rng));
    fresh.start.resize(dimension, 0);
  }
  return progress.result();
}

Search SearchFromName(std::string_view name) {
  for (const auto& [known, search] : kSearches) {
    if (known == name) return search;
  }
  std::string all;
  for (const std::string& known : SearchNames()) all += (all.empty() ? "" : ", ") + known;
  throw InputError({"unknown planner '" + std::string(name) + "'", "", "", "use one of " + all});
}

std::vector<std::string> SearchNames() {
  std::vector<std::string> names;
  for (const auto& [name, search] : kSearches) names.emplace_back(name);
  return names;
}

}  // namespace calibrato
