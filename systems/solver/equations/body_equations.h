// Linear systems of Newton steps on the contacts between bodies. The unknowns are velocities of the bodies
// (docs/methods/region_solver.md 5.9). So the cost grows with the height of a stack, not with the number of contacts
// between two bodies.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "components/column.h"
#include "components/types.h"
#include "systems/solver/equations/block_factor.h"

namespace skerry {

/// Link between a contact and one unknown of the equations. An unknown is the velocity of a node (three numbers), or
/// the velocity and angular velocity of a rigid body (six numbers).
struct UnknownEffect {
    Index part = no_index;  // part of the unknown: group of unknowns with one row and column of blocks (BlockFactor)
    Index first_entry = 0;  // index of the first entry of the unknown within the part
    bool turns = false;     // true for a rigid motion (six numbers)
    Real weight = 0;        // factor of the unknown's velocity in the velocity of the contact
    // For rigid bodies: sum of stencil weight times vector from the centre of mass to the node [m]
    Vec3 arm = Vec3::Zero();
};

/// Equations of one region, which is a group of contacts that are solved together, because bodies connect them. Memory
/// is reused between regions.
class BodyEquations {
public:
    struct ContactEffects {
        std::array<UnknownEffect, 6> effect;
        Index count = 0;

        void add(const UnknownEffect& added) { effect[static_cast<std::size_t>(count++)] = added; }
        std::span<const UnknownEffect> all() const { return {effect.data(), static_cast<std::size_t>(count)}; }
    };
    /// A node velocity or rigid motion that contacts of the region can change. `row`: its row among the velocities of
    /// the region. `part`, `first_entry`: its part (group of unknowns of BlockFactor), and the index of its first entry
    /// within the part.
    struct Unknown {
        Index body, partner;  // identify the unknown's body and, for a node, the other body it touches, or no_index
        Index row;
        Index rigid = no_index;  // row of RigidBodyTable if the unknown is a rigid motion
        Index slot = no_index;   // for nodes of implicit bodies: velocity row of the body's rigid motion
        Real mass = 0;           // mass of the node, for nodes with their own mass [kg]
        Index part = no_index, first_entry = 0;
    };
    /// Memory for a square matrix, the inverse of the matrix and the pivots.
    struct Square {
        DenseBlock matrix, inverse;
        Index* pivot;
    };

    BlockFactor& factor() { return factor_; }
    Column<Unknown>& unknown() { return unknown_; }
    Column<Index>& unknown_of_row() { return unknown_of_row_; }
    Square square(Index numbers);
    /// Effects of each contact on the unknowns, by contact.
    Column<ContactEffects>& effects() { return effects_; }
    /// Estimated cost of one Newton step; infinite if Newton steps are impossible [ns]
    Real cost() const { return cost_; }
    void set_cost(Real cost) { cost_ = cost; }

    /// Stores the present blocks of the factor as inertia matrix K.
    void keep_inertia();
    void start_from_inertia();
    /// Adds J^T block J to the matrix, where J is the Jacobian of the contact's velocity with respect to the unknowns.
    void add(Index contact, const Mat3& block);
    /// Returns the velocity J v of a contact for the unknowns `v`, with the Jacobian J of add().
    Vec3 velocity(Index contact, std::span<const Real> v) const;
    /// Sets the right-hand side to K x. Returns the product x . K x.
    Real set_right(std::span<const Real> x);
    /// Adds J^T r to the right-hand side, where r is the impulse of a contact.
    void add_right(Index contact, const Vec3& impulse);
    /// Begins a round, which is a sequence of Newton steps with fixed start impulses: clears `sliding_direction`,
    /// `stops` and `rises`.
    void start_round();

    Real softness = 0;         // compliance of the contacts in a round, as a fraction of the mobility D
    bool rigid_modes = false;  // true: deformable bodies move only as rigid bodies
    Column<Vec3> offset;  // by contact: part of the contact velocity that is independent of the unknowns, u - J v [m/s]

    // Vectors of all unknowns, in the order of BlockFactor::right [m/s, rad/s]. Newton's method seeks a motion that the
    // contact impulses belonging to it reproduce.
    // - present: the iterate, which determines contact impulses
    // - produced: motion that these impulses produce; equal to `present` at the solution
    // - change: produced - present
    // - step: Newton step
    // - before: `present` before the step
    Column<Real> present, produced, change, step, before;
    Column<Mat3> derivative;  // by contact: derivative of its impulse (LawImpulse) when the last matrix was built
    // Data by contact. sliding_direction: direction in which the contact slid when the last matrix was built; zero if
    // it did not slide. stops: 1 if the next step shall stop the contact.
    Column<Vec3> sliding_direction;
    Column<std::uint8_t> stops;
    Index rises = 0;  // number of steps in this round that were accepted although the merit function rose

private:
    BlockFactor factor_;
    Column<Unknown> unknown_;
    Column<Index> unknown_of_row_;
    Column<ContactEffects> effects_;
    Column<Real> square_, inertia_;
    Column<Index> pivot_;
    Real cost_ = 0;
};

/// Equations of Newton steps: `own` with all degrees of freedom, `rigid_modes` with all bodies as rigid bodies.
struct NewtonEquations {
    BodyEquations own, rigid_modes;
};

}  // namespace skerry
