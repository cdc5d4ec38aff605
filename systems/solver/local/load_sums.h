// Sums over the contacts of a region, collected while loading: they tell whether anything is to be solved, and give the
// scale of the error.
#pragma once

#include "systems/solver/local/lumped_contact.h"

namespace skerry {

struct LoadSums {
    Real asked = 0;              // squared natural map of zero impulses, over closing contacts [J]
    Real moving = 0;             // squared contact velocities over D, including contacts that do not close [J]
    Real inverse_diagonals = 0;  // sum of 1/D [kg]
    bool separating = true;      // no contact closes: zero impulses solve it
    bool frictionless = true;    // no contact has friction
    bool one_friction = true;    // the static and dynamic coefficients of every contact are equal

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

/// Scale of e_nat. It leaves out velocities that no impulse stops (docs/methods/errors.md 2.1, 2.2). Otherwise the
/// error allowed per step would not decrease with the step for sliding or slightly open contacts, and would add up over
/// the steps [sqrt(J)]
Real error_scale(const LoadSums& sums, Real gravity, Real h, Real tolerance);

}  // namespace skerry
