#include "systems/dynamics/checks/find_inversions.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "components/check.h"
#include "components/prefetch_lines.h"
#include "jobs/parallel_for.h"
#include "systems/dynamics/elements/element_block.h"
#include "systems/geometry/lane_mask.h"

namespace skerry {

namespace {

// A large body is divided into parts of at most this number of blocks of tetrahedra. Several small bodies share a job,
// up to this number of blocks.
constexpr Index blocks_per_part = 256;

// For a block with narrow tetrahedra, the width (least distance of two parallel planes that enclose a tetrahedron) is
// computed only once in this number of checks, because it takes half of the time of a check.
constexpr std::uint8_t checks_at_narrow = 8;

// Number of blocks whose travel budgets (distances that the body may move without a check) are compared together,
// without a branch for each block.
constexpr std::size_t blocks_at_once = 32;

Real8 squared(const LaneVec3<Real8>& v) {
    return dot(v, v);
}

Real8 larger(const Real8& a, const Real8& b) {
    return a > b ? a : b;
}

/// Largest squared cross product of two edges of a tetrahedron, over its four faces and its three pairs of opposite
/// edges [m^4]. The nearest two parallel planes that enclose a tetrahedron are parallel to one of these seven pairs of
/// edges.
Real8 largest_cross_squared(const LaneMat3<Real8>& e) {
    const LaneVec3<Real8> e01 = e.c1 - e.c0, e02 = e.c2 - e.c0, e12 = e.c2 - e.c1;
    const Real8 faces = larger(larger(squared(cross(e.c0, e.c1)), squared(cross(e.c1, e.c2))),
                               larger(squared(cross(e.c2, e.c0)), squared(cross(e01, e02))));
    const Real8 pairs = larger(larger(squared(cross(e.c0, e12)), squared(cross(e.c1, e02))), squared(cross(e.c2, e01)));
    return larger(faces, pairs);
}

/// Width of the narrowest tetrahedron of a block [m]. The width of a tetrahedron is the least distance of two parallel
/// planes that enclose it: |determinant of the edges| / largest cross product. Inverted tetrahedra are included,
/// because they may become positive and invert again.
Real width(const LaneMat3<Real8>& edges, const ElementLane& rest_volume) {
    const Real8 volume = determinant(edges), span = largest_cross_squared(edges);
    const Real8 unused = Real8{} + infinity;
    const Real8 squared_width = span > 0.0 ? volume * volume / span : Real8{};
    const Real8 used_squared = load(rest_volume) > 0.0 ? squared_width : unused;  // m^2
    Real least = used_squared[0];
    for (std::size_t l = 1; l < element_lanes; ++l) least = std::min(least, used_squared[l]);
    return std::sqrt(least);
}

/// Inversion check of one body in one step.
struct BodyCheck {
    const InversionInputs& inputs;
    Real h;
    Real reach;         // upper bound on the motion of a node in this step, in the frame of the body [m]
    Real travel_bound;  // upper bound on the travel of the body at the end of this step [m]
    // While the travel of the body is at most travel_base + d, each node stays within the distance d of its present
    // position in the frame of the body. The travel is the sum of the changes of BodyTable::displacement
    // (measure_displacement.h) [m].
    Real travel_base;

    BodyCheck(const InversionInputs& all_inputs, Real step, Index body)
        : inputs(all_inputs),
          h(step),
          reach(step * all_inputs.body_frame_speed[body]),
          travel_bound(all_inputs.body_travel[body] + reach),
          travel_base(all_inputs.body_travel[body] - 2 * all_inputs.body_displacement[body]) {}

    void check(InversionPart& part, std::span<Real> uninverted_until, std::span<std::uint8_t> checks_left) const {
        // All blocks to be checked are prefetched before the first check, because they have left the cache since the
        // last step.
        std::array<std::size_t, blocks_per_part> due;
        std::size_t due_count = 0;
        SKERRY_CHECK(static_cast<std::size_t>(part.blocks.size()) <= due.size());
        for_each_group(part.blocks, [&](std::size_t b, std::size_t stop) {
            if (travel_bound < least(uninverted_until, b, stop)) return;
            for (std::size_t i = b; i < stop; ++i) {
                if (travel_bound < uninverted_until[i]) continue;
                due[due_count++] = i;
                prefetch_lines(&inputs.tetrahedron_node[i], 1);
                prefetch_lines(&inputs.tetrahedron_volume[i], 1);
            }
        });
        for (std::size_t k = 0; k < due_count; ++k)
            check_block(due[k], uninverted_until[due[k]], checks_left[due[k]], part);
        for_each_group(part.blocks, [&](std::size_t b, std::size_t stop) {
            part.uninverted_until = std::min(part.uninverted_until, least(uninverted_until, b, stop));
        });
    }

    bool has_inverted(Range blocks) const {
        for (auto b = static_cast<std::size_t>(blocks.begin); b < static_cast<std::size_t>(blocks.end); ++b) {
            const Real8 volume = determinant(edges(inputs.tetrahedron_node[b], inputs.position));
            for (std::size_t l = 0; l < element_lanes; ++l)
                if (inputs.tetrahedron_volume[b][l] > 0 && !(volume[l] > 0) && is_harmful(b, l)) return true;
        }
        return false;
    }

private:
    /// True for tetrahedra whose inversion matters. Inversion is harmless in tetrahedra that implicit elements cover
    /// (leeway above 1), because implicit elements never make a step unstable. It is also harmless in slivers, whose
    /// volume is negligible.
    bool is_harmful(std::size_t b, std::size_t l) const {
        if (!inputs.tetrahedron_sliver.empty() && (inputs.tetrahedron_sliver[b] >> l & 1U) != 0) return false;
        return inputs.tetrahedron_leeway.empty() || inputs.tetrahedron_leeway[b][l] <= 1;
    }

