#include "jobs/ranks/mpi_ranks.h"

#include "skerry/mpi.h"

namespace skerry {

std::shared_ptr<Ranks> mpi_ranks(int communicator) {
    return join_mpi(communicator);
}

}  // namespace skerry
