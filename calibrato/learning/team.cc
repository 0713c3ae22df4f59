#include "calibrato/learning/team.h"

#include <algorithm>
#include <utility>

#include "calibrato/base/input_error.h"
#include "calibrato/base/parallel.h"
#include "calibrato/base/rng.h"
#include "calibrato/learning/byte_stream.h"

namespace calibrato {

bool IsMine(const Team& team, size_t index) {
  return index % static_cast<size_t>(team.size()) == static_cast<size_t>(team.rank());
}

std::vector<std::string> MapOver(Team& team, size_t n,
                                 const std::function<std::string(size_t)>& function) {
  const auto size = static_cast<size_t>(team.size());
  std::vector<size_t> indices;
  for (size_t i = static_cast<size_t>(team.rank()); i < n; i += size) indices.push_back(i);
  std::vector<std::string> mine =
      ParallelMap<std::string>(indices.size(), [&](size_t k) { return function(indices[k]); });
  if (size == 1) return mine;
  ByteWriter writer;
  for (const std::string& bytes : mine) writer.Write(std::string_view(bytes));
  const std::vector<std::string> of_ranks = team.Exchange(writer.bytes());
  std::vector<std::string> all(n);
  for (size_t rank = 0; rank < size; ++rank) {
    ByteReader reader(of_ranks[rank], "what process " + std::to_string(rank) + " sent");
    for (size_t i = rank; i < n; i += size) all[i] = reader.ReadText();
    reader.ExpectEnd();
  }
  return all;
}

std::string OfTheFirst(Team& team, const std::function<std::string()>& of_the_first) {
  return std::move(team.Exchange(team.is_first() ? of_the_first() : "").front());
}

bool AnyOf(Team& team, bool mine) {
  if (team.size() == 1) return mine;
  const std::vector<std::string> all = team.Exchange(mine ? "yes" : "no");
  return std::find(all.begin(), all.end(), "yes") != all.end();
}

void ExpectAlike(Team& team, std::string_view mine) {
  if (team.size() == 1) return;
  const std::vector<std::string> digests =
      team.Exchange(std::to_string(Rng(0).Stream(mine).NextBits()));
  for (size_t rank = 1; rank < digests.size(); ++rank) {
    if (digests[rank] == digests.front()) continue;
    throw InputError({"the processes do not learn the same",
                      "process " + std::to_string(rank) + " and the first",
                      "their processors or their programs differ",
                      "start all of them on machines of one kind, then continue with --resume"});
  }
}

}  // namespace calibrato
