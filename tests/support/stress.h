// The stress suite (docs/stress.md): criterion of a scene, its result, and the verdict.
#pragma once

#include <source_location>
#include <string>

#include "skerry/world.h"

namespace skerry::test::stress {

/// One row of the table.
struct Outcome {
    int item = 0;             // number in the list of docs/stress.md; 0: problems that users report elsewhere
    std::string description;  // scene and tested quantity
    std::string criterion;    // condition that must hold
    std::string found;
    bool held = false;
};

/// Records the line (tests/support/record.h), then checks that it held.
void judge(const Outcome& outcome, const std::source_location& location = std::source_location::current());

/// Judges a number that must not exceed its limit and must not be NaN.
void at_most(int item, const std::string& description, const std::string& quantity, Real found, Real limit,
             const std::source_location& location = std::source_location::current());
/// Judges a number that must not be below its limit and must not be NaN.
void at_least(int item, const std::string& description, const std::string& quantity, Real found, Real limit,
              const std::source_location& location = std::source_location::current());

/// Formats a number with four significant digits.
std::string text(Real value);

/// Summary of a run, sampled now and then.
struct Course {
    bool ok = true;            // true if every step was taken
    std::string message;       // message of the step that failed
    bool finite = true;        // true if all positions and velocities were finite at every sample
    Real gained = 0;           // largest rise of kinetic + elastic + potential energy above the start [J]
    Real in_play = 0;          // largest kinetic + elastic energy [J]
    Real max_penetration = 0;  // [m]
    Index unconverged = 0;     // regions
    int steps = 0, limited = 0, shortened = 0, retried = 0;

    /// Largest energy gain as a fraction of the energy in play.
    Real gain() const { return in_play > 0 ? gained / in_play : 0; }
};

/// Advances a world and samples it `samples` times; stops at a step that fails.
Course follow(World& world, Real seconds, int samples);

/// Sum of kinetic, elastic and potential energy [J].
Real mechanical_energy(const World& world);
bool all_finite(const World& world);

/// Moves the nodes of a body slowly to `places`, with attachments that are removed afterwards. The nodes end at rest.
void deform(World& world, BodyHandle body, const std::vector<Vec3>& places, Real seconds);

/// Share of the tetrahedra of a body that are inverted.
Real inverted_share(const World& world, BodyHandle body);

}  // namespace skerry::test::stress
