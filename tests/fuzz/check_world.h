// What must hold of a world after every step, whatever the scene is.
#pragma once

#include "skerry/world.h"

namespace skerry::test {

/// Throws std::runtime_error that says what is wrong.
void check_bodies(const World& world);
void check_contacts(const World& world);
/// `extent`: m, from end to end of all that is in the world.
void check_report(const StepReport& report, Real extent);

}  // namespace skerry::test
