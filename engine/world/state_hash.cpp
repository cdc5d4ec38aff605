#include "engine/world/state_hash.h"

#include <algorithm>
#include <numeric>
#include <vector>

#include "components/check.h"
#include "components/hash.h"
#include "engine/world/edit/joining_rows.h"

namespace skerry {

namespace {

constexpr std::uint32_t nothing = 0xffffffffu;

template <class T>
void add_rows(Hash& hash, std::span<const T> rows) {
    hash.add(rows.data(), rows.size_bytes());
}
template <class T>
void add_row(Hash& hash, const T& row) {
    hash.add(&row, sizeof row);
}
/// Hashes the members of a struct one by one, since the struct may have padding bytes. Values of enums are hashed as
/// 64-bit numbers.
void add_members(Hash& hash, const RowType& type, const std::byte* row) {
    for (const Member& member : type.members()) {
        const std::byte* const address = row + member.offset;
        if (member.type->values > 0)
            hash.add(static_cast<std::uint64_t>(number_at(address, member.type->number)));
        else
            hash.add(address, member.type->bytes);
    }
}

void add_rows(Hash& hash, AnyColumn column, std::size_t first, std::size_t count) {
    const RowType& type = column.type();
    SKERRY_CHECK(first + count <= column.size());
    const std::byte* const rows = column.read() + first * type.bytes;
    if (type.members == nullptr)
        hash.add(rows, count * type.bytes);
    else
        for (std::size_t i = 0; i < count; ++i) add_members(hash, type, rows + i * type.bytes);
}

/// Hashes the given rows of every column of a table that has the role `state`. Rows beyond the end of a column are left
/// out. A range of negative size stands for all rows from its begin, because the size wraps to a large unsigned number.
void add_state(Hash& hash, AnyTable table, Range rows) {
    for (const ColumnInfo& info : table.columns()) {
        if (info.role != ColumnRole::state) continue;
        const AnyColumn column = table.column(info);
        const auto first = static_cast<std::size_t>(rows.begin);
        add_rows(hash, column, first, std::min(static_cast<std::size_t>(rows.size()), column.size() - first));
    }
}

Range single(std::size_t row) {
    return {static_cast<Index>(row), static_cast<Index>(row) + 1};
}

std::uint32_t slot_of(std::span<const std::uint32_t> slot, Index row) {
    return row == no_index ? nothing : slot[static_cast<std::size_t>(row)];
}

/// Returns the rows of a table, sorted by the slots of their handles. Rows with equal slots stay in order.
std::vector<std::size_t> in_slot_order(std::span<const std::uint32_t> slot) {
    std::vector<std::size_t> order(slot.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, {}, [&](std::size_t row) { return slot[row]; });
    return order;
}

void add_nodes(Hash& hash, Model& model, std::size_t body) {
    const Range nodes = model.bodies.nodes[body], blocks = model.bodies.node_blocks[body];
    const Index row = static_cast<Index>(body);
    add_state(hash, model.nodes, nodes);
    for (Index n = nodes.begin; n < nodes.end; ++n) add_row(hash, model.nodes.body[n] - row);
    for (Index k = blocks.begin; k < blocks.end; ++k) {
        add_row(hash, model.node_blocks.begin[k] - nodes.begin);
        add_row(hash, model.node_blocks.end[k] - nodes.begin);
        add_row(hash, model.node_blocks.body[k] - row);
    }
}

void add_elements(Hash& hash, Model& model, std::size_t body) {
    const Range tetrahedra = model.bodies.tetrahedron_blocks[body], blocks = model.bodies.blocks[body],
                rows = model.bodies.element_nodes[body];
    const Index first_node = model.bodies.nodes[body].begin, row = static_cast<Index>(body);
    add_state(hash, model.tetrahedra, tetrahedra);
    for (Index t = tetrahedra.begin; t < tetrahedra.end; ++t)
        for (const NodeLane& corner : model.tetrahedra.node[t])
            for (Index node : corner.lane) add_row(hash, node - first_node);
    add_state(hash, model.element_nodes, rows);
    for (Index k = rows.begin; k < rows.end; ++k)
        for (Index node : model.element_nodes.node[k].lane) add_row(hash, node - first_node);
    add_state(hash, model.elements, blocks);
    for (Index e = blocks.begin; e < blocks.end; ++e) {
        add_row(hash, model.elements.first[e] - rows.begin);
        add_row(hash, model.elements.body[e] - row);
        hash.add(slot_of(model.materials.slot, model.elements.material[e]));
    }
}

void add_clusters(Hash& hash, const Model& model, std::size_t body) {
    const NodeClusters& clusters = model.clusters;
    for (std::size_t c = 0; c < clusters.size(); ++c) {
        if (clusters.body[c] != static_cast<Index>(body)) continue;
        const std::span<const Index> nodes = clusters.nodes[c];
        for (const Index n : nodes) add_row(hash, n - model.bodies.nodes[body].begin);
        add_rows(hash, clusters.inverse.span().subspan(clusters.first_entry[c], nodes.size() * nodes.size()));
    }
}

void add_script(Hash& hash, const MotionScript& script, std::span<const Keyframe> keyframe) {
    add_row(hash, script.velocity);
    add_row(hash, script.angular_velocity);
    for (Index k = script.key_begin; k < script.key_end; ++k) add_row(hash, keyframe[static_cast<std::size_t>(k)]);
    add_row(hash, script.key_end - script.key_begin);
    if (script.start != 0) add_row(hash, script.start);
}

/// Hashes the collision filter of an object unless it is the default filter.
void add_filter(Hash& hash, const CollisionFilter& filter) {
    if (filter != CollisionFilter{}) add_row(hash, filter);
}

/// Hashes one row of every column of a table that has the role `state` and one row for each row of the table. Columns
/// that contain row numbers of other tables have the role `link`, and are left out.
void add_row_state(Hash& hash, AnyTable table, std::size_t row) {
    for (const ColumnInfo& info : table.columns())
        if (info.role == ColumnRole::state && info.has_row_each) add_rows(hash, table.column(info), row, 1);
}

void add_attachment(Hash& hash, Model& model, std::size_t a) {
    AttachmentTable& table = model.attachments;
    const auto body = static_cast<std::size_t>(table.body[a]);
    add_row_state(hash, table, a);
    hash.add(static_cast<std::uint64_t>(model.bodies.kind[body]));
    hash.add(model.bodies.slot[body]);
    for (Index i = table.nodes[a].begin; i < table.nodes[a].end; ++i) {
        add_row(hash, table.node[i] - model.bodies.nodes[body].begin);
        add_row(hash, table.anchor[i]);
    }
    add_row(hash, table.nodes[a].size());
    add_script(hash, table.script[a], table.keyframe);
}

/// Hashes a row that joins bodies, such as a joint. Joined bodies and colliders are hashed by the slots of their
/// handles, because their rows change when other objects are removed.
template <class Table>
void add_joining_row(Hash& hash, const Model& model, Table& of, std::size_t row) {
    const AnyTable table(of);
    add_row_state(hash, table, row);
    for (const ColumnInfo& info : table.columns()) {
        if (info.role != ColumnRole::body && info.role != ColumnRole::collider) continue;
        const std::span<const std::uint32_t> slot =
            info.role == ColumnRole::body ? model.bodies.slot.span() : model.colliders.slot.span();
        const Range entries = entries_of(of, info, row);
        for (Index entry = entries.begin; entry < entries.end; ++entry)
            hash.add(slot_of(slot, reinterpret_cast<const Index*>(table.column(info).read())[entry]));
    }
    if constexpr (requires { of.list_of(row); }) {
        const Range list = of.list_of(row);
        hash.add(list.size());
        for (const ColumnInfo& info : table.columns())
            if (info.role == ColumnRole::state && !info.has_row_each && !table.column(info).is(&of.key))
                add_rows(hash, table.column(info), static_cast<std::size_t>(list.begin),
                         static_cast<std::size_t>(list.size()));
    }
}

/// Hashes the time keys (values at given times) of all rows of a table. Rows without keys are left out.
template <class Table>
void add_keys(Hash& hash, const Table& table) {
    for (const std::size_t row : in_slot_order(table.slot)) {
        const std::span<const TimeKey> keys = table.keys_of(row);
        if (keys.empty()) continue;
        hash.add(table.slot[row]);
        add_rows(hash, keys);
        hash.add(keys.size());
    }
}

/// Hashes the tied nodes of all ties.
void add_tied_nodes(Hash& hash, TieTable& table) {
    for (const std::size_t row : in_slot_order(table.slot)) {
        const auto begin = static_cast<std::size_t>(table.nodes[row].begin),
                   count = static_cast<std::size_t>(table.nodes[row].size());
        table.for_each_node_column(
            [&](const char*, auto& column, ColumnRole) { add_rows(hash, AnyColumn(column), begin, count); });
        hash.add(count);
    }
}

/// Hashes the members of all surface sets, and the row of each set. The row matters where sets overlap: there the set
/// with the last row applies.
void add_members_of_sets(Hash& hash, const SurfaceSetTable& table) {
    for (const std::size_t row : in_slot_order(table.slot)) {
        hash.add(table.slot[row]);
        hash.add(row);
        add_rows(hash, table.members_of(row));
        hash.add(table.members_of(row).size());
    }
}

/// Hashes the faces of all rows of a table such as CavityTable, and the stored positions of their corners.
template <class Table>
void add_faces(Hash& hash, const Table& table) {
    for (const std::size_t row : in_slot_order(table.slot)) {
        add_rows(hash, table.faces_of(row));
        add_rows(hash, table.corners_of(row));
    }
}

/// Hashes the nodes and weights of all loads.
void add_shares(Hash& hash, const LoadTable& loads) {
    for (const std::size_t row : in_slot_order(loads.slot)) {
        if (loads.nodes[row].size() == 0) continue;
        hash.add(loads.slot[row]);
        add_rows(hash, loads.nodes_of(row));
        add_rows(hash, loads.weights_of(row));
    }
}

void add_collider(Hash& hash, Model& model, std::size_t c) {
    ColliderTable& table = model.colliders;
    add_row_state(hash, table, c);
    add_script(hash, table.script[c], table.keyframe);
    add_filter(hash, table.filter[c]);
    if (table.material[c] != no_index) hash.add(static_cast<std::uint32_t>(table.material[c]));
    if (table.body[c] != no_index) hash.add(body_hash(model, static_cast<std::size_t>(table.body[c])));
}

/// Hashes overlapping pairs of objects in the order of their keys, which name bodies and colliders by slot. Pairs
/// without overlap are left out: a search finds them again, and it depends on the last search which of them are stored.
void add_pairs(Hash& hash, const Model& model, const PairTable& pairs) {
    for (std::size_t p = 0; p < pairs.size(); ++p) {
        if (pairs.state[p] != PairState::overlapping) continue;
        add_row(hash, pairs.key[p]);
        add_row(hash, pairs.kind[p]);
        hash.add(slot_of(model.bodies.slot, pairs.first[p]));
        hash.add(
            slot_of(pairs.kind[p] == PairKind::collider ? model.colliders.slot : model.bodies.slot, pairs.second[p]));
    }
}

void add_clock(Hash& hash, const Model& model, const Clock& clock) {
    add_row(hash, clock.time);
    add_row(hash, clock.offset);
    add_row(hash, clock.step_before);
    add_row(hash, model.watch.steps);
}

}  // namespace

std::uint64_t body_hash(Model& model, std::size_t body) {
    Hash hash;
    BodyTable& bodies = model.bodies;
    add_state(hash, bodies, single(body));
    hash.add(slot_of(model.materials.slot, bodies.material[body]));
    hash.add(slot_of(model.colliders.slot, bodies.collider[body]));
    add_filter(hash, bodies.filter[body]);
    if (bodies.surface[body] != SurfaceProperties{}) add_row(hash, bodies.surface[body]);
    for (Range range : {bodies.nodes[body], bodies.node_blocks[body], bodies.blocks[body]}) add_row(hash, range.size());
    add_nodes(hash, model, body);
    add_elements(hash, model, body);
    add_clusters(hash, model, body);
    if (const Range rigid = bodies.rigid[body]; rigid != Range{rigid.begin, rigid.begin}) {
        add_row(hash, rigid.size());
        if (rigid.size() == 1) {
            add_state(hash, model.rigid_bodies, rigid);
            const bool its_own =
                model.rigid_bodies.body[static_cast<std::size_t>(rigid.begin)] == static_cast<Index>(body);
            add_row(hash, its_own);
            if (const std::uint8_t large = model.rigid_bodies.large[static_cast<std::size_t>(rigid.begin)]; large != 0)
                add_row(hash, large);
        }
    }
    if (const Range implicit = bodies.implicit[body]; implicit != Range{implicit.begin, implicit.begin}) {
        add_row(hash, implicit.size());
        if (implicit.size() == bodies.nodes[body].size()) {
            add_state(hash, model.implicit_nodes, implicit);
            const std::span<const Vec3> left = rows_of(model.implicit_nodes.left, implicit);
            if (std::ranges::any_of(left, [](const Vec3& of_node) { return !of_node.isZero(0); })) add_rows(hash, left);
        }
    }
    return hash.value();
}

std::uint64_t state_hash(WorldState& world) {
    Model& model = world.model;
    Hash hash;
    add_clock(hash, model, world.clock);
    add_row(hash, model.settings.gravity);
    for (std::size_t m : in_slot_order(model.materials.slot)) add_state(hash, model.materials, single(m));
    for (std::size_t b : in_slot_order(model.bodies.slot))
        if (model.bodies.kind[b] == BodyKind::deformable) hash.add(body_hash(model, b));
    for (std::size_t c : in_slot_order(model.colliders.slot)) add_collider(hash, model, c);
    for (std::size_t a : in_slot_order(model.attachments.slot)) add_attachment(hash, model, a);
    model.for_each_joining([&](const char*, auto& table, auto&) {
        for (std::size_t row : in_slot_order(table.slot)) add_joining_row(hash, model, table, row);
        if constexpr (requires { table.keys_of(0); }) add_keys(hash, table);
        if constexpr (requires { table.members_of(0); }) add_members_of_sets(hash, table);
        if constexpr (requires { table.faces_of(0); }) add_faces(hash, table);
    });
    add_tied_nodes(hash, model.ties);
    add_shares(hash, model.loads);
    add_rows(hash, std::span<const std::uint64_t>(model.disabled_pairs.key));
    add_state(hash, model.material_pairs, {0, static_cast<Index>(model.material_pairs.size())});
    const AnyTable warm_start(world.cache.warm_start);
    for (const ColumnInfo& info : warm_start.columns()) {
        const AnyColumn column = warm_start.column(info);
        add_rows(hash, column, 0, column.size());
    }
    if (RestingContactTable& resting = world.cache.resting; !resting.empty())
        add_state(hash, resting, {0, static_cast<Index>(resting.size())});
    add_pairs(hash, model, world.cache.pairs);
    return hash.value();
}

}  // namespace skerry
