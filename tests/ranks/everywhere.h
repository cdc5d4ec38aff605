// Worlds on ranks on which every rank holds every body.
#pragma once

#include <functional>

#include "skerry/world.h"
#include "tests/ranks/thread_ranks.h"

namespace skerry::test {

/// Divides the bodies of a world among ranks so that every rank holds every body. Bodies are dealt out by their slots;
/// linked bodies have the same owner. Call it before the first step, on all ranks, for equal worlds.
void hold_everywhere(World& world, Ranks& ranks);

/// Makes the world on `count` ranks, holds all bodies everywhere and runs `run` on each rank. Returns for each rank the
/// hash of the state, for which the contact memories of all ranks have been joined.
std::vector<std::uint64_t> hashes_everywhere(int count, const std::function<World()>& make,
                                             const std::function<void(World&)>& run);

}  // namespace skerry::test
