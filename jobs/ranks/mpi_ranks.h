// Ranks that are processes started by mpirun or srun. The only user of MPI is mpi_ranks.cpp.
#pragma once

#include <atomic>
#include <memory>

#include "jobs/ranks/ranks.h"

namespace skerry {

/// Starts MPI in this process, which is possible once. The processes that the launcher has started are the ranks.
/// Destroying the object waits for all ranks and ends MPI. If `exit_message` is given and points to a text, the first
/// call of Ranks::abort also prints this text. Throws std::runtime_error if MPI does not offer the thread level
/// MPI_THREAD_SERIALIZED.
std::unique_ptr<Ranks> start_mpi(std::atomic<const char*>* exit_message = nullptr);

/// Returns the processes of a communicator as ranks. `communicator`: its number, as MPI_Comm_c2f returns it. Throws
/// std::runtime_error if MPI runs with a thread level below MPI_THREAD_SERIALIZED.
std::unique_ptr<Ranks> join_mpi(int communicator);

}  // namespace skerry
