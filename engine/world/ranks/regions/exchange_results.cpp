// Exchange of results after the solve. The rank that has solved a region sends the velocities and impulses of its
// bodies to all other ranks that hold these bodies.
#include <cstddef>

#include "engine/world/ranks/regions/rank_regions.h"
#include "engine/world/step/seams.h"
#include "engine/world/step/step.h"
#include "systems/dynamics/motion/hold_axes.h"

namespace skerry {

namespace {

/// Velocities of a node after the solve. A record with name.body == no_index ends a list.
struct MailedNode {
    NodeName name;
    Vec3 velocity = Vec3::Zero(), push = Vec3::Zero();  // NodeTable: velocity_next, push_out [m/s]
};

/// Results for a rigid body, or for the frame of an implicit body: contact impulse and moment, and the velocity and
/// spin of the push-out, which reduces overlaps (RigidBodyTable). A record without body (no_index) ends a list.
struct MailedBody {
    Index body = no_index;  // row of the body in the undivided world
    Index deforming = 0;    // number of records MailedDeformation that follow
    Vec3 impulse = Vec3::Zero(), moment = Vec3::Zero(), push = Vec3::Zero(), push_spin = Vec3::Zero();
};

/// Contact impulse on a node of an implicit body (ImplicitNodeTable) [N s].
struct MailedDeformation {
    Index node = no_index;  // number of the node within the body
    Vec3 impulse = Vec3::Zero();
};

/// Impulse of a row of the contact table that holds a node along a single direction. A record with body == no_index
/// ends a list.
struct MailedHold {
    Index body = no_index;  // row of the body in the undivided world
    Index entry = 0;        // index in the concatenated node lists of all attachments of the body
    Vec3 impulse = Vec3::Zero();
};

/// Rows of the contact table that hold nodes along single directions (hold rows). They come after the rows of ties.
struct HoldRows {
    std::span<const Index> entry;  // by hold row: row of AttachmentTable::node
    std::span<const Index> body;   // by attachment: row of BodyTable
    std::span<const Range> nodes;  // by attachment: rows of AttachmentTable::node
    std::span<Vec3> impulse;       // by row of AttachmentTable::node [N s]

    static HoldRows bind(const Binder& binder, const AttachmentTable& attachment, const HeldRows& rows,
                         Column<Vec3>& impulse) {
        return {.entry = binder.read(rows.entry),
                .body = binder.read(attachment.body),
                .nodes = binder.read(attachment.nodes),
                .impulse = binder.write(impulse)};
    }

    /// Calls visit(range) for the held nodes of each attachment of a body.
    void for_each_range(Index of_body, auto&& visit) const {
        for (std::size_t a = 0; a < body.size(); ++a)
            if (body[a] == of_body) visit(nodes[a]);
    }
    /// Index of a held node in the concatenated node lists of all attachments of its body. `row`: row of
    /// AttachmentTable::node.
    Index number(Index of_body, Index row) const {
        Index before = 0, found = no_index;
        for_each_range(of_body, [&](const Range& range) {
            if (row >= range.begin && row < range.end) found = before + row - range.begin;
            before += static_cast<Index>(range.size());
        });
        return found;
    }
    /// Inverse of number().
    Index row(Index of_body, Index number) const {
        Index found = no_index;
        for_each_range(of_body, [&](const Range& range) {
            if (number >= 0 && number < static_cast<Index>(range.size())) found = range.begin + number;
            number -= static_cast<Index>(range.size());
        });
        return found;
    }
};

/// Nodes, bodies and contact rows whose results are exchanged.
struct SolvedRows {
    std::span<const Real> inverse_mass;  // by node [1/kg]
    const NodeClusters& clusters;
    std::span<const Range> body_rigid, body_implicit;  // BodyTable
    std::size_t tie_count;                             // number of rows of ties in the contact table
    std::span<const Index> region;                     // by contact
    std::span<const Stencil> stencil;                  // by contact

