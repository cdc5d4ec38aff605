// Invariants of a world that must hold after every step of any scene.
#pragma once

#include "skerry/world.h"

namespace skerry::test {

/// Each function throws std::runtime_error with a description of the fault.
void check_bodies(const World& world);
void check_contacts(const World& world);
/// `extent`: diameter of everything in the world [m]
void check_report(const StepReport& report, Real extent);

}  // namespace skerry::test
