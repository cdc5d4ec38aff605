// Distribution of a sweep's cases over several processes that do not communicate.
#pragma once

#include <functional>
#include <optional>
#include <string>

namespace skerry {

/// Case i belongs to the process whose rank is i mod `of`.
struct Share {
    int rank = 0, of = 1;
    std::string said_by;       // options or variables that define the share; empty: none, this process gets all cases
    std::optional<int> cores;  // cores for this process according to its launcher; empty: those the system allows

    bool has(int index) const { return index % of == rank; }
};

/// Returns the value of an environment variable, or null.
using Environment = std::function<const char*(const char*)>;

/// Reads the share from `--rank` and `--of`. Without them it combines the position in a SLURM array with the rank
/// among tasks started by mpirun (Open MPI, or the PMI of MPICH and Intel MPI) or srun. A batch script of SLURM is one
/// process, regardless of the number of tasks it may start. Throws SceneError for values that are not numbers or are
/// inconsistent.
Share share_of(std::optional<int> rank, std::optional<int> of, const Environment& environment);

}  // namespace skerry
