// The linear systems of Newton steps on contacts between bodies, in the velocities of the bodies
// (docs/methods/region_solver.md 5.9): the inertia K of what contacts move, and what contacts answer to its motion. A
// stack costs as much as it is high, however many contacts there are between two bodies.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "components/column.h"
#include "components/types.h"
#include "systems/solver/equations/block_factor.h"

namespace skerry {

/// What a contact moves: a node, three numbers of a part, or a rigid body, its velocity and its spin.
struct BodyPush {
    Index part = no_index;
    Index place = 0;  // of the first number in the part
    bool turns = false;
    Real weight = 0;
    Vec3 arm = Vec3::Zero();  // m, times weight: of rigid bodies
};

/// Keeps its memory. Vectors by number are in the order of BlockFactor::right.
class BodyEquations {
public:
    struct Pushes {
        std::array<BodyPush, 6> push;
        Index count = 0;

        void add(const BodyPush& of) { push[static_cast<std::size_t>(count++)] = of; }
        std::span<const BodyPush> all() const { return {push.data(), static_cast<std::size_t>(count)}; }
    };
    /// A row of a region's velocities that contacts move, its numbers in the equations.
    struct Unknown {
        Index body, partner;  // names: the body itself, and the one that it touches there, or no_index
        Index row;
        Index rigid = no_index;  // row of RigidBodyTable, where that is all of the body
        Index slot = no_index;   // of the motion of its body as a whole, of nodes that deform one
        Real mass = 0;           // kg, of nodes that move by themselves
        Index part = no_index, place = 0;
    };
    /// Room for a matrix and its inverse.
    struct Square {
        DenseBlock matrix, inverse;
        Index* pivot;
    };

    BlockFactor& factor() { return factor_; }
    Column<Unknown>& unknown() { return unknown_; }
    Column<Index>& unknown_of_row() { return unknown_of_row_; }
    Square square(Index numbers);
    /// By contact.
    Column<Pushes>& pushes() { return pushes_; }
    /// ns, of one step, of the order of; infinite where steps are out of the question.
    Real cost() const { return cost_; }
    void set_cost(Real cost) { cost_ = cost; }

    /// The blocks of the factor are K from now on.
    void keep_inertia();
    void start_from_inertia();
    /// Adds J^T block J of a contact.
    void add(Index contact, const Mat3& block);
    /// J v of a contact.
    Vec3 velocity(Index contact, std::span<const Real> v) const;
    /// The right-hand side: K x. Returns x K x.
    Real set_right(std::span<const Real> x);
    /// Adds J^T r of a contact to the right-hand side.
    void add_right(Index contact, const Vec3& impulse);
    /// A round: no contact has slid yet, nor is to stop.
    void start_round();

    Real softness = 0;    // of D, what contacts give way by in a round
    bool wholes = false;  // bodies that deform move as wholes
    Column<Vec3> offset;  // m/s, by contact: of its velocity, what is not that of the motion

    // by number, m/s and rad/s: the motion that is looked for, that which its impulses make, their difference, and a
    // step with the motion before it
    Column<Real> present, answered, change, step, before;
    Column<Mat3> answer;  // by contact: derivative of the impulse by the one that would stop it, when last asked
    // by contact: which way it slid when the matrix was made last, or zero, and whether it is to stop in the next step
    Column<Vec3> way;
    Column<std::uint8_t> stops;
    Index rises = 0;  // steps of a round that were taken though they raised what they were to lower

private:
    BlockFactor factor_;
    Column<Unknown> unknown_;
    Column<Index> unknown_of_row_;
    Column<Pushes> pushes_;
    Column<Real> square_, inertia_;
    Column<Index> pivot_;
    Real cost_ = 0;
};

/// Of Newton steps: bodies as they are, and all of them as wholes.
struct NewtonEquations {
    BodyEquations own, wholes;
};

}  // namespace skerry