    static SolvedRows bind(const Binder& binder, const Model& model, const ContactTable& contacts,
                           const TieRowTable& ties) {
        const std::size_t rows = binder.read(ties.tie).size();
        return {.inverse_mass = binder.read(model.nodes.inverse_mass),
                .clusters = binder.read(model.clusters),
                .body_rigid = binder.read(model.bodies.rigid),
                .body_implicit = binder.read(model.bodies.implicit),
                .tie_count = binder.read(model.ties.slot).empty() ? 0 : rows,
                .region = binder.read(contacts.region),
                .stencil = binder.read(contacts.stencil)};
    }
    /// Row of RigidBodyTable of a body, or no_index.
    Index frame(Index body) const {
        const Range rows = body_rigid[static_cast<std::size_t>(body)];
        return rows.size() > 0 ? rows.begin : no_index;
    }
};

class ResultExchange {
public:
    ResultExchange(const SharedBodies& bodies, const SolvedRows& rows, const HoldRows& holds, JointBlockTable& joints,
                   CableBlockTable& cables, const RegionOutputs& out, RegionTable& table, RankRegions& regions)
        : bodies_(bodies),
          rows_(rows),
          holds_(holds),
          joints_(joints),
          cables_(cables),
          out_(out),
          table_(table),
          regions_(regions) {}

    void run(RankChannel& channel) {
        zero_left_out_rows();
        list_moved();
        send();
        channel.ranks->exchange(bodies_.peers, regions_.mail.out, regions_.mail.in);
        regions_.touched_bodies.clear();
        regions_.pushed = false;
        for (const Index node : regions_.nodes) regions_.touched_bodies.push_back(bodies_.body_of(node));
        regions_.unit_from.assign(regions_.unit.size(), -1);
        for (std::size_t p = 0; p < bodies_.peers.size(); ++p) receive(p);
    }

private:
    bool is_solved_here(Index body) const {
        return regions_.solved_elsewhere.empty() || !regions_.solved_elsewhere[body];
    }

    /// Sets the impulses of hold rows (contact rows that hold nodes along single directions) to zero if another rank
    /// solves them. Such rows are in no region of this rank, and still contain the impulses with which a solver would
    /// start.
    void zero_left_out_rows() {
        for (std::size_t row = regions_.contact_count + rows_.tie_count; row < rows_.region.size(); ++row)
            if (rows_.region[row] == no_index) out_.impulse[row].setZero();
    }

    /// Lists the nodes and bodies that this rank has moved by solving its contact regions, if other ranks hold them.
    void list_moved() {
        regions_.nodes.clear();
        regions_.bodies.clear();
        regions_.sets.start(rows_.inverse_mass.size());
        regions_.visited.assign(bodies_.size(), 0);
        for (std::size_t c = 0; c < rows_.region.size(); ++c)
            if (rows_.region[c] != no_index) list_nodes(rows_.stencil[c]);
        for (const CableBlock& cable : cables_.solved())
            for (const Stencil& stencil : rows_of(cables_.stencil.span(), cable.points))
                if (is_solved_here(body_of_cable(cable))) list_nodes(stencil);
        for (const JointBlock& joint : joints_.block)
            for (const Index node : {joint.first_node, joint.second_node})
                if (node != no_index && is_solved_here(bodies_.body_of(node))) list_body(bodies_.body_of(node));
    }

    void list_nodes(const Stencil& stencil) {
        for (std::size_t a = 0; a < 4; ++a) {
            const Index node = stencil.node[a];
            if (stencil.weight[a] == 0 || !(rows_.inverse_mass[static_cast<std::size_t>(node)] > 0)) continue;
            const Index body = bodies_.body_of(node);
            if (bodies_.holders_of(body).empty() || !list_node(node)) continue;
            list_body(body);
            if (const Index cluster = rows_.clusters.cluster(node); cluster != no_index)
                for (const Index other : rows_.clusters.nodes[static_cast<std::size_t>(cluster)]) list_node(other);
        }
    }
    /// Adds a node to the list of moved nodes. Returns false if the node is already in the list.
    bool list_node(Index node) {
        if (regions_.sets.node[node].stamp == regions_.sets.now) return false;
        regions_.nodes.push_back(regions_.sets.root(node));
        return true;
    }
    void list_body(Index body) {
        if (regions_.visited[body] || rows_.frame(body) == no_index) return;
        regions_.visited[body] = 1;
        regions_.bodies.push_back(body);
    }

    Index body_of_cable(const CableBlock& cable) const {
        for (const Stencil& stencil : rows_of(cables_.stencil.span(), cable.points))
            for (std::size_t a = 0; a < 4; ++a)
                if (stencil.weight[a] != 0) return bodies_.body_of(stencil.node[a]);
        return no_index;
    }

