#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "engine/mesh/surface/check_shells.h"
#include "engine/world/save/checks.h"
#include "systems/collision/inputs/contact_key.h"

namespace skerry {

namespace {

void check_sizes(const SavedFile& file, Model& model) {
    const std::size_t nodes = model.nodes.position.size();
    model.nodes.rest_position.resize(nodes);
    const auto all = [&](const char* name, AnyTable table, std::size_t rows) {
        expect_one_size(file, name, table, rows);
    };
    all("nodes", model.nodes, nodes);
    all("node_blocks", model.node_blocks, model.node_blocks.begin.size());
    all("tetrahedra", model.tetrahedra, model.tetrahedra.node.size());
    all("elements", model.elements, model.elements.first.size());
    all("element_nodes", model.element_nodes, model.element_nodes.node.size());
    all("bodies", model.bodies, model.bodies.slot.size());
    all("rigid_bodies", model.rigid_bodies, model.rigid_bodies.size());
    all("implicit_nodes", model.implicit_nodes, model.implicit_nodes.size());
    all("materials", model.materials, model.materials.slot.size());
    model.for_each_joining([&](const char* name, auto& table, auto&) { all(name, table, table.slot.size()); });
    all("colliders", model.colliders, model.colliders.slot.size());
    all("attachments", model.attachments, model.attachments.slot.size());
    expect_size(file, "attachments/anchor", model.attachments.anchor.size(), model.attachments.node.size());
}

/// Checks that each row with a slot has a handle, and that each handle in use has a row.
template <class Handle>
void check_handles(const SavedFile& file, const std::string& name, HandleMap<Handle>& map,
                   const std::vector<std::uint32_t>& slot_of_row) {
    const std::string path = "handles/" + name;
    std::span<const Index> row;
    std::size_t generations = 0;
    map.for_each_column([&](const char*, auto& values) {
        if constexpr (std::is_same_v<std::decay_t<decltype(values[0])>, Index>)
            row = values.span();
        else
            generations = values.size();
    });
    expect_size(file, path + "/generation", generations, row.size());
    expect_rows_of(file, path + "/row", row, slot_of_row.size(), true);
    std::size_t named = 0;
    for (std::size_t slot = 0; slot < row.size(); ++slot) {
        if (row[slot] == no_index) continue;
        ++named;
        if (slot_of_row[static_cast<std::size_t>(row[slot])] != slot)
            file.complain(path + "/row", "row " + std::to_string(row[slot]) + " in slot " + std::to_string(slot),
                          "the row of " + name + " with this slot");
    }
    std::size_t with_slot = 0;
    for (const std::uint32_t slot : slot_of_row) with_slot += slot != no_slot;
    if (named != with_slot)
        file.complain(path + "/row", std::to_string(named) + " rows with a handle",
                      std::to_string(with_slot) + ", the number of rows of " + name + " with a slot");
}

void check_handles(const SavedFile& file, Model& model) {
    const auto slots = [](const Column<std::uint32_t>& slot) { return std::vector(slot.begin(), slot.end()); };
    std::vector<std::uint32_t> of_bodies = slots(model.bodies.slot);
    for (std::size_t b = 0; b < of_bodies.size(); ++b)
        if (model.bodies.kind[b] == BodyKind::kinematic) of_bodies[b] = no_slot;
    check_handles(file, "materials", model.material_map, slots(model.materials.slot));
    check_handles(file, "bodies", model.body_map, of_bodies);
    check_handles(file, "colliders", model.collider_map, slots(model.colliders.slot));
    check_handles(file, "attachments", model.attachment_map, slots(model.attachments.slot));
    model.for_each_joining(
        [&](const char* name, auto& table, auto& map) { check_handles(file, name, map, slots(table.slot)); });
}

void check_bodies(const SavedFile& file, const Model& model) {
    const BodyTable& bodies = model.bodies;
    expect_rows_of(file, "bodies/material", bodies.material, model.materials.slot.size(), true);
    expect_rows_of(file, "bodies/collider", bodies.collider, model.colliders.slot.size(), true);
    expect_partition(file, "bodies/nodes", bodies.nodes, model.nodes.position.size());
    expect_partition(file, "bodies/node_blocks", bodies.node_blocks, model.node_blocks.begin.size());
    expect_partition(file, "bodies/blocks", bodies.blocks, model.elements.first.size());
    expect_partition(file, "bodies/element_nodes", bodies.element_nodes, model.element_nodes.node.size());
    expect_partition(file, "bodies/tetrahedron_blocks", bodies.tetrahedron_blocks, model.tetrahedra.node.size());
    expect_partition(file, "bodies/rigid", bodies.rigid, model.rigid_bodies.size());
    expect_partition(file, "bodies/implicit", bodies.implicit, model.implicit_nodes.size());
    expect_between(file, "bodies/stable_step", bodies.stable_step, 0.0, infinity);
    expect_between(file, "bodies/rest_step", bodies.rest_step, 0.0, infinity);
    expect_between(file, "bodies/contact_distance", bodies.contact_distance, 0.0, infinity);
    expect_between(file, "bodies/core_nodes", bodies.core_nodes, 0, cylinder_core_nodes);
    expect_between(file, "bodies/round_radius", bodies.round_radius, 0.0, infinity);
    for (std::size_t b = 0; b < bodies.slot.size(); ++b) {
        const auto complain = [&](const char* field, const std::string& found, const std::string& expected) {
            file.complain(std::string("bodies/") + field, found + " at row " + std::to_string(b), expected);
        };
        const bool deforms = bodies.kind[b] == BodyKind::deformable;
        if (deforms != (bodies.material[b] != no_index))
            complain("material", std::to_string(bodies.material[b]),
                     "the index of a material for a body, -1 for a mesh collider");
        if (deforms != (bodies.collider[b] == no_index))
            complain("collider", std::to_string(bodies.collider[b]),
                     "the index of a collider for a mesh collider, -1 for a body");
        if (!deforms && (model.colliders.body[bodies.collider[b]] != static_cast<Index>(b) ||
                         model.colliders.slot[bodies.collider[b]] != bodies.slot[b]))
            complain("collider", std::to_string(bodies.collider[b]), "the collider whose body is this row");
        if (const Index count = bodies.tetrahedron_count[b];
            count < 0 || (count + element_lanes - 1) / element_lanes != bodies.tetrahedron_blocks[b].size())
            complain("tetrahedron_count", std::to_string(count),
                     "a count that fills the " + std::to_string(bodies.tetrahedron_blocks[b].size()) +
                         " blocks of tetrahedra of the body");
        if (bodies.nodes[b].size() == 0) complain("nodes", "no nodes", "at least one node");
        const Index core = bodies.core_nodes[b];
        if (core > 0 && (bodies.rigid[b].size() != 1 || bodies.implicit[b].size() > 0))
            complain("core_nodes", std::to_string(core), "0 for a body that is not rigid");
        if (core > bodies.nodes[b].size())
            complain("core_nodes", std::to_string(core),
                     "at most " + std::to_string(bodies.nodes[b].size()) + ", the number of nodes of the body");
        if ((core > 0) != (bodies.round_radius[b] > 0))
            complain("round_radius", std::to_string(bodies.round_radius[b]), "a length > 0 if core_nodes > 0, else 0");
        if (bodies.rigid[b].size() > (deforms ? 1 : 0))
            complain("rigid", std::to_string(bodies.rigid[b].size()) + " rows",
                     "at most one row for a body, none for a mesh collider");
        if (bodies.rigid[b].size() > 0 && bodies.blocks[b].size() > 0)
            complain("blocks", std::to_string(bodies.blocks[b].size()) + " blocks of elements",
                     "none for a rigid body");
        const Index implicit = bodies.implicit[b].size();
        if (implicit > 0 && (bodies.rigid[b].size() == 0 || implicit != bodies.nodes[b].size()))
            complain("implicit", std::to_string(implicit) + " rows",
                     "one row per node for a body with a row in rigid_bodies, none for other bodies");
    }
}

/// Checks the tables in which each body has a range of rows.
void check_rows_of_bodies(const SavedFile& file, const Model& model) {
    const NodeBlockTable& blocks = model.node_blocks;
    const ElementBlockTable& elements = model.elements;
    const auto expect_body = [&](const char* path, Index found, std::size_t body, Index row) {
        if (found != static_cast<Index>(body))
            file.complain(path, at_row(found, row), std::to_string(body) + ", the body whose range contains this row");
    };
    const auto expect_nodes = [&](const char* path, const NodeLane& lanes, Range nodes, Index row) {
        for (const Index n : lanes.lane)
            if (n < nodes.begin || n >= nodes.end)
                file.complain(
                    path, "node " + at_row(n, row),
                    "a node of its body, " + std::to_string(nodes.begin) + " to " + std::to_string(nodes.end - 1));
    };
    for (std::size_t b = 0; b < model.bodies.slot.size(); ++b) {
        const Range nodes = model.bodies.nodes[b], rows = model.bodies.element_nodes[b], rigid = model.bodies.rigid[b];
        for (Index r = rigid.begin; r < rigid.end; ++r)
            expect_body("rigid_bodies/body", model.rigid_bodies.body[r], b, r);
        for (Index n = nodes.begin; n < nodes.end; ++n) expect_body("nodes/body", model.nodes.body[n], b, n);
        Index next = nodes.begin;
        for (Index k = model.bodies.node_blocks[b].begin; k < model.bodies.node_blocks[b].end; ++k) {
            expect_body("node_blocks/body", blocks.body[k], b, k);
            if (blocks.begin[k] != next || blocks.end[k] <= next || blocks.end[k] - next > nodes_per_block ||
                blocks.end[k] > nodes.end)
                file.complain("node_blocks/end", at_row(blocks.end[k], k),
                              "the end of a block of 1 to 256 nodes that begins where the previous block ends");
            next = blocks.end[k];
        }
        if (next != step_nodes_of(nodes, model.bodies.core_nodes[b]).end)
            file.complain("node_blocks/end",
                          std::to_string(next) + " as the end of the last block of body " + std::to_string(b),
                          std::to_string(step_nodes_of(nodes, model.bodies.core_nodes[b]).end) +
                              ", the end of the nodes of the body that a step moves");
        for (Index t = model.bodies.tetrahedron_blocks[b].begin; t < model.bodies.tetrahedron_blocks[b].end; ++t)
            for (const NodeLane& corner : model.tetrahedra.node[t]) expect_nodes("tetrahedra/node", corner, nodes, t);
        for (Index k = rows.begin; k < rows.end; ++k)
            expect_nodes("element_nodes/node", model.element_nodes.node[k], nodes, k);
        Index first = rows.begin;
        const Range of_body = model.bodies.blocks[b];
        for (Index e = of_body.begin; e < of_body.end; ++e) {
            expect_body("elements/body", elements.body[e], b, e);
            constexpr Index fewest_nodes = 4;
            if (elements.first[e] != first || elements.count[e] < fewest_nodes ||
                elements.count[e] > rows.end - elements.first[e])
                file.complain("elements/count", at_row(elements.count[e], e),
                              "at least 4 rows of element_nodes, which follow the rows of the previous block");
            first += elements.count[e];
            if (!elements.opens_patch[e] && e == of_body.begin)
                file.complain("elements/opens_patch", "0 at row " + std::to_string(e),
                              "1 in the first block of elements of a body");
        }
        if (first != rows.end)
            file.complain("elements/count",
                          std::to_string(first) + " as the end of the last block of body " + std::to_string(b),
                          std::to_string(rows.end) + ", the end of the rows of the body in element_nodes");
    }
    expect_rows_of(file, "elements/material", elements.material, model.materials.slot.size());
}

void check_scripts(const SavedFile& file, const std::string& table, const auto& rows) {
    for (std::size_t i = 0; i < rows.script.size(); ++i) {
        const MotionScript& script = rows.script[i];
        if (script.key_begin < 0 || script.key_end < script.key_begin ||
            script.key_end > static_cast<Index>(rows.keyframe.size()))
            file.complain(table + "/script/key_end",
                          std::to_string(script.key_begin) + " to " + std::to_string(script.key_end) + " at row " +
                              std::to_string(i),
                          "a range of the " + std::to_string(rows.keyframe.size()) + " rows of " + table + "/keyframe");
        for (Index k = script.key_begin + 1; k < script.key_end; ++k)
            if (!(rows.keyframe[k].time > rows.keyframe[k - 1].time))
                file.complain(table + "/keyframe",
                              "a time that is not after the previous time, at row " + std::to_string(k),
                              "ascending times");
    }
}

void check_moved(const SavedFile& file, const Model& model) {
    expect_rows_of(file, "colliders/body", model.colliders.body, model.bodies.slot.size(), true);
    for (std::size_t c = 0; c < model.colliders.slot.size(); ++c) {
        const Index body = model.colliders.body[c];
        if (body != no_index && model.bodies.collider[body] != static_cast<Index>(c))
            file.complain("colliders/body", at_row(body, c), "the body whose collider is this row");
    }
    check_scripts(file, "colliders", model.colliders);
    const AttachmentTable& attachments = model.attachments;
    check_scripts(file, "attachments", attachments);
    expect_rows_of(file, "attachments/body", attachments.body, model.bodies.slot.size());
    expect_partition(file, "attachments/nodes", attachments.nodes, attachments.node.size());
    for (std::size_t a = 0; a < attachments.slot.size(); ++a) {
        const Mat3& held = attachments.held[a];
        const Mat3 products = held.transpose() * held;  // diagonal if the columns are orthogonal or zero
        const Vec3 lengths = products.diagonal();
        const bool unit = ((lengths.array() - 1).abs() < 1e-9 || lengths.array() == 0).all() && lengths.maxCoeff() > 0;
        if (!unit || !(products - Mat3(lengths.asDiagonal())).isZero(1e-9))
            file.complain("attachments/held", "a wrong matrix for attachment " + std::to_string(a),
                          "columns that are zero or perpendicular unit vectors, at least one of them not zero");
        for (const Index n : part(attachments.node, attachments.nodes[a])) {
            const Range nodes = model.bodies.nodes[attachments.body[a]];
            if (n < nodes.begin || n >= nodes.end)
                file.complain("attachments/node", "node " + std::to_string(n) + " of attachment " + std::to_string(a),
                              "a node of the attached body, " + std::to_string(nodes.begin) + " to " +
                                  std::to_string(nodes.end - 1));
        }
    }
}

void check_disabled_pairs(const SavedFile& file, const Model& model) {
    const auto lives = [](const auto& map, std::uint64_t slot) {
        return map.has_slot(static_cast<std::uint32_t>(slot));
    };
    std::span<const std::uint64_t> keys = model.disabled_pairs.key;
    for (std::size_t i = 0; i < keys.size(); ++i) {
        const PairSlots slots = slots_of_pair(keys[i]);
        const bool named = lives(model.body_map, slots.first) &&
                           (slots.is_collider ? lives(model.collider_map, slots.second)
                                              : lives(model.body_map, slots.second) && slots.first < slots.second);
        if (!named || (i > 0 && !(keys[i - 1] < keys[i])))
            file.complain("disabled_pairs/key", at_row(std::to_string(keys[i]), i),
                          "ascending keys of pairs of existing objects: two bodies, or a body and a collider");
    }
}

/// Checks the progress of the stable-step checks, which are spread over many steps. Empty columns mean that no check
/// has started yet.
void check_watch(const SavedFile& file, const Model& model) {
    const StepWatch& watch = model.watch;
    const std::size_t rows = watch.step.size(), nodes = watch.position.size();
    if (rows != 0) expect_size(file, "watch/step", rows, model.bodies.slot.size());
    if (nodes != 0) expect_size(file, "watch/position", nodes, model.nodes.position.size());
    expect_size(file, "watch/stiffness_sum", watch.stiffness_sum.size(), nodes);
    const std::size_t looked_at = nodes > 0 ? rows : 0;
    expect_between(file, "watch/progress/kept", std::array{watch.kept}, 0, static_cast<Index>(looked_at));
    expect_between(file, "watch/progress/body", std::array{watch.body}, 0, watch.kept);
}

/// Checks the clusters, and computes the columns that follow from the node lists of the clusters.
void check_clusters(const SavedFile& file, Model& model) {
    NodeClusters& clusters = model.clusters;
    const std::size_t count = clusters.body.size();
    expect_size(file, "clusters/nodes/offset", clusters.nodes.offset.size(), count > 0 ? count + 1 : 0);
    expect_rows_of(file, "clusters/body", clusters.body, model.bodies.slot.size());
    if (count == 0) return;
    expect_all_offsets(file, "clusters/nodes/offset", clusters.nodes.offset, clusters.nodes.item.size());
    clusters.cluster_of.assign(model.nodes.position.size(), no_index);
    clusters.index_in_cluster.assign(model.nodes.position.size(), no_index);
    std::size_t entries = 0;
    for (std::size_t c = 0; c < count; ++c) {
        const Range nodes = model.bodies.nodes[clusters.body[c]];
        const std::span<const Index> of_cluster = clusters.nodes[c];
        clusters.first_entry.push_back(entries);
        entries += of_cluster.size() * of_cluster.size();
        for (std::size_t i = 0; i < of_cluster.size(); ++i) {
            const Index n = of_cluster[i];
            if (n < nodes.begin || n >= nodes.end || (i > 0 && n <= of_cluster[i - 1]) ||
                clusters.cluster_of[n] != no_index)
                file.complain("clusters/nodes/item", "node " + std::to_string(n) + " of cluster " + std::to_string(c),
                              "ascending nodes of the cluster's body, each in only one cluster");
            clusters.cluster_of[n] = static_cast<Index>(c);
            clusters.index_in_cluster[n] = static_cast<Index>(i);
        }
        if (of_cluster.empty())
            file.complain("clusters/nodes/offset", "no nodes in cluster " + std::to_string(c), "at least one node");
    }
    expect_size(file, "clusters/inverse", clusters.inverse.size(), entries);
}

void check_rigid_bodies(const SavedFile& file, const RigidBodyTable& table) {
    const auto require = [&](bool good, const char* column, std::size_t r, const char* found, const char* expected) {
        if (!good)
            file.complain(std::string("rigid_bodies/") + column, found + (" at row " + std::to_string(r)), expected);
    };
    for (std::size_t r = 0; r < table.size(); ++r) {
        require(table.mass[r] > 0 && std::isfinite(table.mass[r]), "mass", r, "a mass that is not positive and finite",
                "a mass > 0 (kg)");
        require(table.moments[r].allFinite() && table.moments[r].minCoeff() > 0, "moments", r,
                "a moment of inertia that is not positive and finite", "three moments of inertia > 0 (kg m^2)");
        require(is_rotation(table.axes[r]), "axes", r, "a matrix that is not a rotation", "a rotation matrix");
        require(is_rotation(table.rotation[r]), "rotation", r, "a matrix that is not a rotation", "a rotation matrix");
        require(table.rest_center[r].allFinite() && table.center[r].allFinite(), "center", r,
                "a position that is not finite", "finite numbers");
        require(table.momentum[r].allFinite() && table.angular_momentum[r].allFinite(), "momentum", r,
                "a value that is not finite", "finite numbers");
        require(table.large[r] <= 1, "large", r, "a value above 1", "0 or 1");
    }
}

void check_implicit_nodes(const SavedFile& file, const ImplicitNodeTable& table) {
    for (std::size_t row = 0; row < table.size(); ++row) {
        const std::string found = "a value that is not finite at row " + std::to_string(row);
        if (!table.displacement[row].allFinite())
            file.complain("implicit_nodes/displacement", found, "finite numbers (m)");
        if (!table.velocity[row].allFinite()) file.complain("implicit_nodes/velocity", found, "finite numbers (m/s)");
        if (!table.left[row].allFinite()) file.complain("implicit_nodes/left", found, "finite numbers (m)");
    }
}

}  // namespace

void check_masses(const SavedFile& file, const Model& model) {
    for (std::size_t b = 0; b < model.bodies.slot.size(); ++b) {
        const BodyRecord& record = model.body_records[b];
        const std::string row = " at row " + std::to_string(b);
        if (record.given_mass != GivenMass::none && !model.is_rigid(b))
            file.complain("records/given_mass", "a given mass" + row, "0 for a body that is not rigid");
        if (!model.shares_mass(b))
            expect_between(file, "nodes/mass", rows_of(model.nodes.mass, model.bodies.nodes[b]), 0.0, infinity);
        else if (record.tetrahedra.empty()) {
            const std::span<const Vec3> nodes = rows_of(model.nodes.rest_position, model.bodies.nodes[b]);
            try {
                mesh::require_shells({{nodes.begin(), nodes.end()}, record.surface}, record.name,
                                     record.given_mass == GivenMass::all);
            } catch (const SceneError& error) {
                file.complain("meshes/surface", error.what() + row, "a valid surface");
            }
        }
    }
}

void check_model(const SavedFile& file, Model& model) {
    check_sizes(file, model);
    expect_between(file, "nodes/mass", model.nodes.mass, -infinity, infinity);
    expect_between(file, "nodes/inverse_mass", model.nodes.inverse_mass, 0.0, infinity);
    check_bodies(file, model);
    check_rows_of_bodies(file, model);
    check_moved(file, model);
    check_handles(file, model);
    check_disabled_pairs(file, model);
    check_clusters(file, model);
    check_rigid_bodies(file, model.rigid_bodies);
    check_joining_tables(file, model);
    check_implicit_nodes(file, model.implicit_nodes);
    check_watch(file, model);
}

}  // namespace skerry
