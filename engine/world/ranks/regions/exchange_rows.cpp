// Exchange of contacts before the solve. One rank solves a contact region (contacts that are connected through moving
// nodes or bodies). The other ranks send it the contacts of the region that they have found.
#include <algorithm>
#include <numeric>
#include <utility>

#include "components/write_contact.h"
#include "engine/world/ranks/regions/region_labels.h"
#include "engine/world/step/seams.h"
#include "engine/world/step/step.h"
#include "systems/contact/contact_columns.h"

namespace skerry {

namespace {

/// Sends the contacts of regions that other ranks solve, and receives contacts of regions that this rank solves.
class RowExchange {
public:
    RowExchange(const SharedBodies& bodies, ContactTable& contacts, RankRegions& regions, Column<BodyRequest>& requests)
        : bodies_(bodies), contacts_(contacts), regions_(regions), requests_(requests) {}

    void run(RankChannel& channel) {
        regions_.mail.start(bodies_.peers.size());
        send_units();
        const bool sends = send_contacts();
        RankMail& mail = regions_.mail;
        channel.ranks->exchange(bodies_.peers, mail.out, mail.in);
        regions_.received.clear();
        regions_.received_end.clear();
        for (const RankMessage& message : mail.in) {
            receive(message);
            regions_.received_end.push_back(static_cast<Index>(regions_.received.size()));
        }
        spread_over_units();
        regions_.exchanged = sends || !regions_.received.empty();
        if (regions_.exchanged) merge();
        regions_.contact_count = contacts_.size();
    }

private:
    /// Returns the rank that solves the contact region of a group of nodes, which move together: -1 for this rank, its
    /// index in `peers`, or no_peer(), a number below -1, if it shares no body with this rank. `group`: first node of
    /// the group.
    int solver_of(Index group) {
        const Index root = regions_.sets.root(group);
        const int owner = regions_.label[root].owner;
        if (!regions_.label_received[root] || owner == bodies_.rank) return -1;
        return bodies_.peer_of(owner) == -1 ? no_peer(owner) : bodies_.peer_of(owner);
    }
    /// Result of solver_of for a rank that shares no body with this rank: a number below -1.
    static int no_peer(int owner) { return -2 - owner; }

    /// True if the solver of a region holds the body; always true for kinematic bodies, which all ranks hold. If false,
    /// requests a copy of the body for the solver. `peer`: result of solver_of.
    bool reaches(int peer, Index body) {
        if (body == no_index || bodies_.kind[static_cast<std::size_t>(body)] == BodyKind::kinematic) return true;
        if (peer >= 0 && bodies_.is_held_by(peer, body)) return true;
        const int to = peer >= 0 ? bodies_.peers[static_cast<std::size_t>(peer)] : -2 - peer;
        requests_.push_back({to, bodies_.world_row[static_cast<std::size_t>(body)]});
        return false;
    }

    /// Tells each peer which units of this rank (sets of bodies that joints, ties or cables connect) the peer must
    /// solve. Units of other ranks count as solved elsewhere until a message of their owner assigns them to this rank.
    void send_units() {
        regions_.solved_elsewhere.assign(regions_.unit.size(), 1);
        regions_.unit_count.assign(bodies_.peers.size(), 0);
        for_each_own_unit([&](Index body, int peer) {
            const bool sent = peer != -1 && reaches(peer, body);
            regions_.solved_elsewhere[body] = sent;
            if (sent) ++regions_.unit_count[peer];
        });
        for (std::size_t p = 0; p < bodies_.peers.size(); ++p) regions_.mail.put(p, regions_.unit_count[p]);
        for_each_own_unit([&](Index body, int peer) {
            if (regions_.solved_elsewhere[body])
                regions_.mail.put(static_cast<std::size_t>(peer), bodies_.world_row[static_cast<std::size_t>(body)]);
        });
    }

    void for_each_own_unit(auto&& visit) {
        for (std::size_t b = 0; b < regions_.unit.size(); ++b)
            if (regions_.unit[b] == static_cast<Index>(b) && bodies_.owner[b] == bodies_.rank)
                visit(static_cast<Index>(b), solver_of(bodies_.nodes[b].begin));
    }

