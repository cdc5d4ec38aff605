// Which cases of a sweep this process works on, when it is one of several that know nothing of each other.
#pragma once

#include <functional>
#include <optional>
#include <string>

namespace skerry {

/// Case i is for the process whose rank is i mod `of`.
struct Share {
    int rank = 0, of = 1;
    std::string said_by;       // the options or variables that say so; empty: nobody, all cases are for this process
    std::optional<int> cores;  // for this process, as whoever started it says; none: what the system lets it use

    bool has(int index) const { return index % of == rank; }
};

/// The value of an environment variable, or null.
using Environment = std::function<const char*(const char*)>;

/// What `--rank` and `--of` say; else the place in a SLURM array times that among tasks which mpirun (Open MPI, or the
/// PMI of MPICH and Intel MPI) or srun started. A batch script of SLURM is one process, however many tasks it may
/// start. Throws SceneError for numbers that are none or do not fit each other.
Share share_of(std::optional<int> rank, std::optional<int> of, const Environment& environment);

}  // namespace skerry
