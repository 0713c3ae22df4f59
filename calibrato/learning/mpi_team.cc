#include "calibrato/learning/mpi_team.h"

#ifdef CALIBRATO_HAS_MPI
#include <mpi.h>

#include <exception>
#include <limits>
#include <numeric>
#endif

#include <cstdlib>

#include "calibrato/base/input_error.h"

namespace calibrato {
namespace {

// MPI takes a tenth of a second to start, and opens sockets: not for those who do not use it.
bool IsStartedByMpirun() {
  return std::getenv("OMPI_COMM_WORLD_SIZE") != nullptr || std::getenv("PMI_SIZE") != nullptr ||
         std::getenv("PMIX_RANK") != nullptr;
}

#ifdef CALIBRATO_HAS_MPI
class MpiTeam final : public Team {
 public:
  // Errors of MPI end all processes, its default.
  MpiTeam() {
    // Other threads calculate; this one alone talks.
    int provided = 0;
    MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    MPI_Comm_size(MPI_COMM_WORLD, &size_);
  }
  // Taking MPI down waits for all: not while an error ends this one.
  ~MpiTeam() override {
    if (std::uncaught_exceptions() == 0) MPI_Finalize();
  }
  MpiTeam(const MpiTeam&) = delete;
  MpiTeam& operator=(const MpiTeam&) = delete;

  [[nodiscard]] int rank() const override { return rank_; }
  [[nodiscard]] int size() const override { return size_; }

  [[nodiscard]] std::vector<std::string> Exchange(const std::string& mine) override {
    // MPI counts in int.
    if (mine.size() > kMost / static_cast<size_t>(size_)) {
      throw InputError({"too much to exchange between processes",
                        std::to_string(mine.size()) + " bytes", "", "use fewer processes"});
    }
    const int count = static_cast<int>(mine.size());
    std::vector<int> counts(static_cast<size_t>(size_));
    MPI_Allgather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, MPI_COMM_WORLD);
    std::vector<int> offsets(counts.size());
    std::exclusive_scan(counts.begin(), counts.end(), offsets.begin(), 0);
    std::string all(static_cast<size_t>(offsets.back() + counts.back()), '\0');
    MPI_Allgatherv(mine.data(), count, MPI_BYTE, all.data(), counts.data(), offsets.data(),
                   MPI_BYTE, MPI_COMM_WORLD);
    std::vector<std::string> parts;
    for (size_t rank = 0; rank < counts.size(); ++rank) {
      parts.push_back(
          all.substr(static_cast<size_t>(offsets[rank]), static_cast<size_t>(counts[rank])));
    }
    return parts;
  }

 private:
  static constexpr size_t kMost = std::numeric_limits<int>::max();
  int rank_ = 0;
  int size_ = 1;
};
#endif

}  // namespace

std::unique_ptr<Team> MakeMpiTeam() {
  if (!IsStartedByMpirun()) return std::make_unique<Alone>();
#ifdef CALIBRATO_HAS_MPI
  return std::make_unique<MpiTeam>();
#else
  throw InputError({"cannot learn under mpirun", "", "calibrato was built without MPI",
                    "install libopenmpi-dev and build again, or start it without mpirun"});
#endif
}

}  // namespace calibrato
