// Linear systems of Newton steps on contacts between bodies, with the velocities of the bodies as unknowns
// (docs/methods/region_solver.md 5.9). The matrix is the inertia K plus the response of the contacts. The cost grows
// with the height of a stack, not with the number of contacts between two bodies.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "components/column.h"
#include "components/types.h"
#include "systems/solver/equations/block_factor.h"

namespace skerry {

/// Effect of a contact on one unknown: a node (three numbers of a part), or a rigid body (velocity and spin).
struct BodyPush {
    Index part = no_index;
    Index place = 0;  // index of its first number in the part
    bool turns = false;
    Real weight = 0;
    Vec3 arm = Vec3::Zero();  // of rigid bodies, times weight [m]
};

/// Memory is kept. Vectors "by number" have the order of BlockFactor::right.
class BodyEquations {
public:
    struct Pushes {
        std::array<BodyPush, 6> push;
        Index count = 0;

        void add(const BodyPush& of) { push[static_cast<std::size_t>(count++)] = of; }
        std::span<const BodyPush> all() const { return {push.data(), static_cast<std::size_t>(count)}; }
    };
    /// A velocity row of the region that contacts move, and its place in the equations.
    struct Unknown {
        Index body, partner;  // identifiers of the body itself, and of the body it touches there or no_index
        Index row;
        Index rigid = no_index;  // row of RigidBodyTable if the unknown is the rigid motion
        Index slot = no_index;   // row of the rigid motion of its body, for nodes of implicit bodies
        Real mass = 0;           // for nodes with their own mass [kg]
        Index part = no_index, place = 0;
    };
    /// Memory for a matrix and its inverse.
    struct Square {
        DenseBlock matrix, inverse;
        Index* pivot;
    };

    BlockFactor& factor() { return factor_; }
    Column<Unknown>& unknown() { return unknown_; }
    Column<Index>& unknown_of_row() { return unknown_of_row_; }
    Square square(Index numbers);
    /// Effects of each contact on the unknowns, by contact.
    Column<Pushes>& pushes() { return pushes_; }
    /// Estimated cost of one step; infinite if steps are impossible [ns]
    Real cost() const { return cost_; }
    void set_cost(Real cost) { cost_ = cost; }

    /// Stores the present blocks of the factor as K.
    void keep_inertia();
    void start_from_inertia();
    /// Adds J^T block J of a contact.
    void add(Index contact, const Mat3& block);
    /// Returns J v of a contact.
    Vec3 velocity(Index contact, std::span<const Real> v) const;
    /// Sets the right-hand side to K x. Returns x K x.
    Real set_right(std::span<const Real> x);
    /// Adds J^T r of a contact to the right-hand side.
    void add_right(Index contact, const Vec3& impulse);
    /// Begins a round (fixed multipliers): no sliding directions are known, no contact is to stop.
    void start_round();

    Real softness = 0;         // compliance of contacts in a round, as a fraction of D
    bool rigid_modes = false;  // true: deformable bodies move as rigid bodies
    Column<Vec3> offset;       // by contact: part of its velocity that is not J v [m/s]

    // Vectors by number: the motion sought, the motion made by its impulses, their difference, the Newton step, and the
    // motion before the step [m/s, rad/s]
    Column<Real> present, answered, change, step, before;
    Column<Mat3> answer;  // by contact: derivative of the impulse in the last matrix
    // Contact data: sliding direction when the matrix was last built, or zero; and 1 if it is to stop in the next step.
    Column<Vec3> way;
    Column<std::uint8_t> stops;
    Index rises = 0;  // number of steps of a round that were accepted although they raised the merit

private:
    BlockFactor factor_;
    Column<Unknown> unknown_;
    Column<Index> unknown_of_row_;
    Column<Pushes> pushes_;
    Column<Real> square_, inertia_;
    Column<Index> pivot_;
    Real cost_ = 0;
};

/// Equations of Newton steps: with bodies as they are, and with all of them as rigid bodies.
struct NewtonEquations {
    BodyEquations own, rigid_modes;
};

}  // namespace skerry
