// What loading a region adds up over its contacts: whether there is anything to do, and what its error is measured
// against.
#pragma once

#include "systems/solver/local/lumped_contact.h"

namespace skerry {

struct LoadSums {
    Real asked = 0;              // J, squared natural map of zero impulses: what contacts would have to stop
    Real moving = 0;             // J, all that moves between surfaces, gaps within reach, too
    Real inverse_diagonals = 0;  // kg
    bool separating = true;      // no contact closes: zero impulses solve it
    bool frictionless = true;    // no contact has friction
    bool one_friction = true;    // every contact has one coefficient

    /// `u`: velocity of the contact without impulses.
    void add(const LumpedContact& contact, Friction friction, const Vec4& u) {
        frictionless &= contact.friction.stick == 0;
        one_friction &= contact.friction.stick == contact.friction.slide;
        if (contact.inverse_diagonal == 0) return;
        inverse_diagonals += contact.inverse_diagonal;
        moving += contact.inverse_diagonal * u.squaredNorm();
        if (separates(contact, u)) return;
        separating = false;
        asked += contact.diagonal * natural_map(contact, friction, Vec4::Zero(), u).squaredNorm();
    }

    LoadSums& operator+=(const LoadSums& other) {
        asked += other.asked;
        moving += other.moving;
        inverse_diagonals += other.inverse_diagonals;
        separating &= other.separating;
        frictionless &= other.frictionless;
        one_friction &= other.one_friction;
        return *this;
    }
};

/// sqrt(J), of e_nat. Not of all velocities (docs/methods/errors.md 2.1, 2.2): it leaves out what no impulse stops, or
/// the errors allowed in a step of something that slides, or that is a little apart, would not get smaller with the
/// step, and would add up over the steps.
Real error_scale(const LoadSums& sums, Real gravity, Real h, Real tolerance);

}  // namespace skerry