    /// Copies RankRegions::solved_elsewhere (1: another rank solves the joints, ties and cables) of the first body of
    /// each unit to the other bodies of the unit.
    void spread_over_units() {
        for (std::size_t b = 0; b < regions_.unit.size(); ++b)
            regions_.solved_elsewhere[b] = regions_.unit[b] != no_index && regions_.solved_elsewhere[regions_.unit[b]];
    }

    bool send_contacts() {
        bool any = false;
        regions_.solved_row.resize(contacts_.size());
        for (std::size_t c = 0; c < contacts_.size(); ++c) {
            regions_.solved_row[c] = 0;
            if (regions_.group_of[c] == no_index) continue;
            const int peer = solver_of(regions_.group_of[c]);
            if (peer == -1) continue;
            const bool first = reaches(peer, contacts_.first_body[c]), second = reaches(peer, contacts_.second_body[c]);
            if (!first || !second) continue;
            regions_.mail.put(static_cast<std::size_t>(peer), mailed(c));
            regions_.solved_row[c] = -1 - peer;
            any = true;
        }
        return any;
    }

    Index world_row_of(Index body) const {
        return body == no_index ? no_index : bodies_.world_row[static_cast<std::size_t>(body)];
    }

    MailedContact mailed(std::size_t c) const {
        MailedContact mail{{.key = contacts_.key[c],
                            .kind = contacts_.kind[c],
                            .stencil = contacts_.stencil[c],
                            .point = contacts_.point[c],
                            .normal = contacts_.normal[c],
                            .gap = contacts_.gap[c],
                            .distance = contacts_.distance[c],
                            .surface_velocity = contacts_.surface_velocity[c],
                            .static_friction = contacts_.static_friction[c],
                            .dynamic_friction = contacts_.dynamic_friction[c],
                            .restitution = contacts_.restitution[c],
                            .first_body = world_row_of(contacts_.first_body[c]),
                            .second_body = world_row_of(contacts_.second_body[c]),
                            .collider = contacts_.collider[c]},
                           contacts_.friction_axis[c],
                           contacts_.impulse[c]};
        for (Index& node : mail.row.stencil.node) {
            const Index body = bodies_.body_of(node);
            node = 2 * (node - bodies_.nodes[static_cast<std::size_t>(body)].begin) +
                   (body != contacts_.first_body[c] ? 1 : 0);
        }
        return mail;
    }

    void receive(const RankMessage& message) {
        MailReader reader(message);
        for (Index unit = reader.take<Index>(); unit > 0; --unit)
            regions_.solved_elsewhere[bodies_.row_of(reader.take<Index>())] = 0;
        while (!reader.at_end()) {
            MailedContact mail = reader.take<MailedContact>();
            ContactRow& row = mail.row;
            row.first_body = bodies_.row_of(row.first_body);
            if (row.second_body != no_index) row.second_body = bodies_.row_of(row.second_body);
            for (Index& node : row.stencil.node)
                node = bodies_.nodes[static_cast<std::size_t>(node % 2 ? row.second_body : row.first_body)].begin +
                       node / 2;
            regions_.received.push_back(mail);
        }
    }

