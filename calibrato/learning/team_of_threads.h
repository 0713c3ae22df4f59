#pragma once

// For tests of the room: a team whose processes are threads of this one.

#include <barrier>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "calibrato/learning/team.h"

namespace calibrato {

/// What each of the ranks returns, all running at once. A rank that throws while others wait for it
/// ends the test program, as it would end the team.
inline std::vector<std::string> RunAsTeam(int size, const std::function<std::string(Team&)>& run) {
  struct Meeting {
    explicit Meeting(int size) : barrier(size), given(static_cast<size_t>(size)) {}
    std::barrier<> barrier;
    std::vector<std::string> given;
  };
  class ThreadTeam final : public Team {
   public:
    ThreadTeam(int rank, int size, Meeting& meeting)
        : rank_(rank), size_(size), meeting_(meeting) {}
    [[nodiscard]] int rank() const override { return rank_; }
    [[nodiscard]] int size() const override { return size_; }
    [[nodiscard]] std::vector<std::string> Exchange(const std::string& mine) override {
      meeting_.given[static_cast<size_t>(rank_)] = mine;
      meeting_.barrier.arrive_and_wait();
      std::vector<std::string> all = meeting_.given;
      meeting_.barrier.arrive_and_wait();  // Nobody gives anew before all have taken.
      return all;
    }

   private:
    int rank_;
    int size_;
    Meeting& meeting_;
  };
  Meeting meeting(size);
  std::vector<std::string> results(static_cast<size_t>(size));
  std::vector<std::thread> ranks;
  for (int rank = 0; rank < size; ++rank) {
    ranks.emplace_back([&, rank] {
      ThreadTeam team(rank, size, meeting);
      results[static_cast<size_t>(rank)] = run(team);
    });
  }
  for (std::thread& rank : ranks) rank.join();
  return results;
}

}  // namespace calibrato
