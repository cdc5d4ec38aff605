// Sums over the contacts of a region, collected while loading. They show whether the region needs a solve, and give the
// scale of its error.
#pragma once

#include "systems/solver/local/lumped_contact.h"

namespace skerry {

struct LoadSums {
    // Sum of D |F|^2 over closing contacts, with the mobility D and the natural map F at zero impulses [J]
    Real squared_residual = 0;
    Real moving = 0;             // sum of |u|^2 / D over all contacts, closing or not, with the contact velocity u [J]
    Real inverse_diagonals = 0;  // sum of 1/D over the contacts, with the mobility D [kg]
    bool separating = true;      // true if no contact closes, so that zero impulses are the solution
    bool frictionless = true;    // true if no contact has friction, and no row is a tie
    // true if each contact has equal static and dynamic coefficients, and no row is a tie
    bool one_friction = true;

    /// `u` is the velocity of the contact without impulses [m/s]
    void add(const LumpedContact& contact, Friction friction, const Vec4& u) {
        frictionless &= contact.friction.stick == 0 && !contact.friction.ties();
        one_friction &= contact.friction.stick == contact.friction.slide && !contact.friction.ties();
        if (contact.inverse_diagonal == 0) return;
        inverse_diagonals += contact.inverse_diagonal;
        moving += contact.inverse_diagonal * u.squaredNorm();
        if (separates(contact, u)) return;
        separating = false;
        squared_residual += contact.diagonal * natural_map(contact, friction, Vec4::Zero(), u).squaredNorm();
    }

    LoadSums& operator+=(const LoadSums& other) {
        squared_residual += other.squared_residual;
        moving += other.moving;
        inverse_diagonals += other.inverse_diagonals;
        separating &= other.separating;
        frictionless &= other.frictionless;
        one_friction &= other.one_friction;
        return *this;
    }
};

/// Scale by which the error e_nat is divided (docs/methods/errors.md 2.1, 2.2) [sqrt(J)]. Apart from a small lower
/// bound, it excludes velocities that no impulse stops, such as sliding. Otherwise allowed errors of sliding or
/// slightly open contacts would add up over many short steps.
Real error_scale(const LoadSums& sums, Real gravity, Real h, Real tolerance);

}  // namespace skerry