    /// Calls visit(unit, number) for each result, such as an impulse, of the joints, ties and cables in the units for
    /// which wants(unit) is true. `unit`: first body of a set of connected bodies. All ranks that hold a unit have its
    /// rows in the same order, so messages need not name the rows.
    void for_each_result_of_units(auto&& wants, auto&& visit) {
        if (regions_.unit.empty()) return;
        const auto wanted_unit = [&](Index body) {
            const Index unit = body == no_index ? no_index : regions_.unit[body];
            return unit != no_index && wants(unit) ? unit : no_index;
        };
        for (std::size_t j = 0; j < joints_.size(); ++j) {
            const Index unit = wanted_unit(bodies_.body_of(joints_.block[j].moving_node()));
            if (unit == no_index) continue;
            visit(unit, out_.joint_impulse[j]);
            visit(unit, out_.axis_impulse[j]);
        }
        for (std::size_t row = regions_.contact_count; row < regions_.contact_count + rows_.tie_count; ++row)
            if (const Index unit = wanted_unit(bodies_.body_of(rows_.stencil[row].node[0])); unit != no_index)
                visit(unit, out_.impulse[row]);
        for (std::size_t c = 0; c < cables_.solved().size(); ++c) {
            const CableBlock& cable = cables_.solved()[c];
            const Index unit = wanted_unit(body_of_cable(cable));
            if (unit == no_index) continue;
            for (Real& tension : rows_of(out_.cable_impulse, cable.points)) visit(unit, tension);
            visit(unit, out_.cable_work[c]);
            visit(unit, out_.cable_loss[c]);
            visit(unit, out_.cable_sum[c]);
        }
    }

    /// Writes one message for each peer, with this content:
    /// - RegionTable::pushed, which is nonzero if the solver has pushed bodies out of overlaps
    /// - the impulses of the contacts that the peer has sent
    /// - lists of nodes, bodies, hold rows and units, each ended by an empty record
    /// - the results of the joints, ties and cables of the listed units
    void send() {
        const std::size_t peers = bodies_.peers.size();
        RankMail& mail = regions_.mail;
        mail.start(peers);
        Index contact = 0;
        for (std::size_t p = 0; p < peers; ++p) {
            mail.put(p, Index{table_.pushed});
            for (; contact < regions_.received_end[p]; ++contact)
                mail.put(p, out_.impulse[regions_.received_row[contact]]);
        }
        for (const Index node : regions_.nodes)
            for (const int p : bodies_.holders_of(bodies_.body_of(node)))
                mail.put(static_cast<std::size_t>(p),
                         MailedNode{bodies_.name(node), out_.velocity_next[node], out_.push_out[node]});
        for (std::size_t p = 0; p < peers; ++p) mail.put(p, MailedNode{});
        for (const Index body : regions_.bodies)
            for (const int p : bodies_.holders_of(body)) send_body(static_cast<std::size_t>(p), body);
        for (std::size_t p = 0; p < peers; ++p) mail.put(p, MailedBody{});
        send_holds();
        for (std::size_t p = 0; p < peers; ++p) mail.put(p, MailedHold{});
        for (std::size_t b = 0; b < regions_.unit.size(); ++b)
            if (regions_.unit[b] == static_cast<Index>(b) && is_solved_here(static_cast<Index>(b)))
                for (const int p : bodies_.holders_of(static_cast<Index>(b)))
                    mail.put(static_cast<std::size_t>(p), bodies_.world_row[b]);
        for (std::size_t p = 0; p < peers; ++p) mail.put(p, no_index);
        for_each_result_of_units([&](Index unit) { return is_solved_here(unit); },
                                 [&](Index unit, const auto& number) {
                                     for (const int p : bodies_.holders_of(unit))
                                         mail.put(static_cast<std::size_t>(p), number);
                                 });
    }

    void send_holds() {
        const std::size_t first = regions_.contact_count + rows_.tie_count;
        for (std::size_t row = first; row < rows_.region.size(); ++row) {
            if (rows_.region[row] == no_index) continue;
            const Index body = bodies_.body_of(rows_.stencil[row].node[0]);
            const std::span<const int> holders = bodies_.holders_of(body);
            if (holders.empty()) continue;
            const MailedHold hold{bodies_.world_row[static_cast<std::size_t>(body)],
                                  holds_.number(body, holds_.entry[row - first]), out_.impulse[row]};
            for (const int p : holders) regions_.mail.put(static_cast<std::size_t>(p), hold);
        }
    }

