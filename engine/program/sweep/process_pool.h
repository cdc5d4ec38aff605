// Runs jobs in separate processes, a limited number at a time.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "jobs/function_ref.h"

namespace skerry {

struct PoolEnd {
    std::vector<std::pair<int, std::string>> lost;  // jobs that failed, with a description of how they ended
    std::vector<int> stopped;                       // jobs that were running when a signal ended the pool
    int done = 0;                                   // number of jobs that returned 0
    int signal = 0;                                 // signal that ended the pool; 0: none
};

/// Callbacks of the pool.
struct PoolCalls {
    FunctionRef<int(int)> run;            // called in a new process; takes the job, returns its exit code
    FunctionRef<bool(int, int)> goes_on;  // called with job and exit code; returns whether further jobs may start
    FunctionRef<void(int, int)> show;     // jobs done and running, after each change and twice a second
};

/// Runs jobs 0 to `count` - 1 in order, `at_once` at a time. SIGINT and SIGTERM are passed on to the running jobs; a
/// second one kills them. Jobs die with this process, however it ends. No other thread may run during the call. Throws
/// std::system_error if not even one process can be created.
PoolEnd run_in_processes(int count, int at_once, const PoolCalls& calls);

}  // namespace skerry
