#include "systems/dynamics/stability/element_levels.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "components/check.h"

namespace skerry {

namespace {

struct Search {
    const ElementInputs& elements;
    Range blocks;
    std::span<const Vec3> position;
    std::span<const Real> mass;
    std::span<Real> stiffness_sum;

    template <class Visit>
    void for_each_block(Visit&& visit) const {
        for (Index b = blocks.begin; b < blocks.end; ++b)
            visit(static_cast<std::size_t>(b), static_cast<std::size_t>(b - blocks.begin) * element_lanes);
    }
};

using Bounds = std::vector<Real>;  // 1/s^2, of omega^2 by lane

/// What each element does alone, with all the mass of its nodes.
Bounds bounds_alone(const Search& search) {
    Bounds bounds(static_cast<std::size_t>(search.blocks.size()) * element_lanes);
    LaneQuaternion<Real8> q{Real8{} + 1.0, {}, {}, {}};
    search.for_each_block([&](std::size_t b, std::size_t first) {
        const LaneMat3<Real8> F = deformation_of(search.elements, b, search.position);
        const Real8 bound = frequency_squared_of(search.elements, b, F, search.mass, {}, q);
        for (std::size_t l = 0; l < element_lanes; ++l) bounds[first + l] = bound[l];
    });
    return bounds;
}

/// Bounds of the elements of at least this level, which share all mass among themselves.
void share(const Search& search, std::span<const std::uint8_t> level, int least, Bounds& bounds) {
    search.for_each_block(
        [&](std::size_t b, std::size_t) { clear_stiffness(search.elements, b, search.stiffness_sum); });
    search.for_each_block([&](std::size_t b, std::size_t first) {
        add_stiffness(search.elements, b, deformation_of(search.elements, b, search.position), search.stiffness_sum,
                      [&](std::size_t l) { return level[first + l] >= least; });
    });
    LaneQuaternion<Real8> q{Real8{} + 1.0, {}, {}, {}};
    search.for_each_block([&](std::size_t b, std::size_t first) {
        const LaneMat3<Real8> F = deformation_of(search.elements, b, search.position);
        const Real8 bound = frequency_squared_of(search.elements, b, F, search.mass, search.stiffness_sum, q);
        for (std::size_t l = 0; l < element_lanes; ++l) bounds[first + l] = bound[l];
    });
}

/// Takes down the few elements of the highest levels, where that costs next to nothing: a gap of levels less is worth
/// more.
void drop_thin_levels(std::span<const ElementLane> volume, std::span<std::uint8_t> level) {
    std::array<Real, element_level_count> count{};
    for (std::size_t e = 0; e < level.size(); ++e) count[level[e]] += volume[e / element_lanes][e % element_lanes] > 0;
    Real cost = 0;  // impulses a step
    for (int l = 0; l < element_level_count; ++l) cost += std::ldexp(count[static_cast<std::size_t>(l)], -l);
    constexpr Real worth_a_level = 0.05;  // of all impulses
    Real above = 0;
    int top = element_level_count - 1;
    for (; top > 0; --top) {
        above += count[static_cast<std::size_t>(top)];
        if (std::ldexp(above, -(top - 1)) - std::ldexp(above, -top) > worth_a_level * cost) break;
    }
    for (std::uint8_t& l : level) l = std::min(l, static_cast<std::uint8_t>(top));
}

/// Takes down elements at the border of another material whose elements are two levels finer or more, to the level of
/// those. Their impulses would come at nodes that belong to the modes of all of the stiff side, and be in time with
/// some.
void refine_borders(const Search& search, std::span<std::uint8_t> level) {
    const auto material_of = [&](std::size_t b) { return search.elements.material[b]; };
    const auto for_each_node = [&](std::size_t b, std::size_t l, auto&& visit) {
        const BlockNodes nodes = search.elements.nodes_of(b);
        for (Index k = 0; k < nodes.count; ++k) visit(static_cast<std::size_t>(nodes.node[k][l]));
    };
    std::vector<Index> materials(search.elements.material.begin() + search.blocks.begin,
                                 search.elements.material.begin() + search.blocks.end);
    std::ranges::sort(materials);
    materials.erase(std::unique(materials.begin(), materials.end()), materials.end());
    if (materials.size() < 2) return;
    constexpr std::uint8_t none = element_level_count;
    const std::vector<std::uint8_t> found(level.begin(), level.end());
    std::vector<std::uint8_t> finest(search.position.size());
    for (const Index material : materials) {
        std::ranges::fill(finest, none);
        search.for_each_block([&](std::size_t b, std::size_t first) {
            if (material_of(b) != material) return;
            for (std::size_t l = 0; l < element_lanes; ++l)
                if (search.elements.volume[b][l] > 0)
                    for_each_node(b, l, [&](std::size_t n) { finest[n] = std::min(finest[n], found[first + l]); });
        });
        search.for_each_block([&](std::size_t b, std::size_t first) {
            if (material_of(b) == material) return;
            for (std::size_t l = 0; l < element_lanes; ++l)
                for_each_node(b, l, [&](std::size_t n) {
                    if (finest[n] + 2 <= found[first + l]) level[first + l] = std::min(level[first + l], finest[n]);
                });
        });
    }
}

}  // namespace

void find_element_levels(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                         std::span<const Real> mass, Real step, std::span<Real> stiffness_sum,
                         std::span<std::uint8_t> level) {
    SKERRY_CHECK(level.size() == static_cast<std::size_t>(blocks.size()) * element_lanes);
    const Search search{elements, blocks, position, mass, stiffness_sum};
    const Bounds alone = bounds_alone(search);
    Bounds shared(alone.size());
    std::fill(level.begin(), level.end(), std::uint8_t{0});
    // Those that fail are taken out in rounds, the stiffest by themselves first: their neighbours often pass once they
    // are gone.
    constexpr Real stiff_alone[] = {0.5, 0.125, 0.03125, 0};  // of the limit; in the last round all that fail go
    for (int target = 1; target < element_level_count; ++target) {
        const Real omega = step_of_level(step_times_frequency / step, target), limit = omega * omega;
        bool any = false;
        for (std::size_t e = 0; e < level.size(); ++e) {
            const Real volume =
                elements.volume[static_cast<std::size_t>(blocks.begin) + e / element_lanes][e % element_lanes];
            if (level[e] != target - 1 || !(volume > 0)) continue;
            level[e] = static_cast<std::uint8_t>(target);
            any = true;
        }
        if (!any) break;
        for (const Real stiff : stiff_alone) {
            share(search, level, target, shared);
            bool all_pass = true;
            for (std::size_t e = 0; e < level.size(); ++e) {
                if (level[e] != target || shared[e] <= limit) continue;
                all_pass = false;
                if (alone[e] > stiff * limit || stiff == 0) level[e] = static_cast<std::uint8_t>(target - 1);
            }
            if (all_pass) break;
        }
    }
    drop_thin_levels(
        elements.volume.subspan(static_cast<std::size_t>(blocks.begin), static_cast<std::size_t>(blocks.size())),
        level);
    refine_borders(search, level);
}

void find_viscous_times(std::span<const std::uint8_t> block_level, Real step, std::span<Real> viscous_time) {
    constexpr Real damping_ratio = 0.02;
    const int top = block_level.empty() ? 0 : block_level.back();
    for (std::size_t b = 0; b < block_level.size(); ++b) {
        const int level = block_level[b];
        const bool fine = top > 0 && (level == 0 || level <= top - 2);
        viscous_time[b] = fine ? 2 * damping_ratio * step * static_cast<Real>(1 << level) / step_times_frequency : 0;
    }
}

}  // namespace skerry
