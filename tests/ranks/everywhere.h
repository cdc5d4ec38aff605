// Worlds on ranks on which every rank holds every body.
#pragma once

#include "jobs/ranks/ranks.h"
#include "skerry/world.h"

namespace skerry::test {

/// Divides the bodies of a world among ranks so that every rank holds every body. Bodies are dealt out by their slots;
/// linked bodies have the same owner. Call it before the first step, on all ranks, for equal worlds.
void hold_everywhere(World& world, Ranks& ranks);

}  // namespace skerry::test