    void send_body(std::size_t peer, Index body) {
        const auto frame = static_cast<std::size_t>(rows_.frame(body));
        const std::span<const Vec3> deforming =
            rows_of(std::span<const Vec3>(out_.deforming_impulse), rows_.body_implicit[static_cast<std::size_t>(body)]);
        const auto is_zero = [](const Vec3& impulse) { return impulse == Vec3::Zero(); };
        regions_.mail.put(peer, MailedBody{bodies_.world_row[static_cast<std::size_t>(body)],
                                           static_cast<Index>(deforming.size()) -
                                               static_cast<Index>(std::ranges::count_if(deforming, is_zero)),
                                           out_.contact_impulse[frame], out_.contact_moment[frame],
                                           out_.push_velocity[frame], out_.push_spin[frame]});
        for (std::size_t n = 0; n < deforming.size(); ++n)
            if (!is_zero(deforming[n])) regions_.mail.put(peer, MailedDeformation{static_cast<Index>(n), deforming[n]});
    }

    void receive(std::size_t peer) {
        MailReader reader(regions_.mail.in[peer]);
        table_.pushed |= reader.take<Index>() != 0;
        if (regions_.exchanged)
            for (std::size_t c = 0; c < regions_.found.size(); ++c)
                if (regions_.solved_row[c] == -1 - static_cast<Index>(peer))
                    regions_.found.impulse[c] = reader.take<Vec3>();
        for (MailedNode mail = reader.take<MailedNode>(); mail.name.body != no_index;
             mail = reader.take<MailedNode>()) {
            const Index node = bodies_.node_of(mail.name);
            out_.velocity_next[node] = mail.velocity;
            out_.push_out[node] = mail.push;
            regions_.pushed |= mail.push != Vec3::Zero();
            regions_.touched_bodies.push_back(bodies_.body_of(node));
        }
        for (MailedBody mail = reader.take<MailedBody>(); mail.body != no_index; mail = reader.take<MailedBody>())
            receive_body(mail, reader);
        for (MailedHold mail = reader.take<MailedHold>(); mail.body != no_index; mail = reader.take<MailedHold>())
            holds_.impulse[holds_.row(bodies_.row_of(mail.body), mail.entry)] += mail.impulse;
        for (Index world_row = reader.take<Index>(); world_row != no_index; world_row = reader.take<Index>())
            regions_.unit_from[bodies_.row_of(world_row)] = static_cast<int>(peer);
        for_each_result_of_units([&](Index unit) { return regions_.unit_from[unit] == static_cast<int>(peer); },
                                 [&]<class Number>(Index, Number& number) { number = reader.take<Number>(); });
        SKERRY_CHECK(reader.at_end());
    }

    void receive_body(const MailedBody& mail, MailReader& reader) {
        const Index body = bodies_.row_of(mail.body);
        const auto frame = static_cast<std::size_t>(rows_.frame(body));
        out_.contact_impulse[frame] = mail.impulse;
        out_.contact_moment[frame] = mail.moment;
        out_.push_velocity[frame] = mail.push;
        out_.push_spin[frame] = mail.push_spin;
        const Index first = rows_.body_implicit[static_cast<std::size_t>(body)].begin;
        for (Index n = 0; n < mail.deforming; ++n) {
            const MailedDeformation deformation = reader.take<MailedDeformation>();
            out_.deforming_impulse[first + deformation.node] = deformation.impulse;
        }
    }

    const SharedBodies& bodies_;
    const SolvedRows& rows_;
    const HoldRows& holds_;
    JointBlockTable& joints_;
    CableBlockTable& cables_;
    const RegionOutputs& out_;
    RegionTable& table_;
    RankRegions& regions_;
};

void exchange_results(const SharedBodies& bodies, const SolvedRows& rows, const HoldRows& holds,
                      const RegionOutputs& out, JointBlockTable& joints, CableBlockTable& cables, RegionTable& table,
                      SolverMemory& solver, RankRegions& regions, RankChannel& channel) {
    ResultExchange(bodies, rows, holds, joints, cables, out, table, regions).run(channel);
    if (regions.pushed) solver.note_push();
}

}  // namespace

void list_result_exchange(WorldState& w, TaskGraph& g) {
    if (!w.ranks.on()) return;
    Model& m = w.model;
    StepScratch& s = w.scratch;
    g.stage("ranks/exchange_results", exchange_results, inputs<SharedBodies>(w.ranks, m.bodies, m.nodes),
            inputs<SolvedRows>(m, s.contacts, s.ties), outputs<HoldRows>(m.attachments, s.held_rows, s.axis_impulse),
            outputs<RegionOutputs>(s.contacts, m.nodes, m.rigid_bodies, m.implicit_nodes, s.joints, s.cables),
            make(s.joints), make(s.cables), make(s.regions), make(s.solver_memory), make(s.rank_regions),
            make(w.ranks.channel));
}

}  // namespace skerry
