#include "engine/world/ranks/hold/ghosts.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "engine/world/ranks/rows/body_rows.h"
#include "engine/world/step/seams.h"
#include "engine/world/step/step.h"
#include "jobs/stage_arguments.h"
#include "systems/collision/tree/box.h"

namespace skerry {

namespace {

/// A rank requests a copy of a body if it must solve a contact region with this body. It keeps the copy during this
/// number of rank searches (calls of update_ghosts).
constexpr int searches_of_requests = 8;
/// Greatest number of steps between two rank searches. Without this limit, bodies that hardly move would never get new
/// owners, although costs may change.
constexpr std::uint64_t steps_between_searches = 1000;
/// The margin of a body (margin_of) contains its path in this number of steps, at its greatest speed and under gravity.
constexpr Real steps_of_margin = 20;
/// Cost of a contact, in units of the cost of an explicit element. It is above 1, because the solver visits a contact
/// in several iterations.
constexpr Real contact_cost = 10;
/// Cost of a body apart from its elements and contacts, in units of the cost of an explicit element.
constexpr Real body_cost = 20;

/// Distance that a body may move before the next rank search, which finds the ranks that must hold the body [m]. It is
/// about the size of its surface elements, plus its path in steps_of_margin steps. `speed`: greatest speed of a node
/// [m/s].
Real margin_of(const WorldState& world, std::size_t body, Real speed) {
    const Model& model = world.model;
    Real h = std::max(world.clock.step_before, world.scratch.parameters.h);
    if (const Real longest = longest_allowed_step(model); std::isfinite(longest)) h = std::max(h, longest);
    const Real time = steps_of_margin * h;
    const BodyTable& bodies = model.bodies;
    const Real size = bodies.mean_edge[body] + bodies.round_radius[body] / 8 + bodies.contact_distance[body];
    return size + time * (speed + model.settings.gravity.norm() * time);
}

BodyExtent extent_of(const WorldState& world, std::size_t body, Real contacts) {
    const Model& model = world.model;
    const BodyTable& bodies = model.bodies;
    Range nodes = bodies.nodes[body];
    // a cylinder, ball or capsule is defined by its core nodes; the others serve only to draw it
    if (const Index core = bodies.core_nodes[body]; core > 0) nodes.end = nodes.begin + core;
    Aabb box = empty_box();
    // greatest speed in the last step, which may exceed the present speed because of a contact
    Real speed = bodies.max_speed[body];
    const std::span<const Real> tried = world.ranks.tried_speed;
    if (body < tried.size() && std::isfinite(tried[body])) speed = std::max(speed, tried[body]);
    for (Index node = nodes.begin; node < nodes.end; ++node) {
        grow(box, model.nodes.position[node]);
        speed = std::max(speed, model.nodes.velocity[node].norm());
    }
    const Real margin = margin_of(world, body, speed);
    const Vec3 more = Vec3::Constant(margin + bodies.contact_distance[body] + bodies.round_radius[body]);
    const auto elements = static_cast<Real>(bodies.blocks[body].size() * Index{element_lanes});
    return {.world_row = world.ranks.world_row[body],
            .cost = body_cost + elements + static_cast<Real>(bodies.implicit[body].size()) + contact_cost * contacts,
            .margin = margin,
            .box = {box.lower - more, box.upper + more},
            // all ranks hold a body that takes long steps (each covers several steps of the world), because the
            // progress of a long step is not stored in the table rows of the body
            .on_all = model.settings.implicit_step > 0 && bodies.implicit[body].size() > 0};
}

/// Start of the message that each rank sends to all others in a rank search: numbers of the rows that follow, and a
/// flag.
struct SearchHeader {
    std::uint64_t extents, requests, stale;
    // 1: bodies must not get new owners, because this rank stores crossings of surfaces that an earlier attempt at the
    // present step has found. Stored crossings are not sent to new owners.
    std::uint64_t keeps_owners;
};

/// Data that all ranks exchange in a rank search.
struct SearchData {
    std::vector<BodyExtent> extents;  // bodies in the order of their rows in the undivided world
    std::vector<FetchedUnit> requests;
    std::vector<Index> stale;  // rows in the undivided world of bodies whose copies are outdated
    bool keeps_owners = false;
};

std::vector<std::uint8_t> owned_bodies(const WorldState& world) {
    std::vector<std::uint8_t> owned;
    for (std::size_t b = 0; b < world.ranks.owner.size(); ++b)
        owned.push_back(world.ranks.owns(b) && world.model.bodies.kind[b] == BodyKind::deformable);
    return owned;
}

/// Sorts the entries by unit (bodies that joints, ties or similar objects connect) and rank. Among entries with the
/// same unit and rank, keeps only the one that lasts for the most rank searches.
void keep_longest(std::vector<FetchedUnit>& fetched) {
    std::ranges::sort(fetched, {}, [](const FetchedUnit& of) { return std::tuple(of.unit, of.rank, -of.searches); });
    const auto is_same = [](const FetchedUnit& a, const FetchedUnit& b) {
        return a.unit == b.unit && a.rank == b.rank;
    };
    fetched.erase(std::unique(fetched.begin(), fetched.end(), is_same), fetched.end());
}

SearchData search_ranks(WorldState& world) {
    RankState& ranks = world.ranks;
    const std::vector<BodyExtent> extents = extents_of(world, owned_bodies(world));
    std::vector<FetchedUnit> requests;
    for (const BodyRequest& request : ranks.requests)
        requests.push_back({ranks.whole.unit[request.world_row], request.rank, searches_of_requests});
    keep_longest(requests);
    RankMessage own_message;
    const SearchHeader header{extents.size(), requests.size(), ranks.stale.size(),
                              world.cache.crossings.row.empty() ? 0u : 1u};
    put_rows(std::span<const SearchHeader>(&header, 1), own_message);
    put_rows(std::span<const BodyExtent>(extents), own_message);
    put_rows(std::span<const FetchedUnit>(requests), own_message);
    put_rows(std::span<const Index>(ranks.stale), own_message);
    SearchData all;
    for (const RankMessage& message : ranks.ranks->gather_everywhere(own_message)) {
        MailReader reader(message);
        const auto of_rank = reader.take<SearchHeader>();
        const auto append = [&](auto& to, std::uint64_t count) {
            to.resize(to.size() + count);
            reader.take_rows(std::span(to).last(count));
        };
        append(all.extents, of_rank.extents);
        append(all.requests, of_rank.requests);
        append(all.stale, of_rank.stale);
        all.keeps_owners |= of_rank.keeps_owners != 0;
    }
    std::ranges::sort(all.extents, {}, &BodyExtent::world_row);
    ranks.requests.clear();
    ranks.stale.clear();
    return all;
}

bool contains(const std::vector<int>& ranks, int rank) {
    return std::ranges::binary_search(ranks, rank);
}
void insert(int rank, std::vector<int>& ranks) {
    const auto at = std::ranges::lower_bound(ranks, rank);
    if (at == ranks.end() || *at != rank) ranks.insert(at, rank);
}

/// Change of the owners of all bodies, and of their holders (the ranks that own a body or have a copy of it). All ranks
/// compute the same change.
class HolderChange {
public:
    HolderChange(WholeWorld& whole, const SearchData& found, Column<std::int32_t> owner, int rank_count)
        : before_(whole), owner_(std::move(owner)), stale_(whole.size(), 0) {
        for (const Index world_row : found.stale) stale_[static_cast<std::size_t>(whole.unit[world_row])] = 1;
        note_requests(whole, found.requests);
        holders_ = find_holding_ranks(whole, owner_, found.extents, rank_count);
        for (const BodyExtent& body : found.extents) {
            const Index unit = whole.unit[body.world_row];
            auto fetched = std::ranges::lower_bound(whole.fetched, unit, {}, &FetchedUnit::unit);
            for (; fetched != whole.fetched.end() && fetched->unit == unit; ++fetched)
                insert(fetched->rank, holders_at(body.world_row));
        }
        keep_ghosts(found.extents, rank_count);
    }

