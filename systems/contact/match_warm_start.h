// Carries impulses from the last step to this one (docs/methods/region_solver.md 7).
#pragma once

#include "components/contact_table.h"
#include "components/pair_table.h"
#include "jobs/access.h"
#include "jobs/executor.h"

namespace skerry {

/// impulse = last step's impulse of the same key, turned so that the old normal becomes the new one, times h / last
/// step; zero for a new contact. Both tables are in key order: a merge. Parallel over blocks of contacts. Returns false
/// when there is nothing to do (skipped).
bool match_warm_start(Executor& executor, std::span<const ContactKey> key, std::span<const Vec3> normal,
                      const WarmStartTable& last, Real h, std::span<Vec3> impulse);

/// Pairs whose contacts were not looked for, since neither partner moves: PairTable::key, ascending, and
/// PairTable::idle.
struct IdlePairs {
    std::span<const std::uint64_t> key = {};
    std::span<const std::uint8_t> idle = {};

    static IdlePairs bind(const Binder& binder, const PairTable& pair) {
        return {.key = binder.read(pair.key), .idle = binder.read(pair.idle)};
    }
};

/// Keeps this step's impulses for the next, and those of idle pairs as they were. `next` is room to merge them in.
void store_warm_start(std::span<const ContactKey> key, std::span<const Vec3> normal, std::span<const Vec3> impulse,
                      const IdlePairs& pairs, Real h, WarmStartTable& last, WarmStartTable& next);

}  // namespace skerry
