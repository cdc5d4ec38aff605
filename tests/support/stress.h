// The stress suite (docs/stress.md): what is asked of a scene, what it did, and whether that will do.
#pragma once

#include <source_location>
#include <string>

#include "skerry/world.h"

namespace skerry::test::stress {

/// One line of the table.
struct Outcome {
    int item = 0;           // of the list in docs/stress.md; 0: what users report elsewhere
    std::string what;       // the scene, and what was looked at
    std::string criterion;  // what is asked for
    std::string found;
    bool held = false;
};

/// Records the line (tests/support/record.h), then checks that it held.
void judge(const Outcome& outcome, const std::source_location& place = std::source_location::current());

/// A number that must not be above its limit, nor be no number.
void at_most(int item, const std::string& what, const std::string& quantity, Real found, Real limit,
             const std::source_location& place = std::source_location::current());
/// A number that must not be below its limit, nor be no number.
void at_least(int item, const std::string& what, const std::string& quantity, Real found, Real limit,
              const std::source_location& place = std::source_location::current());

/// Four digits that say something.
std::string text(Real value);

/// What a run did, looked at now and then.
struct Course {
    bool ok = true;            // every step was taken
    std::string message;       // of the step that was not
    bool finite = true;        // every position and velocity, whenever looked at
    Real gained = 0;           // J, kinetic, elastic and potential energy together: the most above the start
    Real in_play = 0;          // J, the most kinetic and elastic energy
    Real max_penetration = 0;  // m
    Index unconverged = 0;     // regions
    int steps = 0, limited = 0, shortened = 0, retried = 0;

    /// The most energy gained, of that in play.
    Real gain() const { return in_play > 0 ? gained / in_play : 0; }
};

/// Runs a world, looking `looks` times; stops at a step that cannot be taken.
Course follow(World& world, Real seconds, int looks);

/// Kinetic, elastic and potential energy, J.
Real mechanical_energy(const World& world);
bool all_finite(const World& world);

/// Moves the nodes of a body to places of one's own, slowly and by attachments that are removed again; leaves them at
/// rest.
void deform(World& world, BodyHandle body, const std::vector<Vec3>& places, Real seconds);

/// Share of the tetrahedra of a body that are turned inside out.
Real inverted_share(const World& world, BodyHandle body);

}  // namespace skerry::test::stress
