// What a contact has beside its nodes where it touches rigid bodies: its block of W is a matrix
// (docs/methods/rigid_bodies.md 3).
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

/// A rigid body in a contact: the sums over its nodes in the stencil of their weights, and of weight times place.
struct RigidTerm {
    Index row = no_index;  // of RigidBodyTable
    Index slot = 0;        // of its velocity among those of the region; its spin comes next
    Real weight = 0;       // often 1 or -1
    Real step = 0;         // 1/kg, weight over mass
    Vec4 arm;              // m, from the centre of mass, times weight
    Columns3 spin_step;    // 1/(kg m), by what an impulse changes the spin: I^-1 [arm]
    Real turn = 0;         // of the spin itself: 1 or -1 in a joint's rows of spins, whose impulses are moments
};

struct RigidPart {
    std::array<RigidTerm, 2> term;
    Index term_count = 0;
    std::span<const RigidTerm> terms() const { return {term.data(), static_cast<std::size_t>(term_count)}; }
    Columns3 mobility;  // 1/kg, W_ii
    Columns3 frame;     // normal and two tangents
    LocalBlock block;   // of W_ii, in the frame
    Real along_normal;  // 1/kg, n W_ii n where nothing deforms
    Real steepest;      // 1/kg, at least the largest eigenvalue of W_ii
};

/// u of the rigid bodies of a contact. Of each step of each contact: a compiler that has much to do leaves it outside.
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

/// 1/kg, the share of the rigid bodies in the block of W of two contacts.
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