    bool owners_change() const { return !std::ranges::equal(owner_, before_.owner); }
    const Column<std::int32_t>& owner() const { return owner_; }
    const std::vector<std::vector<int>>& holders() const { return holders_; }
    /// True if the rank that owned a body before the change sends the rows of the body to `rank`.
    bool is_sent(Index world_row, int rank) const {
        const auto p = static_cast<std::size_t>(world_row);
        if (!contains(holders_[p], rank) || rank == before_.owner[world_row]) return false;
        return !contains(before_.holders[p], rank) || rank == owner_[world_row] ||
               stale_[static_cast<std::size_t>(before_.unit[world_row])] != 0;
    }
    /// True if `rank` already has the rows of a body and keeps them. This holds for a kinematic body, which all ranks
    /// have, and for a body that `rank` still holds and of which it gets no new rows.
    bool is_kept(Index world_row, int rank) const {
        return before_.owner[world_row] == WholeWorld::everywhere ||
               (contains(holders_[static_cast<std::size_t>(world_row)], rank) && !is_sent(world_row, rank));
    }

private:
    std::vector<int>& holders_at(Index world_row) { return holders_[static_cast<std::size_t>(world_row)]; }

    static void note_requests(WholeWorld& whole, const std::vector<FetchedUnit>& requests) {
        for (FetchedUnit& fetched : whole.fetched) --fetched.searches;
        whole.fetched.insert(whole.fetched.end(), requests.begin(), requests.end());
        keep_longest(whole.fetched);
        std::erase_if(whole.fetched, [](const FetchedUnit& fetched) { return fetched.searches <= 0; });
    }

