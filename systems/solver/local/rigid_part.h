// Part of a contact that belongs to rigid bodies. The diagonal block of the Delassus operator W of such a contact is a
// full 3x3 matrix (docs/methods/rigid_bodies.md 3).
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

/// Effect of a contact on one rigid body. `weight` and `arm` are sums over the body's nodes in the stencil.
struct RigidTerm {
    Index row = no_index;  // row of RigidBodyTable
    Index slot = 0;        // velocity row of the body's velocity in the region; the spin is in the next row
    Real weight = 0;       // sum of the stencil weights, often 1 or -1
    Real step = 0;         // weight divided by mass [1/kg]
    Vec4 arm;              // sum of weight times vector from the centre of mass to the node [m]
    Columns3 spin_step;    // change of spin per unit impulse: I^-1 times the cross-product matrix of `arm` [1/(kg m)]
    // Coefficient of the spin: 1 or -1 in joint rows of rotation, whose impulses are moments; otherwise 0.
    Real spin_coefficient = 0;
};

struct RigidPart {
    std::array<RigidTerm, 2> term;
    Index term_count = 0;
    std::span<const RigidTerm> terms() const { return {term.data(), static_cast<std::size_t>(term_count)}; }
    Columns3 mobility;  // W_ii [1/kg]
    Columns3 frame;     // contact frame; its columns are the normal and two tangents
    LocalBlock block;   // W_ii in the contact frame, second tangent multiplied by `across`; prepared for solve_block
    // Friction coefficient along the second tangent, as a multiple of that along the first one. solve_block works with
    // the impulse (r_n, r_1, r_2 / across) and the velocity (u_n, u_1, across u_2) (docs/methods/friction.md 4.2).
    Real across = 1;
    // mobility along the normal, with deformable bodies taken as rigid; for the split impulse [1/kg]
    Real along_normal;
    Real max_eigenvalue;  // upper bound of the largest eigenvalue of W_ii [1/kg]
};

/// Adds the contact velocity due to rigid bodies to `start`. The function is always inlined: every contact step calls
/// it, and compilers tend not to inline it.
[[gnu::always_inline]] inline Vec4 add_rigid_velocities(const RigidPart& part, const Vec4* velocity, Vec4 start) {
    for (Index k = 0; k < part.term_count; ++k) {
        const RigidTerm& term = part.term[static_cast<std::size_t>(k)];
        start += term.weight * velocity[term.slot] + cross(velocity[term.slot + 1], term.arm);
        if (term.spin_coefficient != 0) start += term.spin_coefficient * velocity[term.slot + 1];
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

/// Contribution of the rigid bodies to the block of W for contacts a and b [1/kg]
inline Mat3 rigid_coupling(const RigidPart& a, const RigidPart& b) {
    Mat3 sum = Mat3::Zero();
    for (Index k = 0; k < a.term_count; ++k)
        for (Index l = 0; l < b.term_count; ++l) {
            const RigidTerm &of_a = a.term[static_cast<std::size_t>(k)], &of_b = b.term[static_cast<std::size_t>(l)];
            if (of_a.slot != of_b.slot) continue;
            sum += of_a.weight * of_b.step * Mat3::Identity() -
                   cross_matrix(of_a.arm.head<3>()) * matrix_of(of_b.spin_step);
            if (of_a.spin_coefficient != 0) sum += of_a.spin_coefficient * matrix_of(of_b.spin_step);
        }
    return sum;
}

}  // namespace skerry
