// Ranks that are processes started by mpirun or srun. The only user of MPI is mpi_ranks.cpp.
#pragma once

#include <memory>

#include "jobs/ranks/ranks.h"

namespace skerry {

/// Starts MPI in this process, once in its life. The processes that the launcher has started are the ranks. Destroying
/// the object waits for all ranks and ends MPI. Throws std::runtime_error if the MPI library cannot be called by
/// threads in turn.
std::unique_ptr<Ranks> start_mpi();

}  // namespace skerry