    /// If no owner changes, a rank that receives no rows keeps the ghosts (copies of bodies of other ranks) that it no
    /// longer needs, because removing them from its tables costs as much as some steps.
    void keep_ghosts(std::span<const BodyExtent> extents, int rank_count) {
        if (owners_change()) return;
        std::vector<std::uint8_t> receives(static_cast<std::size_t>(rank_count), 0);
        for (const BodyExtent& body : extents)
            for (const int rank : holders_at(body.world_row))
                if (is_sent(body.world_row, rank)) receives[static_cast<std::size_t>(rank)] = 1;
        for (const BodyExtent& body : extents)
            for (const int rank : before_.holders[static_cast<std::size_t>(body.world_row)])
                if (!receives[static_cast<std::size_t>(rank)]) insert(rank, holders_at(body.world_row));
    }

    const WholeWorld& before_;
    Column<std::int32_t> owner_;
    std::vector<std::uint8_t> stale_;  // by unit: nonzero if all holders need the rows of its bodies again
    std::vector<std::vector<int>> holders_;
};

/// Ranks to which this rank sends rows or from which it receives rows.
std::vector<int> partners_of(const HolderChange& change, const WholeWorld& whole, std::span<const BodyExtent> extents,
                             const Ranks& ranks) {
    std::vector<int> partners;
    if (change.owners_change()) {  // any rank may send stored contacts of pairs that get a new owner
        for (int rank = 0; rank < ranks.size(); ++rank)
            if (rank != ranks.rank()) partners.push_back(rank);
        return partners;
    }
    for (const BodyExtent& body : extents)
        for (const int rank : change.holders()[static_cast<std::size_t>(body.world_row)]) {
            if (!change.is_sent(body.world_row, rank)) continue;
            const int sender = whole.owner[body.world_row];
            if (sender == ranks.rank()) insert(rank, partners);
            if (rank == ranks.rank()) insert(sender, partners);
        }
    return partners;
}

void move_bodies(WorldState& world, const SearchData& found, const HolderChange& change) {
    RankState& ranks = world.ranks;
    WholeWorld& whole = ranks.whole;
    const int rank = ranks.rank;
    const std::vector<int> partners = partners_of(change, whole, found.extents, *ranks.ranks);
    std::vector<RankMessage> out, in(partners.size());
    for (const int partner : partners) {
        std::vector<std::uint8_t> sent;
        for (std::size_t b = 0; b < ranks.world_row.size(); ++b)
            sent.push_back(whole.owner[ranks.world_row[b]] == rank && change.is_sent(ranks.world_row[b], partner));
        BodyRows rows = rows_of_bodies(world, sent, [&](std::uint64_t pair) {
            return whole.pair_owner(pair, whole.owner) == rank && whole.pair_owner(pair, change.owner()) == partner;
        });
        if (partner != 0) copy_records(world.model, sent, rows);
        out.push_back(message_of(rows));
    }
    if (!partners.empty()) ranks.ranks->exchange(partners, out, in);
    std::vector<std::uint8_t> kept;
    bool all_kept = true;
    for (const Index world_row : ranks.world_row) {
        kept.push_back(change.is_kept(world_row, rank));
        all_kept &= kept.back() != 0;
    }
    std::vector<BodyRows> added;
    for (const RankMessage& message : in) added.push_back(rows_of_message(message));
    const bool changes = !all_kept || change.owners_change() ||
                         std::ranges::any_of(added, [](const BodyRows& rows) { return !rows.world_row.empty(); });
    whole.holders = change.holders();
    whole.owner = change.owner();
    if (changes)
        replace_rows(world, kept, added,
                     [&](std::uint64_t pair) { return whole.pair_owner(pair, whole.owner) == rank; });
    whole.searched_step = world.record.counters.steps;
    note_holders(ranks, found.extents);
    note_ghosts(world);
}

/// Motion of bodies since the ranks that must hold them were last found, and in this attempt at a step; by row of
/// BodyTable.
struct GhostMotion {
    std::span<const Real> margin, moved;  // RankState [m]
    std::span<const Real> max_speed;      // greatest speed in this attempt [m/s]

