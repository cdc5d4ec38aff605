#include "systems/contact/measure_ties.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace skerry {

namespace {

/// Sum of the velocities before and after the step with which a node's body moves the point of a tie [m/s]
Vec3 twice_mean(const TieWorkInputs& motion, Index node, const Vec3& point) {
    const auto n = static_cast<std::size_t>(node);
    Vec3 sum = motion.velocity[n] + motion.velocity_next[n];
    const Index frame = motion.spins.nodes.row(node);
    if (frame == no_index) return sum;
    const auto r = static_cast<std::size_t>(frame);
    return sum + (motion.spins.before(r) + motion.spins.after(r)).cross(point - motion.position[n]);
}

/// True if the impulses of a tie act on its bodies for the whole step, since all of them are implicit.
bool acts_for_whole_step(const TieTable& ties, std::span<const Range> body_implicit, std::size_t t) {
    const auto implicit = [&](Index body) {
        return body == no_index || body_implicit[static_cast<std::size_t>(body)].size() > 0;
    };
    return implicit(ties.first[t]) && implicit(ties.second[t]);
}

}  // namespace

TieMeasures take_tie_rows(const TieWorkInputs& motion, ContactTable& contacts, TieRowTable& rows) {
    const std::size_t first = contacts.size() - rows.size();
    TieMeasures sum;
    rows.impulse.resize(rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const Vec3& impulse = rows.impulse[i] = contacts.impulse[first + i];
        const Stencil& stencil = rows.stencil[i];
        for (std::size_t a = 0; a < 4; ++a) {
            const Real weight = stencil.weight[a];
            if (weight == 0 || !(motion.inverse_mass[static_cast<std::size_t>(stencil.node[a])] > 0)) continue;
            sum.impulse += weight * impulse;
            sum.work += weight * impulse.dot(twice_mean(motion, stencil.node[a], rows.point[i])) / 2;
        }
    }
    contacts.resize(first);
    return sum;
}

Index store_ties(const TieRowTable& rows, std::span<const Range> body_implicit, const TieTimes& times, TieTable& ties) {
    for (std::size_t t = 0; t < ties.size(); ++t) {
        if (rows.rests[t]) continue;
        ties.step[t] = acts_for_whole_step(ties, body_implicit, t) ? times.h : times.kick;
        std::ranges::fill(rows_of(ties.impulse, ties.nodes[t]), Vec3::Zero());
    }
    Index released = 0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const auto t = static_cast<std::size_t>(rows.tie[i]), k = static_cast<std::size_t>(rows.node[i]);
        ties.impulse[k] = rows.impulse[i];
        if (!(rows.impulse[i].norm() > ties.break_force[t] * ties.step[t])) continue;
        ties.broken[k] = times.end;
        const auto is_broken = [](Real time) { return time < infinity; };
        released += std::ranges::all_of(rows_of(ties.broken, ties.nodes[t]), is_broken);
    }
    for (std::size_t t = 0; t < ties.size(); ++t) {
        if (rows.rests[t]) continue;
        Vec3 sum = Vec3::Zero();
        for (const Vec3& impulse : rows_of(ties.impulse, ties.nodes[t])) sum += impulse;
        ties.largest_force[t] = std::max(ties.largest_force[t], sum.norm() / ties.step[t]);
    }
    return released;
}

}  // namespace skerry
