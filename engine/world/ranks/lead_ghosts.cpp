// Led ghosts: copies of a body for which only the rank that owns the body computes forces. The ranks with a copy
// receive its predicted velocities (after forces, before contacts) from that rank.
#include <algorithm>
#include <cstddef>
#include <span>

#include "engine/world/ranks/hold/ghosts.h"
#include "engine/world/step/seams.h"
#include "engine/world/step/step.h"

namespace skerry {

namespace {

/// True if the response of a body to contacts needs no more than masses and predicted velocities of its nodes.
bool can_be_led(const Model& model, std::size_t body) {
    return model.bodies.kind[body] == BodyKind::deformable && !model.has_frame(body) &&
           !(model.bodies.cluster_step[body] > 0);
}

/// Bodies whose predicted velocities ranks send to each other.
struct LedBodies {
    std::span<const std::int32_t> owner;           // RankState
    const std::vector<std::vector<int>>& holders;  // RankState
    const std::vector<int>& peers;                 // RankState
    int rank;
    std::span<const GhostKind> ghost;  // BodyTable
    std::span<const std::uint8_t> leads, asleep;
    std::span<const Range> nodes;

    static LedBodies bind(const Binder& binder, const RankState& ranks, const BodyTable& body) {
        return {.owner = binder.read(ranks.owner),
                .holders = binder.value(ranks.holders),
                .peers = binder.value(ranks.peers),
                .rank = binder.value(ranks.rank),
                .ghost = binder.read(body.ghost),
                .leads = binder.read(ranks.leads),
                .asleep = binder.read(body.asleep),
                .nodes = binder.read(body.nodes)};
    }
};

/// Sends the predicted velocities of own bodies with RankState::leads to the ranks that hold their ghosts (copies), and
/// receives those of the led ghosts on this rank. All ranks visit bodies in the order of the undivided world, so
/// messages need no row numbers.
void send_predictions(const LedBodies& bodies, std::span<Vec3> velocity_next, PredictionMail& mail,
                      RankChannel& channel) {
    mail.start(bodies.peers.size());
    for (std::size_t b = 0; b < bodies.nodes.size(); ++b) {
        if (!bodies.leads[b] || bodies.asleep[b]) continue;
        for (const int peer : bodies.holders[b])
            put_rows<Vec3>(rows_of(velocity_next, bodies.nodes[b]), mail.out[static_cast<std::size_t>(peer)]);
    }
    channel.ranks->exchange(bodies.peers, mail.out, mail.in);
    mail.reader.clear();
    for (const RankMessage& message : mail.in) mail.reader.emplace_back(message);
    for (std::size_t b = 0; b < bodies.nodes.size(); ++b) {
        if (bodies.ghost[b] != GhostKind::led || bodies.asleep[b]) continue;
        const auto peer =
            static_cast<std::size_t>(std::ranges::lower_bound(bodies.peers, bodies.owner[b]) - bodies.peers.begin());
        mail.reader[peer].take_rows(rows_of(velocity_next, bodies.nodes[b]));
    }
}

}  // namespace

void note_ghosts(WorldState& world) {
    const Model& model = world.model;
    RankState& ranks = world.ranks;
    const std::size_t count = ranks.on() ? model.bodies.slot.size() : 0;
    world.model.bodies.ghost.assign(count, GhostKind::none);
    ranks.leads.assign(count, 0);
    // Ghosts with nodes that are held along some directions only are not led: each rank corrects such nodes from its
    // own prediction.
    Column<std::uint8_t> half_held;
    half_held.assign(count, 0);
    for (std::size_t a = 0; a < model.attachments.held.size(); ++a)
        if (ranks.on() && !holds_completely(model.attachments.held[a]))
            half_held[static_cast<std::size_t>(model.attachments.body[a])] = 1;
    for (std::size_t b = 0; b < count; ++b) {
        const bool led = can_be_led(model, b) && !half_held[b];
        ranks.leads[b] = led && ranks.owns(b);
        if (!ranks.owns(b)) world.model.bodies.ghost[b] = led ? GhostKind::led : GhostKind::twin;
    }
}

void send_clustered_bodies(WorldState& world) {
    if (!world.model.of_ranks.clusters_grew) return;
    RankState& ranks = world.ranks;
    for (std::size_t b = 0; b < ranks.leads.size(); ++b)
        if (ranks.leads[b] && !can_be_led(world.model, b)) ranks.stale.push_back(ranks.world_row[b]);
    update_ghosts(world);
}

void list_led_ghosts(WorldState& w, TaskGraph& g) {
    if (!w.ranks.on()) return;
    const auto if_led =
        only_if([](std::span<const GhostKind> ghost) { return !ghost.empty(); }, read(w.model.bodies.ghost));
    g.stage("ranks/send_predictions", send_predictions, inputs<LedBodies>(w.ranks, w.model.bodies),
            write(w.model.nodes.velocity_next), make(w.ranks.predictions), make(w.ranks.channel), if_led);
}

}  // namespace skerry
