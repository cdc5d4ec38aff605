// Division of one world among the processes of an MPI program. Link skerry::mpi.
#pragma once

#include <memory>

#include "skerry/ranks.h"

#pragma GCC visibility push(default)
namespace skerry {

/// Returns the processes of a communicator as ranks, for distribute(). `communicator`: the number that MPI_Comm_c2f
/// returns for it, for example MPI_Comm_c2f(MPI_COMM_WORLD). All processes of the communicator must call the function.
/// MPI must have been started by MPI_Init_thread with at least MPI_THREAD_SERIALIZED; otherwise throws
/// std::runtime_error. Destroy the object before MPI_Finalize.
std::shared_ptr<Ranks> mpi_ranks(int communicator);

}  // namespace skerry
#pragma GCC visibility pop
