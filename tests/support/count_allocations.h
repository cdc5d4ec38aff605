// Programs that link count_allocations.cpp count the calls of operator new.
#pragma once

#include <atomic>

namespace skerry::test {

extern std::atomic<long> allocations;

}  // namespace skerry::test
