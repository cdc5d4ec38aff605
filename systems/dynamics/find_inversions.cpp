#include "systems/dynamics/find_inversions.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "components/check.h"
#include "jobs/parallel_for.h"
#include "systems/dynamics/element_block.h"

namespace skerry {

namespace {

constexpr Index blocks_per_part = 64;

Real8 determinant(const LaneMat3<Real8>& edges) {
    return dot(edges.c0, cross(edges.c1, edges.c2));
}

Real8 squared(const LaneVec3<Real8>& v) {
    return dot(v, v);
}

Real8 larger(const Real8& a, const Real8& b) {
    return a > b ? a : b;
}

/// Four faces and three pairs of opposite edges: the planes that can be nearest are parallel to one of these.
Real8 largest_cross_squared(const LaneMat3<Real8>& e) {
    const LaneVec3<Real8> e01 = e.c1 - e.c0, e02 = e.c2 - e.c0, e12 = e.c2 - e.c1;
    const Real8 faces = larger(larger(squared(cross(e.c0, e.c1)), squared(cross(e.c1, e.c2))),
                               larger(squared(cross(e.c2, e.c0)), squared(cross(e01, e02))));
    const Real8 pairs = larger(larger(squared(cross(e.c0, e12)), squared(cross(e.c1, e02))), squared(cross(e.c2, e01)));
    return larger(faces, pairs);
}

InversionPart narrowest(const InversionInputs& inputs, std::size_t begin, std::size_t end) {
    InversionPart part;
    Real least = std::numeric_limits<Real>::infinity();  // m^2
    for (std::size_t b = begin; b < end; ++b) {
        const LaneMat3<Real8> e = edges(inputs.element_node[b], inputs.position);
        const Real8 volume = determinant(e), span = largest_cross_squared(e);
        for (std::size_t l = 0; l < element_lanes; ++l) {
            if (!(inputs.element_volume[b][l] > 0)) continue;
            // Of inverted ones, too: they may turn back, and over again.
            least = std::min(least, span[l] > 0 ? volume[l] * volume[l] / span[l] : 0);
            part.inverted |= !(volume[l] > 0);
        }
    }
    part.width = std::sqrt(least);
    return part;
}

void find_turned(const InversionInputs& inputs, Real h, std::size_t begin, std::size_t end, InversionPart& part) {
    for (std::size_t b = begin; b < end; ++b) {
        const auto& node = inputs.element_node[b];
        const LaneMat3<Real8> now = edges(node, inputs.position);
        const Real8 before = determinant(now);
        LaneMat3<Real8> motion = edges(node, inputs.velocity_next);
        if (!inputs.push_out.empty()) motion = motion + edges(node, inputs.push_out);
        const Real8 after = determinant(now + h * motion);
        for (std::size_t l = 0; l < element_lanes; ++l) {
            if (!(inputs.element_volume[b][l] > 0) || !(before[l] > 0) || after[l] > 0) continue;
            if (part.count++ == 0) part.element = static_cast<Index>(b * element_lanes + l);
        }
    }
}

template <class Visit>
void for_each_part(Executor& executor, Range blocks, Column<InversionPart>& parts, Visit&& visit) {
    parts.resize(static_cast<std::size_t>((blocks.size() + blocks_per_part - 1) / blocks_per_part));
    parallel_for(executor, parts.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t p = begin; p < end; ++p) {
            const std::size_t first = static_cast<std::size_t>(blocks.begin) + p * blocks_per_part;
            visit(first, std::min(first + blocks_per_part, static_cast<std::size_t>(blocks.end)), parts[p]);
        }
    });
}

}  // namespace

Inversions find_inversions(Executor& executor, const InversionInputs& inputs, Real h, Column<InversionPart>& parts,
                           std::span<Real> body_sound_until) {
    SKERRY_CHECK(body_sound_until.size() == inputs.body_blocks.size());
    Inversions found;
    for (std::size_t body = 0; body < body_sound_until.size(); ++body) {
        const Range blocks = inputs.body_blocks[body];
        const Real front = inputs.body_travel[body] + h * inputs.body_max_speed[body];
        if (blocks.size() == 0 || front < body_sound_until[body]) continue;
        for_each_part(executor, blocks, parts,
                      [&](std::size_t begin, std::size_t end, InversionPart& part) { part = narrowest(inputs, begin, end); });
        Real width = std::numeric_limits<Real>::infinity();
        bool inverted = false;
        for (const InversionPart& part : parts) {
            width = std::min(width, part.width);
            inverted |= part.inverted;
        }
        body_sound_until[body] = inputs.body_travel[body] - 2 * inputs.body_drift[body] + width / 2;  // measure_drift.h
        if (h * inputs.body_max_speed[body] < width / 2) continue;
        for_each_part(executor, blocks, parts,
                      [&](std::size_t begin, std::size_t end, InversionPart& part) { find_turned(inputs, h, begin, end, part); });
        for (const InversionPart& part : parts) {
            if (part.count == 0) continue;
            if (found.count == 0) found = {0, static_cast<Index>(body), part.element, false};
            found.count += part.count;
            found.first |= !inverted;
        }
    }
    return found;
}

}  // namespace skerry
