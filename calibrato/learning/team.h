#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace calibrato {

/// The processes that learn together. All run the same program with the same options and know the
/// same at all times; only what takes long, episodes and searches, is divided among them, and its
/// results are exchanged. So what is learned does not depend on how many there are, and any one of
/// them could write it down: the first does.
///
/// To add a way for processes to talk: a Team in files of its own beside mpi_team.h.
class Team {
 public:
  virtual ~Team() = default;

  [[nodiscard]] virtual int rank() const = 0;  ///< In [0, size).
  [[nodiscard]] virtual int size() const = 0;  ///< >= 1

  /// Each process gives bytes of its own and gets those of all, in the order of ranks. All have to
  /// call it equally often, and wait for each other there.
  [[nodiscard]] virtual std::vector<std::string> Exchange(const std::string& mine) = 0;

  /// Who writes files and speaks to people.
  [[nodiscard]] bool is_first() const { return rank() == 0; }
};

/// One process by itself.
class Alone final : public Team {
 public:
  [[nodiscard]] int rank() const override { return 0; }
  [[nodiscard]] int size() const override { return 1; }
  [[nodiscard]] std::vector<std::string> Exchange(const std::string& mine) override {
    return {mine};
  }
};

/// Whose turn an index of a divided loop is. The same index is always the same process's, so that
/// what it left there is found again.
[[nodiscard]] bool IsMine(const Team& team, size_t index);

/// function(0), .., function(n - 1), each in one of the processes, on its threads; all get all
/// results, in the order of the index.
[[nodiscard]] std::vector<std::string> MapOver(Team& team, size_t n,
                                               const std::function<std::string(size_t)>& function);

/// What the first process has.
[[nodiscard]] std::string OfTheFirst(Team& team, const std::function<std::string()>& of_the_first);

/// Whether it is so for any of them.
[[nodiscard]] bool AnyOf(Team& team, bool mine);

/// @throws InputError unless all have the same bytes: processors of different kinds, whose last
/// digits differ, can't learn together.
void ExpectAlike(Team& team, std::string_view mine);

}  // namespace calibrato
