// Replaces start_mpi() of jobs/ranks/mpi_ranks.h in a program that is built without MPI.
#include "engine/base/complaint.h"
#include "jobs/ranks/mpi_ranks.h"

namespace skerry {

std::unique_ptr<Ranks> start_mpi(std::atomic<const char*>*) {
    refuse("skerry run", {}, "several processes, started by mpirun or srun",
           "one process, because this program was built without MPI",
           "build it with SKERRY_MPI=ON; for independent runs use `skerry sweep`");
}

}  // namespace skerry
