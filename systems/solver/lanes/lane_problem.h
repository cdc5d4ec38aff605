// Data of small regions in SIMD lanes (docs/methods/region_solver.md 3). Each lane holds one region of at most K
// contacts. T is Real8, or Real for the scalar version that a test compares with.
//
// Lumped masses allow the dense form u_i = q_i + sum_j C_ij r_j, with the contact velocities u, the velocities q
// without impulses, the impulses r and scalars C_ij (docs/methods/contact.md 2.1).
#pragma once

#include <array>
#include <span>

#include "systems/material/lane_math.h"
#include "systems/solver/local/lumped_contact.h"

namespace skerry {

/// Possible numbers K of contacts of a LaneProblem. Unused contacts are added to a region until it has one of these
/// numbers.
inline constexpr std::array<int, 6> lane_sizes{2, 3, 4, 6, 8, 12};
inline constexpr int largest_lane_region = lane_sizes.back();

/// Index in lane_sizes of the smallest size for this number of contacts (2 .. largest_lane_region).
inline constexpr std::size_t lane_size_class(std::size_t contacts) {
    std::size_t c = 0;
    while (static_cast<std::size_t>(lane_sizes[c]) < contacts) ++c;
    return c;
}

template <class T, int K>
struct LaneProblem {
    T coupling[K][K];              // C [1/kg]
    LaneVec3<T> normal[K];         // unit vector; zero for unused contacts
    LaneVec3<T> free_velocity[K];  // q, velocity without impulses [m/s]
    LaneVec3<T> impulse[K];        // start value as input, then the solution [N s]
    T diagonal[K];                 // mobility D of docs/methods/contact.md 2.1; zero for unused contacts [1/kg]
    T inverse_diagonal[K];         // 1/D; zero for unused contacts [kg]
    T friction[K];
    T scale;      // number by which the norm of the residual is divided, which gives the error e_nat [sqrt(J)]
    T tolerance;  // tolerance of e_nat
};

/// Input data of one region.
struct LaneRegion {
    std::span<const LumpedContact> contact;
    std::span<const Vec4> free_velocity;  // by contact: q, velocity without impulses [m/s]
    std::span<Vec4> impulse;              // [N s]
    std::size_t node_count;
    Real scale, tolerance;
};

inline void set_lane(Real& all, int, Real value) {
    all = value;
}
inline void set_lane(Real8& all, int lane, Real value) {
    all[lane] = value;
}
inline Real lane_of(const Real& all, int) {
    return all;
}
inline Real lane_of(const Real8& all, int lane) {
    return all[lane];
}

template <class T>
void set_lane(LaneVec3<T>& all, int lane, const Vec4& value) {
    set_lane(all.x, lane, value[0]);
    set_lane(all.y, lane, value[1]);
    set_lane(all.z, lane, value[2]);
}
template <class T>
Vec4 lane_of(const LaneVec3<T>& all, int lane) {
    return {lane_of(all.x, lane), lane_of(all.y, lane), lane_of(all.z, lane), 0};
}

/// Writes the matrix C = J M^-1 J^T of the region into its lane, with the stencil weights J and the lumped masses M.
/// Matrix entries of unused contacts keep their values.
template <class T, int K>
void fill_coupling(const LaneRegion& region, int lane, LaneProblem<T, K>& problem) {
    std::array<Real, 4 * K> step;  // by node: velocity change per unit impulse of contact i [1/kg]
    std::fill_n(step.begin(), region.node_count, 0);
    for (std::size_t i = 0; i < region.contact.size(); ++i) {
        const LumpedContact& one = region.contact[i];
        for (Index a = 0; a < one.node_count; ++a) step[one.node[a]] += one.step[a];
        for (std::size_t j = 0; j <= i; ++j) {
            const LumpedContact& other = region.contact[j];
            Real coupling = 0;
            for (Index b = 0; b < other.node_count; ++b) coupling += other.weight[b] * step[other.node[b]];
            set_lane(problem.coupling[i][j], lane, coupling);
            set_lane(problem.coupling[j][i], lane, coupling);
        }
        for (Index a = 0; a < one.node_count; ++a) step[one.node[a]] = 0;
    }
}

/// Resets the problem, so that unused lanes and contacts have zero impulses. In unused lanes, the scale 1 avoids an
/// error of 0 / 0.
template <class T, int K>
void clear(LaneProblem<T, K>& problem) {
    problem = LaneProblem<T, K>();
    problem.scale = T{} + 1;
}

template <class T, int K>
void fill_lane(const LaneRegion& region, int lane, LaneProblem<T, K>& problem) {
    fill_coupling(region, lane, problem);
    set_lane(problem.scale, lane, region.scale);
    set_lane(problem.tolerance, lane, region.tolerance);
    for (std::size_t i = 0; i < region.contact.size(); ++i) {
        const LumpedContact& contact = region.contact[i];
        if (contact.node_count == 0) continue;  // an impulse of this contact moves no node
        set_lane(problem.normal[i], lane, contact.normal);
        set_lane(problem.free_velocity[i], lane, region.free_velocity[i]);
        set_lane(problem.impulse[i], lane, region.impulse[i]);
        set_lane(problem.diagonal[i], lane, contact.diagonal);
        set_lane(problem.inverse_diagonal[i], lane, contact.inverse_diagonal);
        set_lane(problem.friction[i], lane, contact.friction.stick);
    }
}

}  // namespace skerry
