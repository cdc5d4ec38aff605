// What the kernels do with a block of element_lanes tetrahedra: fetch its corners, form F, spread its forces.
#pragma once

#include <cstring>
#include <span>

#include "components/element_table.h"
#include "systems/material/lane_math.h"

namespace skerry {

/// Four reals: a position and whatever follows it.
typedef Real Real4 __attribute__((vector_size(4 * sizeof(Real))));

inline Real4 load_position(const Vec3* at) {
    Real4 p;
    std::memcpy(&p, static_cast<const void*>(at), sizeof p);
    return p;
}

/// Positions of one corner of all lanes as (x, y, z, next node's x) of lanes 0 4, 1 5, 2 6, 3 7. A full-width load per
/// node and a few shuffles, in place of three gathers, which cost a load per lane each.
struct CornerPairs {
    Real8 p04, p15, p26, p37;
};

[[gnu::always_inline]] inline CornerPairs load_corner(const Lanes<Index, element_lanes>& node, const Vec3* position) {
    const auto pair = [&](std::size_t l) {
        return __builtin_shufflevector(load_position(position + node[l]), load_position(position + node[l + 4]), 0, 1,
                                       2, 3, 4, 5, 6, 7);
    };
    return {pair(0), pair(1), pair(2), pair(3)};
}

/// The same for a block that touches the last node: nothing follows its position.
[[gnu::noinline]] inline CornerPairs load_corner_near_end(const Lanes<Index, element_lanes>& node,
                                                          const Vec3* position) {
    const auto pair = [&](std::size_t l) {
        const Vec3 &a = position[node[l]], &b = position[node[l + 4]];
        return Real8{a[0], a[1], a[2], 0, b[0], b[1], b[2], 0};
    };
    return {pair(0), pair(1), pair(2), pair(3)};
}

/// Corner minus corner 0, lanes side by side.
[[gnu::always_inline]] inline LaneVec3<Real8> edge(const CornerPairs& corner, const CornerPairs& corner0) {
    const Real8 d04 = corner.p04 - corner0.p04, d15 = corner.p15 - corner0.p15;
    const Real8 d26 = corner.p26 - corner0.p26, d37 = corner.p37 - corner0.p37;
    const Real8 low01 = __builtin_shufflevector(d04, d15, 0, 8, 2, 10, 4, 12, 6, 14);   // x0 x1 z0 z1 x4 x5 z4 z5
    const Real8 high01 = __builtin_shufflevector(d04, d15, 1, 9, 3, 11, 5, 13, 7, 15);  // y0 y1 .. .. y4 y5 .. ..
    const Real8 low23 = __builtin_shufflevector(d26, d37, 0, 8, 2, 10, 4, 12, 6, 14);
    const Real8 high23 = __builtin_shufflevector(d26, d37, 1, 9, 3, 11, 5, 13, 7, 15);
    return {__builtin_shufflevector(low01, low23, 0, 1, 8, 9, 4, 5, 12, 13),
            __builtin_shufflevector(high01, high23, 0, 1, 8, 9, 4, 5, 12, 13),
            __builtin_shufflevector(low01, low23, 2, 3, 10, 11, 6, 7, 14, 15)};
}

/// The columns of Ds: corners 1 to 3 minus corner 0.
[[gnu::always_inline]] inline LaneMat3<Real8> edges(const ElementNodes& node, std::span<const Vec3> position) {
    Index highest = 0;
    for (std::size_t a = 0; a < 4; ++a)
        for (std::size_t l = 0; l < element_lanes; ++l) highest = node[a][l] > highest ? node[a][l] : highest;
    if (static_cast<std::size_t>(highest) + 1 < position.size()) [[likely]] {
        const CornerPairs corner0 = load_corner(node[0], position.data());
        return {edge(load_corner(node[1], position.data()), corner0),
                edge(load_corner(node[2], position.data()), corner0),
                edge(load_corner(node[3], position.data()), corner0)};
    }
    const CornerPairs corner0 = load_corner_near_end(node[0], position.data());
    return {edge(load_corner_near_end(node[1], position.data()), corner0),
            edge(load_corner_near_end(node[2], position.data()), corner0),
            edge(load_corner_near_end(node[3], position.data()), corner0)};
}

/// F = Ds B.
[[gnu::always_inline]] inline LaneMat3<Real8> deformation_gradient(const LaneMat3<Real8>& Ds, const ElementRest& B) {
    return {load(B[0]) * Ds.c0 + load(B[1]) * Ds.c1 + load(B[2]) * Ds.c2,
            load(B[3]) * Ds.c0 + load(B[4]) * Ds.c1 + load(B[5]) * Ds.c2,
            load(B[6]) * Ds.c0 + load(B[7]) * Ds.c1 + load(B[8]) * Ds.c2};
}

/// Four components of the forces of all lanes, lane l to out + 12 l: a 4 x 8 transpose.
[[gnu::always_inline]] inline void spread(const Real8& a, const Real8& b, const Real8& c, const Real8& d, Real* out) {
    const Real8 ab_even = __builtin_shufflevector(a, b, 0, 8, 2, 10, 4, 12, 6, 14),
                ab_odd = __builtin_shufflevector(a, b, 1, 9, 3, 11, 5, 13, 7, 15);
    const Real8 cd_even = __builtin_shufflevector(c, d, 0, 8, 2, 10, 4, 12, 6, 14),
                cd_odd = __builtin_shufflevector(c, d, 1, 9, 3, 11, 5, 13, 7, 15);
    const auto store_pair = [&](const Real8& two, int low, int high) {
        const Real4 first = __builtin_shufflevector(two, two, 0, 1, 2, 3),
                    second = __builtin_shufflevector(two, two, 4, 5, 6, 7);
        std::memcpy(out + 12 * low, &first, sizeof first);
        std::memcpy(out + 12 * high, &second, sizeof second);
    };
    store_pair(__builtin_shufflevector(ab_even, cd_even, 0, 1, 8, 9, 4, 5, 12, 13), 0, 4);
    store_pair(__builtin_shufflevector(ab_odd, cd_odd, 0, 1, 8, 9, 4, 5, 12, 13), 1, 5);
    store_pair(__builtin_shufflevector(ab_even, cd_even, 2, 3, 10, 11, 6, 7, 14, 15), 2, 6);
    store_pair(__builtin_shufflevector(ab_odd, cd_odd, 2, 3, 10, 11, 6, 7, 14, 15), 3, 7);
}

/// (f1 f2 f3) = -V P B^T and f0 = -(f1 + f2 + f3), corner by corner into `force`.
[[gnu::always_inline]] inline void spread_forces(const LaneMat3<Real8>& P, const ElementRest& B, const Real8& volume,
                                                 ElementForces& force) {
    const LaneMat3<Real8> Q = (-volume) * P;
    const LaneVec3<Real8> f1 = load(B[0]) * Q.c0 + load(B[3]) * Q.c1 + load(B[6]) * Q.c2;
    const LaneVec3<Real8> f2 = load(B[1]) * Q.c0 + load(B[4]) * Q.c1 + load(B[7]) * Q.c2;
    const LaneVec3<Real8> f3 = load(B[2]) * Q.c0 + load(B[5]) * Q.c1 + load(B[8]) * Q.c2;
    const LaneVec3<Real8> f0{-(f1.x + f2.x + f3.x), -(f1.y + f2.y + f3.y), -(f1.z + f2.z + f3.z)};
    Real* out = force[0][0].data();
    spread(f0.x, f0.y, f0.z, f1.x, out);
    spread(f1.y, f1.z, f2.x, f2.y, out + 4);
    spread(f2.z, f3.x, f3.y, f3.z, out + 8);
}

}  // namespace skerry
