#include "systems/forces/prepare_cables.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "components/append_cable.h"
#include "components/ghost_marks.h"

namespace skerry {

namespace {

void clear(CableBlockTable& blocks) {
    blocks.for_each_column([](const char*, auto& column, ColumnRole) { column.clear(); });
    blocks.mobilities = 0;
}

/// Appends the points of a cable to those columns of `blocks` that have one row per point. Returns the appended rows.
Range list_points(const CableInputs& cables, std::size_t cable, CableBlockTable& blocks) {
    const Range points = cables.points[cable];
    const auto begin = static_cast<Index>(blocks.stencil.size());
    for (Index p = points.begin; p < points.end; ++p) {
        const auto at = static_cast<std::size_t>(p);
        Stencil stencil{};
        std::size_t count = 0;
        cables.anchor.for_each_node(at, [&](std::size_t node, Real weight) {
            stencil.node[count] = static_cast<Index>(node);
            stencil.weight[count++] = weight;
        });
        for (std::size_t a = count; a < 4; ++a) stencil.node[a] = stencil.node[0];
        append_point(stencil, count > 0 ? Vec3(Vec3::Zero()) : cables.anchor.velocity(at), blocks);
        const Vec3 here = cables.anchor.at(at), next = p + 1 < points.end ? cables.anchor.at(at + 1) : here;
        const Real length = (next - here).norm();
        blocks.length.back() = length;
        // Below this length the direction of a segment would consist of rounding errors only, so it remains zero.
        const Real shortest = 1e-14 * (here.norm() + next.norm());  // [m]
        if (length > shortest) blocks.direction.back() = (next - here) / length;
    }
    const Range listed{begin, static_cast<Index>(blocks.stencil.size())};
    const Real friction = cables.friction[cable];
    Vec3 before = blocks.direction[listed.begin];  // direction of the last segment that has a length
    for (Index p = listed.begin + 1; friction > 0 && p + 1 < listed.end; ++p) {
        const Vec3& after = blocks.direction[p];
        if (after.isZero(0)) continue;
        const Real turn = std::atan2(before.cross(after).norm(), before.dot(after));
        blocks.most_ratio[p] = std::exp(friction * turn);
        before = after;
    }
    return listed;
}

/// Greatest permitted length at the end of a step, for a cable with a prescribed rate of this length [m]. `before`:
/// greatest permitted length at the start of the step [m].
Real released_at_end(std::span<const TimeKey> keys, Real before, const CableTimes& times) {
    return std::max(Real(0), before + times.h * mean_value(keys, times.t, times.h));
}

void find_wanted_length(const CableInputs& cables, const CableTimes& times, Real length, CableBlock& block) {
    const auto c = static_cast<std::size_t>(block.cable);
    const std::span<const TimeKey> keys = cables.keys_of(c);
    Real rate = 0;
    if (cables.control[c] == CableControl::length) {
        block.released = value_at(keys, times.t + times.h);
        rate = (block.released - value_at(keys, times.t)) / times.h;
    } else {
        rate = mean_value(keys, times.t, times.h);
        block.released = released_at_end(keys, cables.released[c], times);
    }
    block.prescribed = std::max((block.released - length) / times.h, std::min(rate, Real(0)) - times.recovery_speed);
}

void add_block(const CableInputs& cables, std::size_t cable, const CableTimes& times, CableBlockTable& blocks) {
    CableBlock block{.cable = static_cast<Index>(cable),
                     .points = list_points(cables, cable, blocks),
                     .solved = !cables.has_known_forces(cable),
                     .by_length = cables.control[cable] != CableControl::tension,
                     .prescribed = 0,
                     .released = cables.released[cable],
                     .mobility = blocks.mobilities};
    const std::span<Real> impulse = rows_of(blocks.impulse, block.points);
    const std::size_t segments = impulse.size() - 1;
    if (block.by_length) {
        Real length = 0;
        for (const Real segment_length : rows_of(blocks.length, block.points)) length += segment_length;
        find_wanted_length(cables, times, length, block);
    } else {
        block.prescribed = times.kick * mean_value(cables.keys_of(cable), times.t, times.h);
        std::ranges::fill(impulse.first(segments), block.prescribed);
    }
    if (block.solved) {
        const Real scale = cables.step[cable] > 0 ? times.kick / cables.step[cable] : 0;
        const std::span<const Real> last = rows_of(cables.tension, cables.points[cable]);
        for (std::size_t s = 0; s < segments; ++s) impulse[s] = scale * last[s];
    }
    append_block(block, blocks);
}

/// Adds to the bodies at both ends of a segment an upper bound of the squared circular frequencies that its tension
/// causes [1/s^2]. The segment begins at `point`. `tension`: greatest tension [N].
void add_segment_rate(const CableInputs& cables, std::size_t point, Real tension, std::span<Real> body_rates) {
    const Real length = (cables.anchor.at(point + 1) - cables.anchor.at(point)).norm();
    if (!(length > 0) || tension == 0) return;
    // A segment resists a displacement across its direction with the stiffness tension / length. The mobility of an
    // anchor is the sum of w^2 / m over its nodes, with their weights w and masses m.
    Real mobility = 0;  // [1/kg]
    for (const std::size_t end : {point, point + 1})
        cables.anchor.for_each_node(
            end, [&](std::size_t node, Real weight) { mobility += weight * weight * cables.inverse_mass[node]; });
    for (const std::size_t end : {point, point + 1})
        if (const Index body = cables.anchor.body[end]; body != no_index)
            body_rates[static_cast<std::size_t>(body)] += tension / length * mobility;
}

}  // namespace

void add_cable_rates(const CableInputs& cables, std::span<Real> body_rates) {
    for (std::size_t c = 0; c < cables.size(); ++c) {
        const Range points = cables.points[c];
        const std::span<const TimeKey> keys = cables.keys_of(c);
        const bool known = cables.control[c] == CableControl::tension;
        for (Index p = points.begin; p + 1 < points.end; ++p) {
            const auto at = static_cast<std::size_t>(p);
            const Real last = cables.step[c] > 0 ? cables.tension[at] / cables.step[c] : 0;
            const Real most = known ? std::ranges::max_element(keys, {}, &TimeKey::value)->value : last;
            add_segment_rate(cables, at, most, body_rates);
        }
    }
}

bool CableInputs::is_led(std::size_t cable) const {
    for (Index p = points[cable].begin; p < points[cable].end; ++p)
        if (anchor.is_led(static_cast<std::size_t>(p))) return true;
    return false;
}

bool CableInputs::is_driven(std::size_t cable, Real t, Real h) const {
    const std::span<const TimeKey> cable_keys = keys_of(cable);
    return is_led(cable) || changes(cable_keys, t, h) ||
           (control[cable] == CableControl::rate && value_at(cable_keys, t) != 0);
}

bool CableInputs::moves(std::size_t cable) const {
    bool found = false;
    for (Index p = points[cable].begin; p < points[cable].end; ++p)
        anchor.for_each_node(static_cast<std::size_t>(p),
                             [&](std::size_t node, Real) { found |= inverse_mass[node] > 0; });
    return found;
}

bool CableInputs::rests(std::size_t cable) const {
    if (body_asleep.empty() || is_led(cable)) return false;
    return std::ranges::all_of(rows_of(anchor.body, points[cable]), [&](Index body) {
        return body == no_index || body_asleep[static_cast<std::size_t>(body)] != 0;
    });
}

bool prepare_cables(const CableInputs& cables, const CableTimes& times, CableBlockTable& blocks) {
    clear(blocks);
    for (const bool known : {true, false}) {
        if (!known) blocks.first_solved = static_cast<Index>(blocks.block.size());
        for (std::size_t c = 0; c < cables.size(); ++c)
            if (cables.has_known_forces(c) == known && !cables.rests(c) && cables.moves(c))
                add_block(cables, c, times, blocks);
    }
    return cables.size() > 0;
}

bool add_cable_forces(const CableBlockTable& blocks, Real kick, std::span<Vec3> applied_force) {
    const auto known = static_cast<std::size_t>(blocks.first_solved);
    for (std::size_t b = 0; b < known; ++b) {
        const Range points = blocks.block[b].points;
        Vec3 last = Vec3::Zero();
        for (Index p = points.begin; p < points.end; ++p) {
            const Vec3 next = blocks.impulse[p] / kick * blocks.direction[p];
            const Vec3 force = next - last;
            const Stencil& stencil = blocks.stencil[p];
            for (std::size_t a = 0; a < 4; ++a)
                if (stencil.weight[a] != 0)
                    applied_force[static_cast<std::size_t>(stencil.node[a])] += stencil.weight[a] * force;
            last = next;
        }
    }
    return known > 0;
}

bool mark_driven_cables(const CableInputs& cables, Real t, Real h, std::span<std::uint8_t> marked) {
    bool any = false;
    for (std::size_t c = 0; c < cables.size(); ++c) {
        if (!cables.is_driven(c, t, h)) continue;
        any = true;
        for (const Index body : rows_of(cables.anchor.body, cables.points[c]))
            if (body != no_index) marked[static_cast<std::size_t>(body)] = 1;
    }
    return any;
}

CableWork work_of_cable(std::span<const Real> tension, std::span<const Real> before, std::span<const Real> now) {
    CableWork sum;
    Real drawn = 0;  // length of cable that moves past the start of segment s, towards the first point [m]
    for (std::size_t s = tension.size(); s-- > 0;) {
        drawn -= now[s] - before[s];
        if (s == 0)
            sum.work = tension[0] * drawn;
        else
            sum.dissipated += (tension[s - 1] - tension[s]) * drawn;
    }
    return sum;
}

bool store_cables(const CableBlockTable& blocks, const CableTimes& times, const CableMemory& out) {
    for (const CableBlock& block : blocks.block) {
        if (block.is_tie) continue;
        const auto c = static_cast<std::size_t>(block.cable);
        const std::span<const Real> length = rows_of(blocks.length, block.points),
                                    impulse = rows_of(blocks.impulse, block.points);
        const std::span<Real> tension = rows_of(out.tension, out.points[c]),
                              before = rows_of(out.length, out.points[c]);
        if (out.step[c] > 0) {
            const CableWork cable_work = work_of_cable(tension.first(tension.size() - 1), before, length);
            out.work[c] += cable_work.work / out.step[c];
            out.dissipated[c] += cable_work.dissipated / out.step[c];
        }
        std::ranges::copy(length, before.begin());
        std::ranges::copy(impulse, tension.begin());
        if (out.control[c] == CableControl::length) out.released[c] = block.released;
        out.step[c] = times.kick;
    }
    for (std::size_t c = 0; c < out.control.size(); ++c)
        if (out.control[c] == CableControl::rate)
            out.released[c] = released_at_end(rows_of(out.key, out.keys[c]), out.released[c], times);
    return !out.control.empty();
}

CableMeasures measure_cables(const CableBlockTable& blocks, std::span<const Index> node_body,
                             std::span<const GhostKind> body_ghost) {
    const GhostMarks ghosts{body_ghost};
    const auto is_ghost = [&](const CableBlock& block) {
        for (Index p = block.points.begin; p < block.points.end; ++p)
            if (blocks.stencil[p].weight[0] != 0) return ghosts.contain(node_body[blocks.stencil[p].node[0]]);
        return false;
    };
    CableMeasures sum;
    for (std::size_t b = static_cast<std::size_t>(blocks.first_solved); b < blocks.block.size(); ++b) {
        if (is_ghost(blocks.block[b])) continue;
        sum.impulse += blocks.sum_impulse[b];
        sum.work += blocks.work[b];
        sum.dissipated += blocks.dissipated[b];
    }
    return sum;
}

}  // namespace skerry