    /// Calls visit(begin, end) for consecutive groups of at most blocks_at_once blocks.
    static void for_each_group(Range blocks, auto&& visit) {
        const auto end = static_cast<std::size_t>(blocks.end);
        for (auto b = static_cast<std::size_t>(blocks.begin); b < end; b += blocks_at_once)
            visit(b, std::min(b + blocks_at_once, end));
    }

    static Real least(std::span<const Real> column, std::size_t begin, std::size_t end) {
        Real least = infinity;
        const Real* const value = column.data();
#pragma omp simd reduction(min : least)
        for (std::size_t i = begin; i < end; ++i) least = value[i] < least ? value[i] : least;
        return least;
    }

    void check_block(std::size_t b, Real& uninverted_until, std::uint8_t& checks_left, InversionPart& part) const {
        const LaneMat3<Real8> now = edges(inputs.tetrahedron_node[b], inputs.position);
        if (checks_left > 0) {
            --checks_left;
        } else {
            const Real safe_distance = width(now, inputs.tetrahedron_volume[b]) / 2;
            uninverted_until = travel_base + safe_distance;
            if (reach < safe_distance) return;
            checks_left = checks_at_narrow - 1;
        }
        find_inverting(b, now, part);
    }

    void find_inverting(std::size_t b, const LaneMat3<Real8>& now, InversionPart& part) const {
        LaneMat3<Real8> motion = edges(inputs.tetrahedron_node[b], inputs.velocity_next);
        if (!inputs.push_out.empty()) motion = motion + edges(inputs.tetrahedron_node[b], inputs.push_out);
        const Real8 before = determinant(now), after = determinant(now + h * motion);
        const unsigned turned = bits_of((load(inputs.tetrahedron_volume[b]) > 0.0) & (before > 0.0) & ~(after > 0.0));
        for_each_lane(turned, [&](std::size_t l) {
            part.is_harmful |= is_harmful(b, l);
            if (part.count++ == 0) part.tetrahedron = static_cast<Index>(b * element_lanes + l);
        });
    }
};

/// Finds the bodies that may have moved far enough for an inversion, splits them into parts, and groups the parts into
/// jobs.
void list_parts(const InversionInputs& inputs, Real h, std::span<const Real> body_uninverted_until,
                InversionMemory& memory) {
    memory.part.clear();
    memory.job.clear();
    // With this capacity later steps allocate nothing, whichever bodies they check.
    const std::size_t max_parts = inputs.tetrahedron_node.size() / blocks_per_part + inputs.body_blocks.size();
    memory.part.reserve(max_parts);
    memory.job.reserve(max_parts + 1);
    Index open = blocks_per_part;  // number of blocks in the last job; begins full, so that the first part begins a job
    for (Index b = 0; b < static_cast<Index>(inputs.body_blocks.size()); ++b) {
        const Range blocks = inputs.body_blocks[b];
        if (inputs.body_travel[b] + h * inputs.body_frame_speed[b] < body_uninverted_until[b]) continue;
        if (!inputs.body_rigid.empty() && inputs.body_rigid[b].size() > 0) continue;
        for (Index first = blocks.begin; first < blocks.end; first += blocks_per_part) {
            const Range part_blocks{first, std::min(first + blocks_per_part, blocks.end)};
            if (open + part_blocks.size() > blocks_per_part) {
                memory.job.push_back(static_cast<Index>(memory.part.size()));
                open = 0;
            }
            open += part_blocks.size();
            memory.part.push_back({b, part_blocks, infinity});
        }
    }
    memory.job.push_back(static_cast<Index>(memory.part.size()));
}

/// Adds the results of the parts of one body to `found`, which already contains the results of all earlier bodies.
void add_body(const InversionInputs& inputs, Real h, std::span<const InversionPart> parts, Real& uninverted_until,
              Inversions& found) {
    const Index body = parts.front().body;
    bool is_harmful = false;
    uninverted_until = infinity;
    for (const InversionPart& part : parts) {
        uninverted_until = std::min(uninverted_until, part.uninverted_until);
        if (part.count == 0) continue;
        is_harmful |= part.is_harmful;
        if (found.count == 0) found = {0, body, part.tetrahedron, false};
        found.count += part.count;
    }
    if (is_harmful) found.is_first_of_body |= !BodyCheck(inputs, h, body).has_inverted(inputs.body_blocks[body]);
}

}  // namespace

Inversions find_inversions(Executor& executor, const InversionInputs& inputs, Real h, InversionMemory& memory,
                           const InversionBudgets& budgets) {
    SKERRY_CHECK(budgets.body_uninverted_until.size() == inputs.body_blocks.size());
    SKERRY_CHECK(budgets.block_uninverted_until.size() == inputs.tetrahedron_node.size());
    list_parts(inputs, h, budgets.body_uninverted_until, memory);
    memory.checks_left.resize(inputs.tetrahedron_node.size());
    const std::span<std::uint8_t> checks_left = memory.checks_left.span();
    Column<InversionPart>& parts = memory.part;
    parallel_for(executor, memory.job.size() - 1, 1, [&](std::size_t begin, std::size_t end) {
        for (Index p = memory.job[begin]; p < memory.job[end]; ++p)
            BodyCheck(inputs, h, parts[p].body).check(parts[p], budgets.block_uninverted_until, checks_left);
    });
    Inversions found;
    for (std::size_t first = 0, next = 0; first < parts.size(); first = next) {
        while (next < parts.size() && parts[next].body == parts[first].body) ++next;
        add_body(inputs, h, std::span(parts.data() + first, next - first),
                 budgets.body_uninverted_until[static_cast<std::size_t>(parts[first].body)], found);
    }
    return found;
}

}  // namespace skerry
