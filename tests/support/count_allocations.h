// Programs that link count_allocations.cpp count the calls of operator new, and can let one of them fail.
#pragma once

#include <atomic>

namespace skerry::test {

extern std::atomic<long> allocations;

/// Number of calls of operator new by this thread until one of them throws std::bad_alloc; negative: none does.
extern thread_local long allocations_until_failure;

}  // namespace skerry::test