    static GhostMotion bind(const Binder& binder, const RankState& ranks, const BodyTable& bodies) {
        return {.margin = binder.read(ranks.margin),
                .moved = binder.read(ranks.moved),
                .max_speed = binder.read(bodies.max_speed)};
    }
};

/// Requests a rank search if a body may leave the box with which its holders were found, or if the last search was
/// steps_between_searches steps ago. A body stays in the box while its path since the search, plus its motion in this
/// step, is below its margin.
void watch_ghosts(const SearchState& search, const GhostMotion& bodies, std::span<Real> tried_speed, Real h,
                  const RunCounters& run, const std::uint64_t& searched_step, RankFindings& own_findings) {
    const std::span<const Real> reach = search.memory.body_reach;
    for (std::size_t b = 0; b < bodies.margin.size(); ++b) {
        const Real speed = bodies.max_speed[b];
        tried_speed[b] = speed;
        // body_reach is a bound that follows from the speed at the start of the step. The present speed contains the
        // effect of forces and contacts. If it is not finite, the step is refused, and no margin would be wide enough.
        const Real motion = std::isfinite(speed) ? std::max(reach[b], speed * h) : reach[b];
        own_findings.ghosts_expired |= !(bodies.moved[b] + motion < bodies.margin[b]);
    }
    own_findings.ghosts_expired |= run.steps >= searched_step + steps_between_searches;
}

/// Adds the greatest possible path of each body in a committed step of length `h` [s] to `moved`.
void measure_paths(std::span<const Real> max_speed, Real h, std::span<Real> moved) {
    for (std::size_t b = 0; b < moved.size(); ++b) moved[b] += max_speed[b] * h;
}

}  // namespace

std::vector<BodyExtent> extents_of(const WorldState& world, std::span<const std::uint8_t> marked) {
    std::vector<Real> contacts(marked.size(), 0);
    const ContactTable& table = world.scratch.contacts;
    for (std::size_t c = 0; c < table.size(); ++c)
        if (const Index body = table.first_body[c]; body != no_index) contacts[static_cast<std::size_t>(body)] += 1;
    std::vector<BodyExtent> extents;
    for (std::size_t b = 0; b < marked.size(); ++b)
        if (marked[b]) extents.push_back(extent_of(world, b, contacts[b]));
    return extents;
}

void note_holders(RankState& ranks, std::span<const BodyExtent> extents) {
    const WholeWorld& whole = ranks.whole;
    ranks.owner.clear();
    ranks.peers.clear();
    ranks.holders.clear();
    ranks.margin.assign(ranks.world_row.size(), infinity);
    ranks.moved.assign(ranks.world_row.size(), 0);
    ranks.tried_speed.assign(ranks.world_row.size(), 0);
    for (std::size_t b = 0; b < ranks.world_row.size(); ++b) {
        const Index world_row = ranks.world_row[b];
        const std::int32_t owner = whole.owner[world_row];
        ranks.owner.push_back(owner == WholeWorld::everywhere ? ranks.rank : owner);
        for (const int rank : whole.holders[static_cast<std::size_t>(world_row)])
            if (rank != ranks.rank) insert(rank, ranks.peers);
        if (owner != ranks.rank) continue;
        const auto body = std::ranges::lower_bound(extents, world_row, {}, &BodyExtent::world_row);
        ranks.margin[b] = body->margin;
    }
    for (const Index world_row : ranks.world_row) {
        std::vector<int>& holders = ranks.holders.emplace_back();
        for (const int rank : whole.holders[static_cast<std::size_t>(world_row)])
            if (rank != ranks.rank)
                holders.push_back(static_cast<int>(std::ranges::lower_bound(ranks.peers, rank) - ranks.peers.begin()));
    }
}

void list_ghost_watch(WorldState& w, TaskGraph& g) {
    if (!w.ranks.on()) return;
    g.stage("ranks/watch_ghosts", watch_ghosts, read(w.cache.search), inputs<GhostMotion>(w.ranks, w.model.bodies),
            write(w.ranks.tried_speed), value(w.scratch.parameters.h), read(w.record.counters),
            read(w.ranks.whole.searched_step), make(w.ranks.own_findings));
}

void list_ghost_paths(WorldState& w, TaskGraph& g) {
    if (!w.ranks.on()) return;
    g.stage("ranks/measure_paths", measure_paths, read(w.model.bodies.max_speed), value(w.scratch.parameters.h),
            write(w.ranks.moved), if_taken(w));
}

void update_ghosts(WorldState& world) {
    WholeWorld& whole = world.ranks.whole;
    const SearchData found = search_ranks(world);
    const int count = world.ranks.ranks->size();
    Column<std::int32_t> owner = whole.owner;
    const Real present = imbalance(owner, found.extents, count);
    if (whole.settings.map == OwnerMap::curve && !found.keeps_owners && present > whole.settings.most_imbalance) {
        Column<std::int32_t> other = choose_owners(whole, found.extents, whole.settings, count);
        if (imbalance(other, found.extents, count) < present) owner = std::move(other);
    }
    move_bodies(world, found, HolderChange(whole, found, std::move(owner), count));
}

void move_to_owners(WorldState& world, const Column<std::int32_t>& owner) {
    const SearchData found = search_ranks(world);
    move_bodies(world, found, HolderChange(world.ranks.whole, found, owner, world.ranks.ranks->size()));
}

}  // namespace skerry