    /// Moves the contacts that this rank has found to RankRegions::found, and fills the contact table with the contacts
    /// that this rank solves, sorted by key.
    void merge() {
        std::swap(contacts_, regions_.found);
        const ContactTable& found = regions_.found;
        const std::span<const MailedContact> received = regions_.received;
        regions_.order.resize(received.size());
        std::iota(regions_.order.begin(), regions_.order.end(), 0);
        std::ranges::sort(regions_.order, {}, [&](Index i) { return received[static_cast<std::size_t>(i)].row.key; });
        regions_.received_row.resize(received.size());
        regions_.source.clear();
        auto next = regions_.order.begin();
        const auto take_received = [&](auto&& is_before) {
            for (; next != regions_.order.end() && is_before(received[static_cast<std::size_t>(*next)].row.key);
                 ++next) {
                regions_.received_row[*next] = static_cast<Index>(regions_.source.size());
                regions_.source.push_back(~*next);
            }
        };
        for (std::size_t c = 0; c < found.size(); ++c) {
            if (regions_.solved_row[c] < 0) continue;
            take_received([&](const ContactKey& key) { return key < found.key[c]; });
            regions_.solved_row[c] = static_cast<Index>(regions_.source.size());
            regions_.source.push_back(static_cast<Index>(c));
        }
        take_received([](const ContactKey&) { return true; });
        contacts_.resize(regions_.source.size());
        for (std::size_t row = 0; row < regions_.source.size(); ++row)
            if (regions_.source[row] < 0)
                write_received(received[static_cast<std::size_t>(~regions_.source[row])], row);
        for_each_column_of(contacts_, found, found, [&](auto& to, const auto& from, const auto&) {
            for (std::size_t row = 0; row < regions_.source.size(); ++row)
                if (regions_.source[row] >= 0) to[row] = from[regions_.source[row]];
        });
    }

    void write_received(const MailedContact& mail, std::size_t row) {
        write_contact(mail.row, row, contacts_);
        contacts_.friction_axis[row] = mail.friction_axis;
        contacts_.impulse[row] = mail.impulse;
    }

    const SharedBodies& bodies_;
    ContactTable& contacts_;
    RankRegions& regions_;
    Column<BodyRequest>& requests_;
};

void remove_repeated(Column<BodyRequest>& requests) {
    const auto name = [](const BodyRequest& request) { return std::pair(request.rank, request.world_row); };
    std::ranges::sort(requests, {}, name);
    const auto is_same = [&](const BodyRequest& a, const BodyRequest& b) { return name(a) == name(b); };
    const BodyRequest* const end = std::unique(requests.begin(), requests.end(), is_same);
    requests.resize(static_cast<std::size_t>(end - requests.begin()));
}

void exchange_rows(const SharedBodies& bodies, const RegionGroups& nodes, const JoinedBodies& joined,
                   const LabelRounds& rounds, ContactTable& contacts, RankRegions& regions,
                   Column<BodyRequest>& requests, RankFindings& own_findings, RankChannel& channel) {
    requests.clear();
    find_units(joined, bodies.size(), regions);
    own_findings.label_rounds = label_regions(bodies, nodes, contacts.stencil, rounds.count, regions, channel);
    own_findings.labels_open = own_findings.label_rounds > rounds.count;
    RowExchange(bodies, contacts, regions, requests).run(channel);
    remove_repeated(requests);
    own_findings.bodies_missing = !requests.empty();
}

/// Puts the contacts that this rank has found back into the contact table. exchange_results has received the impulses
/// of those that other ranks solved; the other impulses are copied here.
void take_back_rows(RankRegions& regions, ContactTable& contacts) {
    if (!regions.exchanged) return;
    for (std::size_t c = 0; c < regions.found.size(); ++c) {
        const Index row = regions.solved_row[c];
        if (row < 0) continue;
        regions.found.impulse[c] = contacts.impulse[row];
        regions.found.region[c] = contacts.region[row];
    }
    std::swap(contacts, regions.found);
    regions.exchanged = false;
}

}  // namespace

void list_row_exchange(WorldState& w, TaskGraph& g) {
    if (!w.ranks.on()) return;
    const Model& m = w.model;
    g.stage("ranks/exchange_rows", exchange_rows, inputs<SharedBodies>(w.ranks, m.bodies, m.nodes),
            inputs<RegionGroups>(m), inputs<JoinedBodies>(m), value(w.ranks.label_rounds), make(w.scratch.contacts),
            make(w.scratch.rank_regions), make(w.ranks.requests), make(w.ranks.own_findings), make(w.ranks.channel));
}

void list_rows_taken_back(WorldState& w, TaskGraph& g) {
    if (!w.ranks.on()) return;
    g.stage("ranks/take_back_rows", take_back_rows, make(w.scratch.rank_regions), make(w.scratch.contacts));
}

}  // namespace skerry
