#include "engine/world/ranks/regions/region_labels.h"

#include <algorithm>

namespace skerry {

SharedBodies SharedBodies::bind(const Binder& binder, const RankState& ranks, const BodyTable& body,
                                const NodeTable& node) {
    return {.world_row = binder.read(ranks.world_row),
            .owner = binder.read(ranks.owner),
            .holders = binder.value(ranks.holders),
            .peers = binder.value(ranks.peers),
            .rank = binder.value(ranks.rank),
            .kind = binder.read(body.kind),
            .nodes = binder.read(body.nodes),
            .node_body = binder.read(node.body)};
}

bool SharedBodies::is_held_by(int peer, Index body) const {
    const std::span<const int> all = holders_of(body);
    return std::ranges::find(all, peer) != all.end();
}

int SharedBodies::peer_of(int rank_number) const {
    const auto at = std::ranges::lower_bound(peers, rank_number);
    return at != peers.end() && *at == rank_number ? static_cast<int>(at - peers.begin()) : -1;
}

void find_units(const JoinedBodies& joined, std::size_t bodies, RankRegions& regions) {
    regions.unit.clear();
    if (std::ranges::all_of(joined.body, [](std::span<const Index> column) { return column.empty(); })) return;
    UnionFind& sets = regions.body_sets;
    sets.start(bodies);
    for (std::size_t link = 0; link < joined.links.first.size(); ++link)
        sets.join(joined.links.first[link], joined.links.second[link]);
    regions.in_unit.assign(bodies, 0);
    for (const std::span<const Index> column : joined.body)
        for (const Index body : column)
            if (body != no_index) regions.in_unit[sets.root(body)] = 1;
    regions.unit.resize(bodies);
    for (std::size_t b = 0; b < bodies; ++b) {
        const Index root = sets.root(static_cast<Index>(b));
        regions.unit[b] = regions.in_unit[root] ? root : no_index;
    }
}

namespace {

/// A group of nodes in a message, and the label of its region.
struct NamedLabel {
    NodeName group;
    RegionLabel label;
};

class RegionLabels {
public:
    RegionLabels(const SharedBodies& bodies, const RegionGroups& nodes, RankRegions& regions)
        : bodies_(bodies), nodes_(nodes), regions_(regions) {
        const std::size_t count = nodes.inverse_mass.size();
        regions.sets.start(count);
        regions.label.resize(count);
        regions.label_received.resize(count);
        regions.changed.resize(count);
        regions.group.clear();
    }

    void join_groups(std::span<const Stencil> stencil) {
        regions_.group_of.resize(stencil.size());
        for (std::size_t c = 0; c < stencil.size(); ++c) regions_.group_of[c] = join_nodes(stencil[c]);
        for (std::size_t b = 0; b < regions_.unit.size(); ++b)
            if (regions_.unit[b] == static_cast<Index>(b) && bodies_.owner[b] == bodies_.rank)
                touch(bodies_.nodes[b].begin);
        for (const Index group : regions_.group) {
            RegionLabel& of_region = regions_.label[regions_.sets.root(group)];
            if (regions_.label[group].least < of_region.least) of_region = regions_.label[group];
        }
    }

    int settle(RankChannel& channel, int rounds) {
        int needed = 1;
        for (int round = 1; round <= rounds; ++round) {
            send(round);
            RankMail& mail = regions_.mail;
            channel.ranks->exchange(bodies_.peers, mail.out, mail.in);
            for (const RankMessage& message : mail.in)
                for (MailReader reader(message); !reader.at_end();)
                    if (receive(reader.take<NamedLabel>(), round)) needed = round + 1;
        }
        return needed;
    }

private:
    bool is_touched(Index group) const { return regions_.sets.node[group].stamp == regions_.sets.now; }

    /// Returns the first node of the group (nodes that move together) that contains a node. If joints, ties or cables
    /// act on the unit of its body (RankRegions::unit), all nodes of the unit are one group.
    Index leader(Index node) const {
        if (regions_.unit.empty()) return nodes_.groups.leader(node);
        const Index unit = regions_.unit[bodies_.body_of(node)];
        return unit == no_index ? nodes_.groups.leader(node) : bodies_.nodes[static_cast<std::size_t>(unit)].begin;
    }

    void touch(Index group) {
        if (is_touched(group)) return;
        regions_.label[regions_.sets.root(group)] = {bodies_.name(group),
                                                     bodies_.owner[static_cast<std::size_t>(bodies_.body_of(group))]};
        regions_.label_received[group] = 0;
        regions_.changed[group] = 0;
        regions_.group.push_back(group);
    }

    Index join_nodes(const Stencil& stencil) {
        Index first = no_index;
        for (std::size_t a = 0; a < 4; ++a) {
            const Index node = stencil.node[a];
            if (stencil.weight[a] == 0 || !(nodes_.inverse_mass[static_cast<std::size_t>(node)] > 0)) continue;
            const Index group = leader(node);
            touch(group);
            if (first == no_index) first = group;
            regions_.sets.join(first, group);
        }
        return first;
    }

    void send(int round) {
        regions_.mail.start(bodies_.peers.size());
        for (const Index group : regions_.group) {
            const std::span<const int> holders = bodies_.holders_of(bodies_.body_of(group));
            if (holders.empty()) continue;
            const Index root = regions_.sets.root(group);
            if (regions_.changed[root] != round - 1) continue;
            for (const int peer : holders)
                regions_.mail.put(static_cast<std::size_t>(peer),
                                  NamedLabel{bodies_.name(group), regions_.label[root]});
        }
    }

    /// Applies a label that another rank has sent. Returns true if it replaces the label of a region.
    bool receive(const NamedLabel& named, int round) {
        const Index group = bodies_.node_of(named.group);
        if (group == no_index || !is_touched(group)) return false;
        const Index root = regions_.sets.root(group);
        regions_.label_received[root] = 1;
        if (!(named.label.least < regions_.label[root].least)) return false;
        regions_.label[root] = named.label;
        regions_.changed[root] = round;
        return true;
    }

    const SharedBodies& bodies_;
    const RegionGroups& nodes_;
    RankRegions& regions_;
};

}  // namespace

int label_regions(const SharedBodies& bodies, const RegionGroups& nodes, std::span<const Stencil> stencil, int rounds,
                  RankRegions& regions, RankChannel& channel) {
    RegionLabels labels(bodies, nodes, regions);
    labels.join_groups(stencil);
    return labels.settle(channel, rounds);
}

}  // namespace skerry
