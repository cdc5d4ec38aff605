// Jobs in processes of their own, so many at a time.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "jobs/function_ref.h"

namespace skerry {

struct PoolEnd {
    std::vector<std::pair<int, std::string>> lost;  // jobs that did not end well, and how they ended, in words
    std::vector<int> stopped;                       // jobs that were under way when a signal ended it all
    int done = 0;                                   // jobs that ended with 0
    int signal = 0;                                 // that ended it; 0: none
};

/// What the pool asks and tells.
struct PoolCalls {
    FunctionRef<int(int)> run;            // in a process of its own: job to exit code
    FunctionRef<bool(int, int)> goes_on;  // after job and exit code: whether others may begin
    FunctionRef<void(int, int)> show;     // jobs done and running, after each change and twice a second
};

/// Runs jobs 0 to `count` - 1 in their order, `at_once` at a time. SIGINT and SIGTERM are handed on to the jobs under
/// way, a second one kills them; jobs die with this process, however it ends. To be called where no other thread runs.
/// Throws std::system_error where not even one process can be made.
PoolEnd run_in_processes(int count, int at_once, const PoolCalls& calls);

}  // namespace skerry
