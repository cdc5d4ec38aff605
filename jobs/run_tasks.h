// Long independent tasks on threads of their own, watched by the calling thread.
#pragma once

#include <chrono>

#include "components/types.h"
#include "jobs/function_ref.h"

namespace skerry {

/// Number of cores that this process may use, at least 1.
int core_count();

/// Calls task(0) .. task(count - 1), each once, on new threads. Their number is the lesser of `threads` and `count`,
/// but at least 1. Tasks start in the order of their numbers. Meanwhile the calling thread calls watch() once per
/// `period`; so watch() may call code that only this thread may run.
///
/// After an exception of a task or of watch() no further task starts, but running tasks are completed. Then the
/// exception of watch() is rethrown, or else that of the task with the lowest number.
void run_tasks(Index count, int threads, FunctionRef<void(Index task)> task, std::chrono::milliseconds period,
               FunctionRef<void()> watch);

}  // namespace skerry
