#pragma once

#include <memory>

#include "calibrato/learning/team.h"

namespace calibrato {

/// Those that `mpirun -n N` started (MPI 3, OpenMPI's); this process alone where nobody did. Made
/// once in a process.
///
/// A process that ends without taking it down, by an error or a signal, takes all others with it:
/// mpirun ends them. What is on disk then is the last checkpoint.
///
/// @throws InputError if mpirun started it and it was built without MPI.
[[nodiscard]] std::unique_ptr<Team> MakeMpiTeam();

}  // namespace calibrato
