// Distribution of the cases of a sweep over several processes that do not communicate.
#pragma once

#include <functional>
#include <optional>
#include <string>

namespace skerry {

/// The cases that one process runs: all cases whose number modulo `of` is `rank`.
struct Share {
    int rank = 0, of = 1;
    // Names of the options or environment variables that define the share. If the text is empty, the process runs all
    // cases.
    std::string said_by;
    // Number of cores that the launcher grants this process. Without a value the caller chooses the number.
    std::optional<int> cores;

    bool has(int index) const { return index % of == rank; }
};

/// Function that returns the value of an environment variable, or null if the variable is not set.
using Environment = std::function<const char*(const char*)>;

/// Returns the rank of this process among the tasks that mpirun (Open MPI, or the PMI of MPICH and Intel MPI) or srun
/// has started. Without a launcher this is rank 0 of 1. A batch script of SLURM is one process, regardless of the
/// number of tasks that it may start.
Share task_share(const Environment& environment);

/// Returns the share of this process.
/// - If `rank` and `of` are given, these define the share.
/// - Otherwise the tasks of all jobs of a SLURM array are numbered one after the other: rank = (rank of the job) *
///   (number of tasks of a job) + (rank from task_share()).
///
/// Throws SceneError for values that are not numbers or are inconsistent.
Share share_of(std::optional<int> rank, std::optional<int> of, const Environment& environment);

}  // namespace skerry
