// Runs jobs in separate processes, with a limit on the number of simultaneous processes.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "jobs/function_ref.h"

namespace skerry {

struct PoolEnd {
    // Numbers of the jobs that failed before the pool received any signal, and texts on how their processes ended.
    std::vector<std::pair<int, std::string>> lost;
    std::vector<int> stopped;  // numbers of the jobs that failed after the first signal to the pool
    int done = 0;              // number of jobs that returned 0
    int signal = 0;            // last signal that the pool received; 0: none
};

/// Functions that the pool calls.
struct PoolCalls {
    // Runs the job with the given number and returns its exit code. Called in a new process.
    FunctionRef<int(int)> run;
    // Called with the number of a job and its exit code (-1 after a signal). Returns whether more jobs may start.
    FunctionRef<bool(int, int)> goes_on;
    // Called with the count of ended jobs and the count of running jobs, after each change and about twice a second.
    FunctionRef<void(int, int)> show;
};

/// Starts the jobs 0 to `count` - 1 in this order, at most `at_once` of them at the same time. No other thread may run
/// during the call, because the jobs are started by fork(). Throws std::system_error if not even one process can be
/// created.
/// - First SIGINT or SIGTERM: no more jobs start, and the running jobs get SIGTERM.
/// - Second signal: kills the running jobs.
/// - End of the calling process, for whatever reason: the system kills its jobs.
PoolEnd run_in_processes(int count, int at_once, const PoolCalls& calls);

}  // namespace skerry
