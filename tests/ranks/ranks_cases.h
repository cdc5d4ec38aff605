// Test cases of the interface Ranks, for each of its implementations.
#pragma once

#include <span>

#include "jobs/ranks/ranks.h"

namespace skerry::test {

/// A case that at least 2 ranks run together. `run` throws std::runtime_error if a result is wrong.
struct RanksCase {
    const char* name;
    void (*run)(Ranks& ranks);
};

std::span<const RanksCase> ranks_cases();

}  // namespace skerry::test
