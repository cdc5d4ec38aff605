// The function of jobs/ranks/mpi_ranks.h in a program without MPI.
#include "jobs/ranks/mpi_ranks.h"
#include "skerry/error.h"

namespace skerry {

std::unique_ptr<Ranks> start_mpi() {
    Complaint{.file = {},
              .object = "skerry run",
              .field = {},
              .found = "several processes, started by mpirun or srun",
              .expected = "one process, because this program was built without MPI",
              .hint = "build it with SKERRY_MPI=ON; for independent runs use `skerry sweep`"}
        .raise();
}

}  // namespace skerry
