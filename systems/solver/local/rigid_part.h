// Part of a contact that belongs to rigid bodies. With it the block of W is a matrix (docs/methods/rigid_bodies.md 3).
#pragma once

#include <array>
#include <span>

#include "components/types.h"
#include "systems/solver/local/columns3.h"
#include "systems/solver/local/lumped_contact.h"
#include "systems/solver/local/solve_block.h"

namespace skerry {

inline Vec4 cross(const Vec4& a, const Vec4& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0], 0};
}
inline Mat3 cross_matrix(const Vec3& a) {
    Mat3 matrix;
    matrix << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
    return matrix;
}

/// A rigid body in a contact: sums over its nodes in the stencil of the weights, and of weight times position.
struct RigidTerm {
    Index row = no_index;  // row of RigidBodyTable
    Index slot = 0;        // index of its velocity among those of the region; its spin is the next one
    Real weight = 0;       // often 1 or -1
    Real step = 0;         // weight over mass [1/kg]
    Vec4 arm;              // vector from the centre of mass, times weight [m]
    Columns3 spin_step;    // change of spin per impulse: I^-1 [arm] [1/(kg m)]
    Real turn = 0;         // weight of the spin: 1 or -1 in a joint's rows of spins, whose impulses are moments
};

struct RigidPart {
    std::array<RigidTerm, 2> term;
    Index term_count = 0;
    std::span<const RigidTerm> terms() const { return {term.data(), static_cast<std::size_t>(term_count)}; }
    Columns3 mobility;  // W_ii [1/kg]
    Columns3 frame;     // normal and two tangents
    LocalBlock block;   // W_ii in the frame
    Real along_normal;  // n W_ii n without deformation of bodies [1/kg]
    Real steepest;      // upper bound of the largest eigenvalue of W_ii [1/kg]
};

/// Adds the velocity of a contact's rigid bodies to `start`. Always inlined: it is part of every contact step, and
/// compilers tend not to inline it.
[[gnu::always_inline]] inline Vec4 add_rigid_velocities(const RigidPart& part, const Vec4* velocity, Vec4 start) {
    for (Index k = 0; k < part.term_count; ++k) {
        const RigidTerm& term = part.term[static_cast<std::size_t>(k)];
        start += term.weight * velocity[term.slot] + cross(velocity[term.slot + 1], term.arm);
        if (term.turn != 0) start += term.turn * velocity[term.slot + 1];
    }
    return start;
}

[[gnu::always_inline]] inline void apply_to_rigid(const RigidPart& part, const Vec4& impulse, Vec4* velocity) {
    for (Index k = 0; k < part.term_count; ++k) {
        const RigidTerm& term = part.term[static_cast<std::size_t>(k)];
        velocity[term.slot] += term.step * impulse;
        velocity[term.slot + 1] += times(term.spin_step, impulse);
    }
}

/// Share of the rigid bodies in the block of W of two contacts [1/kg]
inline Mat3 rigid_coupling(const RigidPart& a, const RigidPart& b) {
    Mat3 sum = Mat3::Zero();
    for (Index k = 0; k < a.term_count; ++k)
        for (Index l = 0; l < b.term_count; ++l) {
            const RigidTerm &of_a = a.term[static_cast<std::size_t>(k)], &of_b = b.term[static_cast<std::size_t>(l)];
            if (of_a.slot != of_b.slot) continue;
            sum += of_a.weight * of_b.step * Mat3::Identity() -
                   cross_matrix(of_a.arm.head<3>()) * matrix_of(of_b.spin_step);
            if (of_a.turn != 0) sum += of_a.turn * matrix_of(of_b.spin_step);
        }
    return sum;
}

}  // namespace skerry
