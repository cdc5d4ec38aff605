// Kernel operations on a block of elements: fetch the node positions, form F, add the forces to the nodes. A block is
// computed in register-wide parts: one part of eight lanes or two parts of four. Loops over the parts are unrolled,
// because gcc keeps the entries of an array in registers only if every index is a constant.
#pragma once

#ifdef __AVX512VL__
#include <immintrin.h>
#endif

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include "components/computed_here.h"
#include "components/element_table.h"
#include "systems/material/lane_math.h"

namespace skerry {

/// Loads a position and the number that follows it in memory.
[[gnu::always_inline]] inline Real4 load_position(const Vec3* at) {
    return half_at(at->data());
}
[[gnu::always_inline]] inline Real4 load_position(const PaddedVec3* at) {
    return *reinterpret_cast<const Real4*>(at->lane);
}

/// Positions of the nodes of a patch, or forces on these nodes; each node has a PaddedVec3. A slot
/// (ElementNodeTable::slot) is not the index of a PaddedVec3, but the offset of its first number, because processors
/// scale an index by at most eight bytes, and a PaddedVec3 is longer.
template <class Number>
struct PatchRows {
    Number* first;

    const PaddedVec3* operator+(Index slot) const { return reinterpret_cast<const PaddedVec3*>(first + slot); }
    Real4& operator[](std::ptrdiff_t slot) const requires(!std::is_const_v<Number>) {
        return *reinterpret_cast<Real4*>(first + slot);
    }
};

/// CornerPositions: positions of one corner of all elements in a register-wide part of a block, in the order that the
/// transposes in edge() need. One full-width load per position and a few shuffles replace three gathers, each of which
/// takes one load per lane.
#ifdef __AVX512VL__
// Halves of registers are moved with intrinsics, because for __builtin_shufflevector gcc shuffles the whole register.

/// Each entry holds (x, y, z, next node's x) of two lanes: 0 and 4, 1 and 5, 2 and 6, 3 and 7.
struct CornerPositions {
    Real8 pair[4];
};

template <class Positions>
[[gnu::always_inline]] inline CornerPositions load_corner(const NodeLane& node, std::size_t, Positions position) {
    const auto pair = [&](std::size_t l) {
        return Real8(_mm512_insertf64x4(_mm512_castpd256_pd512(load_position(position + node[l])),
                                        load_position(position + node[l + 4]), 1));
    };
    return {{pair(0), pair(1), pair(2), pair(3)}};
}

/// Variant of load_corner for a block that contains the last node. The position of this node ends the array, and
/// load_position() would read beyond the end.
[[gnu::noinline]] inline CornerPositions load_corner_near_end(const NodeLane& node, std::size_t, const Vec3* position) {
    const auto pair = [&](std::size_t l) {
        const Vec3 &a = position[node[l]], &b = position[node[l + 4]];
        return Real8{a[0], a[1], a[2], 0, b[0], b[1], b[2], 0};
    };
    return {{pair(0), pair(1), pair(2), pair(3)}};
}

/// Position of a corner minus the position of corner 0. Each component holds all lanes.
[[gnu::always_inline]] inline LaneVec3<Real8> edge(const CornerPositions& corner, const CornerPositions& corner0) {
    const Real8 d04 = corner.pair[0] - corner0.pair[0], d15 = corner.pair[1] - corner0.pair[1];
    const Real8 d26 = corner.pair[2] - corner0.pair[2], d37 = corner.pair[3] - corner0.pair[3];
    // After the transposes, low01 contains x0 x1 z0 z1 x4 x5 z4 z5 and high01 contains y0 y1 .. .. y4 y5 .. .. (letters
    // are components, digits are lanes, .. is not used).
    const Real8 low01 = __builtin_shufflevector(d04, d15, 0, 8, 2, 10, 4, 12, 6, 14);
    const Real8 high01 = __builtin_shufflevector(d04, d15, 1, 9, 3, 11, 5, 13, 7, 15);
    const Real8 low23 = __builtin_shufflevector(d26, d37, 0, 8, 2, 10, 4, 12, 6, 14);
    const Real8 high23 = __builtin_shufflevector(d26, d37, 1, 9, 3, 11, 5, 13, 7, 15);
    return {__builtin_shufflevector(low01, low23, 0, 1, 8, 9, 4, 5, 12, 13),
            __builtin_shufflevector(high01, high23, 0, 1, 8, 9, 4, 5, 12, 13),
            __builtin_shufflevector(low01, low23, 2, 3, 10, 11, 6, 7, 14, 15)};
}
#else
struct CornerPositions {
    Real4 lane[4];  // x, y, z of a node, then x of the next node
};

template <class Positions>
[[gnu::always_inline]] inline CornerPositions load_corner(const NodeLane& node, std::size_t part, Positions position) {
    const Index* const corner = node.lane + 4 * part;
    return {{load_position(position + corner[0]), load_position(position + corner[1]),
             load_position(position + corner[2]), load_position(position + corner[3])}};
}

/// Variant of load_corner for a block that contains the last node. The position of this node ends the array, and
/// load_position() would read beyond the end.
[[gnu::noinline]] inline CornerPositions load_corner_near_end(const NodeLane& node, std::size_t part,
                                                              const Vec3* position) {
    const auto at = [&](std::size_t l) {
        const Vec3& p = position[node[4 * part + l]];
        return Real4{p[0], p[1], p[2], 0};
    };
    return {{at(0), at(1), at(2), at(3)}};
}

/// Position of a corner minus the position of corner 0. Each component holds all lanes.
[[gnu::always_inline]] inline LaneVec3<Real4> edge(const CornerPositions& corner, const CornerPositions& corner0) {
    const Real4 d0 = corner.lane[0] - corner0.lane[0], d1 = corner.lane[1] - corner0.lane[1];
    const Real4 d2 = corner.lane[2] - corner0.lane[2], d3 = corner.lane[3] - corner0.lane[3];
    // After the transposes, low01 contains x0 x1 z0 z1 and high01 contains y0 y1 .. .. (letters are components, digits
    // are lanes, .. is not used).
    const Real4 low01 = __builtin_shufflevector(d0, d1, 0, 4, 2, 6);
    const Real4 high01 = __builtin_shufflevector(d0, d1, 1, 5, 3, 7);
    const Real4 low23 = __builtin_shufflevector(d2, d3, 0, 4, 2, 6);
    const Real4 high23 = __builtin_shufflevector(d2, d3, 1, 5, 3, 7);
    return {__builtin_shufflevector(low01, low23, 0, 1, 4, 5), __builtin_shufflevector(high01, high23, 0, 1, 4, 5),
            __builtin_shufflevector(low01, low23, 2, 3, 6, 7)};
}
#endif

/// Calls part_of_block(part) for each register-wide part of a block, and joins the results to one matrix for all lanes.
template <class Part>
[[gnu::always_inline]] inline LaneMat3<Real8> joined(Part&& part_of_block) {
    if constexpr (kernel_parts == 1) {
        return part_of_block(0);
    } else {
        Lanes<Real, element_lanes> all[9];
        for (std::size_t part = 0; part < kernel_parts; ++part) {
            const LaneMat3<KernelReal> gradient = part_of_block(part);
            const KernelReal entry[9] = {gradient.c0.x, gradient.c0.y, gradient.c0.z, gradient.c1.x, gradient.c1.y,
                                         gradient.c1.z, gradient.c2.x, gradient.c2.y, gradient.c2.z};
            for (std::size_t i = 0; i < 9; ++i) store_part(entry[i], all[i], part);
        }
        return {{load(all[0]), load(all[1]), load(all[2])},
                {load(all[3]), load(all[4]), load(all[5])},
                {load(all[6]), load(all[7]), load(all[8])}};
    }
}

/// True if no node of the block is the last of `position`, so that another number follows every position in memory.
/// Lanes are compared side by side: finding the highest node first would take a quarter of the time of a block.
[[gnu::always_inline]] inline bool clear_of_end(const NodeLane* node, Index count, std::span<const Vec3> position) {
    typedef Index Index8 __attribute__((vector_size(sizeof(NodeLane)), may_alias));
    typedef std::int64_t Bits __attribute__((vector_size(sizeof(NodeLane))));
    const Index last = static_cast<Index>(position.size()) - 1;
    Index8 is_last{};
    for (Index k = 0; k < count; ++k) is_last |= *reinterpret_cast<const Index8*>(node[k].lane) >= last;
    const auto four = reinterpret_cast<Bits>(is_last), two = four | __builtin_shufflevector(four, four, 2, 3, 0, 1);
    return (two[0] | two[1]) == 0;
}

/// Edge vectors of the elements in one register-wide part of a block, as columns: corners 1 to 3 minus corner 0.
template <class Positions, class Load>
[[gnu::always_inline]] inline LaneMat3<KernelReal> edges_of_part(const NodeLane* node, std::size_t part,
                                                                 Positions position, Load&& load_nodes) {
    const CornerPositions corner0 = load_nodes(node[0], part, position);
    return {edge(load_nodes(node[1], part, position), corner0), edge(load_nodes(node[2], part, position), corner0),
            edge(load_nodes(node[3], part, position), corner0)};
}

/// Edge vectors of all tetrahedra of a block, as columns: corners 1 to 3 minus corner 0.
inline LaneMat3<Real8> edges(const TetrahedronNodes& node, std::span<const Vec3> position) {
    const bool clear = clear_of_end(node.data(), 4, position);
    return joined([&](std::size_t part) {
        return clear ? edges_of_part(node.data(), part, position.data(), load_corner<const Vec3*>)
                     : edges_of_part(node.data(), part, position.data(), load_corner_near_end);
    });
}

/// Loads a gradient into registers. With 512-bit registers gcc would otherwise load it from memory at each use, which
/// takes more time than the arithmetic.
template <class T>
[[gnu::always_inline]] inline LaneVec3<T> load_gradient(const ElementGradient& gradient, std::size_t part) {
    const LaneVec3<T> g{load_part<T>(gradient[0], part), load_part<T>(gradient[1], part),
                        load_part<T>(gradient[2], part)};
#ifdef __AVX512VL__
    return {computed_here(g.x), computed_here(g.y), computed_here(g.z)};
#else
    return g;
#endif
}

inline LaneVec3<Real8> load_gradient(const ElementGradient& gradient) {
    return load_gradient<Real8>(gradient, 0);
}

/// F = sum_k (x_k - x_0) (x) g_k of the elements in one register-wide part of a block, with any number of nodes. x_k
/// are the node positions, g_k the gradients at rest.
template <class Positions, class Load>
[[gnu::always_inline]] inline LaneMat3<KernelReal> gradient_of_part(const BlockNodes& block, std::size_t part,
                                                                    Positions position, Load&& load_nodes) {
    const auto gradient = [&](Index k) { return load_gradient<KernelReal>(block.gradient[k], part); };
    const CornerPositions anchor = load_nodes(block.node[0], part, position);
    const auto term = [&](Index k) __attribute__((always_inline)) {
        const LaneVec3<KernelReal> d = edge(load_nodes(block.node[k], part, position), anchor), g = gradient(k);
        return LaneMat3<KernelReal>{g.x * d, g.y * d, g.z * d};
    };
    LaneMat3<KernelReal> F = term(1);
    if (block.count == 4) {
        F = F + term(2);
        F = F + term(3);
    } else {
        for (Index k = 2; k < block.count; ++k) F = F + term(k);
    }
    return F;
}

/// Deformation gradient F of the elements in one register-wide part of a block. If `position` holds velocities, the
/// result is the rate of F.
[[gnu::always_inline]] inline LaneMat3<KernelReal> deformation_gradient(const BlockNodes& block, std::size_t part,
                                                                        std::span<const Vec3> position) {
    if (clear_of_end(block.node, block.count, position)) [[likely]]
        return gradient_of_part(block, part, position.data(), load_corner<const Vec3*>);
    return gradient_of_part(block, part, position.data(), load_corner_near_end);
}
/// Deformation gradient F of the elements in one register-wide part of a block, from the padded node positions of a
/// patch.
[[gnu::always_inline]] inline LaneMat3<KernelReal> deformation_gradient(const BlockNodes& block, std::size_t part,
                                                                        PatchRows<const Real> position) {
    return gradient_of_part(block, part, position, load_corner<PatchRows<const Real>>);
}

/// Deformation gradient F of all elements of a block. If `position` holds velocities, the result is the rate of F.
inline LaneMat3<Real8> deformation_gradient(const BlockNodes& block, std::span<const Vec3> position) {
    return joined([&](std::size_t part) { return deformation_gradient(block, part, position); });
}

/// Copies matrices for code that seldom runs. The original then stays in registers, and the compiler shares no
/// intermediate results between uses of the original and of the copy.
template <class T>
[[gnu::always_inline]] inline Parts<LaneMat3<T>> copy_of_parts(const Parts<LaneMat3<T>>& parts) {
    Parts<LaneMat3<T>> copy;
#pragma GCC unroll 2
    for (std::size_t part = 0; part < kernel_parts; ++part) {
        const LaneMat3<T>& a = parts[part];
        copy[part] = {{computed_here(a.c0.x), computed_here(a.c0.y), computed_here(a.c0.z)},
                      {computed_here(a.c1.x), computed_here(a.c1.y), computed_here(a.c1.z)},
                      {computed_here(a.c2.x), computed_here(a.c2.y), computed_here(a.c2.z)}};
    }
    return copy;
}

/// Sum over the lanes of a block. The order of the sum does not depend on the register width.
[[gnu::always_inline]] inline Real sum_of_parts(const std::array<Real4, 2>& lanes) {
    const Real4 half = lanes[0] + lanes[1];
    return (half[0] + half[1]) + (half[2] + half[3]);
}
[[gnu::always_inline]] inline Real sum_of_parts(const std::array<Real8, 1>& lanes) {
    const Real8& all = lanes[0];
    return sum_of_parts({__builtin_shufflevector(all, all, 0, 1, 2, 3), __builtin_shufflevector(all, all, 4, 5, 6, 7)});
}

/// Force Q g_k on node k, where Q is the stress times minus the volume.
[[gnu::always_inline]] inline LaneVec3<KernelReal> force_on_node(const LaneMat3<KernelReal>& Q, const BlockNodes& block,
                                                                 Index k, std::size_t part) {
    const LaneVec3<KernelReal> g = load_gradient<KernelReal>(block.gradient[k], part);
    return g.x * Q.c0 + g.y * Q.c1 + g.z * Q.c2;
}

/// Calls take(k, part, f_k) with the forces on all nodes k: f_k = Q g_k and f_0 = -(f_1 + f_2 + ...). Here g_k is the
/// gradient of the shape function of node k at rest. Q = -V P, with the rest volume V and the stress P. All parts of
/// one node come before the next node, so that the order of sums does not depend on the register width.
template <class Take>
[[gnu::always_inline]] inline void for_each_force(const Parts<LaneMat3<KernelReal>>& Q, const BlockNodes& block,
                                                  Take&& take) {
    Parts<LaneVec3<KernelReal>> sum;
    const auto on_node = [&](Index k, std::size_t part) { return force_on_node(Q[part], block, k, part); };
#pragma GCC unroll 2
    for (std::size_t part = 0; part < kernel_parts; ++part) {
        sum[part] = on_node(1, part);
        take(Index{1}, part, sum[part]);
    }
    const auto add = [&](Index k) __attribute__((always_inline)) {
#pragma GCC unroll 2
        for (std::size_t part = 0; part < kernel_parts; ++part) {
            const LaneVec3<KernelReal> f = on_node(k, part);
            take(k, part, f);
            sum[part] = sum[part] + f;
        }
    };
    if (block.count == 4) {
        add(2);
        add(3);
    } else {
        for (Index k = 2; k < block.count; ++k) add(k);
    }
#pragma GCC unroll 2
    for (std::size_t part = 0; part < kernel_parts; ++part)
        take(Index{0}, part, LaneVec3<KernelReal>{-sum[part].x, -sum[part].y, -sum[part].z});
}

/// Adds the force in lane l of f to force[slot[l]]. The lanes are added one after the other, because several lanes may
/// have the same node.
[[gnu::always_inline]] inline void add_lanes(const LaneVec3<Real4>& f, const Index* slot, PatchRows<Real> force) {
    // Contains x0 y0 x2 y2: letters are components of f, digits are lanes.
    const Real4 xy02 = __builtin_shufflevector(f.x, f.y, 0, 4, 2, 6);
    const Real4 xy13 = __builtin_shufflevector(f.x, f.y, 1, 5, 3, 7);
    // The fourth number of a force has no meaning, so z0 may be followed by z1.
    const Real4 z02 = f.z, z13 = __builtin_shufflevector(f.z, f.z, 1, 1, 3, 3);
    const auto add = [&](std::ptrdiff_t to, const Real4& lane) __attribute__((always_inline)) {
        const Real4 sum = computed_here(force[to] + lane);
        asm("" : "+r"(to));  // else gcc adds an instruction that computes the address of the load and the store
        force[to] = sum;
    };
    add(slot[0], __builtin_shufflevector(xy02, z02, 0, 1, 4, 5));
    add(slot[1], __builtin_shufflevector(xy13, z13, 0, 1, 4, 5));
    add(slot[2], __builtin_shufflevector(xy02, z02, 2, 3, 6, 7));
    add(slot[3], __builtin_shufflevector(xy13, z13, 2, 3, 6, 7));
}
#ifdef __AVX512VL__
[[gnu::always_inline]] inline void add_lanes(const LaneVec3<Real8>& f, const Index* slot, PatchRows<Real> force) {
    const auto low = [](const Real8& x) -> Real4 { return _mm512_castpd512_pd256(x); };
    const auto high = [](const Real8& x) -> Real4 { return _mm512_extractf64x4_pd(x, 1); };
    add_lanes(LaneVec3<Real4>{low(f.x), low(f.y), low(f.z)}, slot, force);
    add_lanes(LaneVec3<Real4>{high(f.x), high(f.y), high(f.z)}, slot + 4, force);
}
#endif

}  // namespace skerry
