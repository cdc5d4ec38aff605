// Carries impulses from the last step to this one (docs/methods/region_solver.md 7).
#pragma once

#include "components/contact_table.h"
#include "components/resting_contact_table.h"
#include "jobs/executor.h"

namespace skerry {

/// impulse = last step's impulse of the same key, or that with which it came to rest, turned so that the old normal
/// becomes the new one, times h / the step that it belongs to; zero for a new contact. All tables are in key order: a
/// merge. Parallel over blocks of contacts. Returns false when there is nothing to do (skipped).
bool match_warm_start(Executor& executor, std::span<const ContactKey> key, std::span<const Vec3> normal,
                      const WarmStartTable& last, const RestingContactTable& resting, Real h, std::span<Vec3> impulse);

/// Keeps this step's impulses for the next.
void store_warm_start(std::span<const ContactKey> key, std::span<const Vec3> normal, std::span<const Vec3> impulse,
                      Real h, WarmStartTable& last);

}  // namespace skerry
