#include "systems/contact/measure_ties.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "systems/contact/prepare_ties.h"

namespace skerry {

namespace {

/// Velocity of a tied point before the step plus its velocity after the step [m/s]. On an explicit body the point moves
/// like `node`; on a rigid or implicit body the rotation of the frame about `node` is added.
Vec3 velocity_sum(const TieWorkInputs& motion, Index node, const Vec3& point) {
    const auto n = static_cast<std::size_t>(node);
    Vec3 sum = motion.velocity[n] + motion.velocity_next[n];
    const Index frame = motion.spins.nodes.row(node);
    if (frame == no_index) return sum;
    const auto r = static_cast<std::size_t>(frame);
    return sum + (motion.spins.before(r) + motion.spins.after(r)).cross(point - motion.position[n]);
}

/// True if all bodies of a tie are implicit. The impulses of the tie then act for the whole step. Otherwise they act
/// for the force interval, the time for which forces act on explicit and rigid bodies.
bool acts_for_whole_step(const TieTable& ties, std::span<const Range> body_implicit, std::size_t t) {
    const auto implicit = [&](Index body) {
        return body == no_index || body_implicit[static_cast<std::size_t>(body)].size() > 0;
    };
    return implicit(ties.first[t]) && implicit(ties.second[t]);
}

Vec3 impulse_of(const CableBlockTable& blocks, const CableBlock& tie) {
    return {blocks.impulse[tie.points.begin], blocks.impulse[tie.points.begin + 1],
            blocks.impulse[tie.points.begin + 2]};
}

/// Divides the impulse of tie `t` among its nodes in proportion to their masses. If the force exceeds the limit, all
/// nodes break off at the time `end` [s], and the result is true.
bool store_mean(const Vec3& impulse, const BallTies& ball_ties, std::size_t t, Real end, TieTable& ties) {
    const Index first = ball_ties.body_nodes[static_cast<std::size_t>(ties.first[t])].begin;
    Index k = ties.nodes[t].begin;
    for_each_share(rows_of(ties.node.span(), ties.nodes[t]), first, ball_ties.mass,
                   [&](Index, Real share) { ties.impulse[k++] = share * impulse; });
    const bool breaks = impulse.norm() > ties.break_force[t] * ties.step[t];
    if (breaks) std::ranges::fill(rows_of(ties.broken, ties.nodes[t]), end);
    return breaks;
}

}  // namespace

TieMeasures take_tie_rows(const TieWorkInputs& motion, const CableBlockTable& blocks, ContactTable& contacts,
                          TieRowTable& rows) {
    const std::size_t first = contacts.size() - rows.size();
    TieMeasures sum;
    const auto add = [&](const Stencil& stencil, const Vec3& impulse, const Vec3* point) {
        for (std::size_t a = 0; a < 4; ++a) {
            const Real weight = stencil.weight[a];
            const auto node = static_cast<std::size_t>(stencil.node[a]);
            if (weight == 0 || !(motion.inverse_mass[node] > 0) || motion.ghosts.contain(motion.node_body[node]))
                continue;
            sum.impulse += weight * impulse;
            sum.work +=
                weight * impulse.dot(velocity_sum(motion, stencil.node[a], point ? *point : motion.position[node])) / 2;
        }
    };
    rows.impulse.resize(rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const Vec3& impulse = rows.impulse[i] = contacts.impulse[first + i];
        add(rows.stencil[i], impulse, &rows.point[i]);
    }
    contacts.resize(first);
    for (const CableBlock& block : blocks.solved()) {
        if (!block.is_tie) continue;
        const Vec3 impulse = impulse_of(blocks, block);
        for (Index p = block.points.begin; p < block.points.end; ++p)
            add(blocks.stencil[p], impulse, block.acting_point(p));
    }
    return sum;
}

Index store_ties(const TieRowTable& rows, const BallTies& ball_ties, const TieTimes& times, TieTable& ties) {
    for (std::size_t t = 0; t < ties.size(); ++t) {
        if (rows.rests[t]) continue;
        ties.step[t] = acts_for_whole_step(ties, ball_ties.body_implicit, t) ? times.h : times.kick;
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
    for (const CableBlock& block : ball_ties.blocks.solved())
        if (block.is_tie)
            released += store_mean(impulse_of(ball_ties.blocks, block), ball_ties,
                                   static_cast<std::size_t>(block.cable), times.end, ties);
    for (std::size_t t = 0; t < ties.size(); ++t) {
        if (rows.rests[t]) continue;
        Vec3 sum = Vec3::Zero();
        for (const Vec3& impulse : rows_of(ties.impulse, ties.nodes[t])) sum += impulse;
        ties.largest_force[t] = std::max(ties.largest_force[t], sum.norm() / ties.step[t]);
    }
    return released;
}

}  // namespace skerry
