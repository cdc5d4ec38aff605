// Ranks that are threads of one process, for tests.
#pragma once

#include <chrono>
#include <functional>

#include "jobs/ranks/ranks.h"

namespace skerry::test {

/// Calls run(ranks) on `count` threads at once, each with its own rank. Rethrows the exception of the lowest rank that
/// threw one; the other ranks then end with an exception, too. Throws if the ranks call different functions of Ranks,
/// or if all of them wait. `delay`: time from sending a message to its arrival.
void run_on_ranks(int count, const std::function<void(Ranks&)>& run, std::chrono::microseconds delay = {});

}  // namespace skerry::test
