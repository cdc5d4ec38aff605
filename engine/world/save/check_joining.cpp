// Checks of the tables whose rows join bodies or act on them: joints, ties, cables, cavities, loads, springs and
// fibres.
#include <algorithm>
#include <array>
#include <functional>
#include <string>
#include <vector>

#include "engine/base/complaint.h"
#include "engine/world/save/checks.h"

namespace skerry {

namespace {

/// Checks that the rows of a table that joins bodies, such as the table of joints, name existing bodies and colliders.
void check_joined_objects(const SavedFile& file, const Model& model, const char* name, AnyTable table) {
    for (const ColumnInfo& info : table.columns()) {
        if (info.role != ColumnRole::body && info.role != ColumnRole::collider) continue;
        const AnyColumn column = table.column(info);
        const std::span<const Index> rows(reinterpret_cast<const Index*>(column.read()), column.size());
        const std::size_t count =
            info.role == ColumnRole::body ? model.bodies.slot.size() : model.colliders.slot.size();
        expect_rows_of(file, std::string(name) + "/" + info.name, rows, count, true);
    }
}

/// Checks the lists of keys of a table: times ascend, and the ranges cover the column of keys without gaps. `table` and
/// `range_name`: names for messages.
void check_keys(const SavedFile& file, const std::string& table, const std::string& range_name,
                std::span<const Range> range, std::span<const TimeKey> key) {
    const std::string place = table + "/" + range_name;
    std::vector<Range> ranges;
    for (std::size_t row = 0; row < range.size(); ++row) {
        const Range keys = range[row];
        if (!(keys.begin >= 0 && keys.begin <= keys.end && keys.end <= static_cast<Index>(key.size())))
            file.complain(place, at_row("a range that does not exist", row),
                          "a range of the rows of " + table + "/key");
        const std::span<const TimeKey> list = rows_of(key, keys);
        if (std::ranges::adjacent_find(list, std::greater_equal<>(), &TimeKey::time) != list.end())
            file.complain(table + "/key", at_row("keys whose times do not ascend", row), "ascending times");
        if (keys.size() > 0) ranges.push_back(keys);
    }
    std::ranges::sort(ranges, {}, &Range::begin);
    Index end = 0;
    for (const Range& keys : ranges) {
        if (keys.begin != end)
            file.complain(place, "a range of keys that begins at row " + std::to_string(keys.begin),
                          "row " + std::to_string(end) + ", where the last range ends");
        end = keys.end;
    }
    if (end != static_cast<Index>(key.size()))
        file.complain(table + "/key", std::to_string(key.size()) + " rows",
                      std::to_string(end) + ", as many as all ranges together");
}

void check_joints(const SavedFile& file, const Model& model) {
    const JointTable& table = model.joints;
    check_keys(file, "joints", "motor_keys", table.motor_keys.span(), table.key.span());
    expect_between(file, "joints/step", table.step, 0.0, infinity);
    for (std::size_t j = 0; j < table.size(); ++j) {
        const auto require = [&](bool good, const char* column, const char* found, const char* expected) {
            if (!good)
                file.complain(std::string("joints/") + column, found + (" at row " + std::to_string(j)), expected);
        };
        const auto is_rigid = [&](Index body) {
            return body == no_index || model.is_rigid(static_cast<std::size_t>(body));
        };
        require(table.first[j] != no_index && is_rigid(table.first[j]), "first", "-1 (the world) or a deformable body",
                "the index of a rigid body");
        require(is_rigid(table.second[j]) && table.second[j] != table.first[j], "second",
                "a deformable body or the first body of the joint",
                "the index of another rigid body, or -1 for the world");
        for (const JointFrame& frame : {table.first_frame[j], table.second_frame[j]})
            require(frame.point.allFinite() && is_rotation(frame.axes), "first_frame, second_frame",
                    "a frame that is not finite or not orthonormal", "a finite point and a rotation matrix");
        require(table.lower[j] <= table.upper[j], "lower", "a lower limit above the upper limit",
                "a lower limit <= the upper limit");
        require(table.motor[j].most >= 0 && table.motor[j].most_speed >= 0, "motor", "a negative strength or speed",
                "a strength and a speed >= 0");
        for (std::size_t at = j, passed = 0; table.leader[at] != no_index;
             at = static_cast<std::size_t>(table.leader[at]))
            require(table.leader[at] >= 0 && static_cast<std::size_t>(table.leader[at]) < table.size() &&
                        passed++ < table.size(),
                    "leader", "a row that does not exist, or a joint that mimics itself", "the row of another joint");
        require(table.leader[j] == no_index || table.mimic[j].ratio != 0, "mimic", "the ratio 0", "another ratio");
        const JointPassiveRow& passive = table.passive[j];
        require(passive.stiffness >= 0 && passive.damping >= 0 && passive.friction >= 0, "passive",
                "a negative stiffness, damping or friction", "numbers >= 0");
        require(table.motor_keys[j].size() == 0 || table.drive[j] != JointDrive::none, "motor_keys",
                "keys without a motor", "no keys");
        require(is_rotation(table.impulse_axes[j]), "impulse_axes", "a matrix that is not orthonormal",
                "a rotation matrix");
        require(table.impulse[j].allFinite() && table.moment[j].allFinite(), "impulse", "a value that is not finite",
                "finite numbers");
    }
}

void check_ties(const SavedFile& file, const Model& model) {
    const TieTable& table = model.ties;
    expect_partition(file, "ties/nodes", table.nodes, table.node.size());
    AnyTable all(const_cast<TieTable&>(table));
    for (const ColumnInfo& info : all.columns())
        if (!info.has_row_each)
            expect_size(file, std::string("ties/") + info.name, all.column(info).size(), table.node.size());
    expect_rows_of(file, "ties/collider", table.collider, model.colliders.slot.size(), true);
    expect_between(file, "ties/largest_force", table.largest_force, 0.0, infinity);
    expect_between(file, "ties/step", table.step, 0.0, infinity);
    for (std::size_t t = 0; t < table.size(); ++t) {
        const auto require = [&](bool good, const char* column, const char* found, const char* expected) {
            if (!good) file.complain(std::string("ties/") + column, at_row(found, t), expected);
        };
        const Index first = table.first[t], second = table.second[t];
        require(first != no_index && !model.is_rigid(static_cast<std::size_t>(first)), "first",
                "-1 (the world) or a rigid body", "the index of a deformable body");
        require(second != first && (second == no_index || table.collider[t] == no_index), "second",
                "the first body, or a body beside a collider", "the index of another body, or -1");
        require(table.break_force[t] > 0, "break_force", "a force that is not positive", "a force > 0 (N)");
        const bool deforms = second != no_index && !model.is_rigid(static_cast<std::size_t>(second));
        const auto is_node = [&](Index body, Index node) {
            return node >= 0 && node < model.bodies.nodes[static_cast<std::size_t>(body)].size();
        };
        for (Index row = table.nodes[t].begin; row < table.nodes[t].end; ++row) {
            const auto k = static_cast<std::size_t>(row);
            require(is_node(first, table.node[k]), "node", "a node that does not exist", "a node of the first body");
            for (const Index corner : table.corner[k])
                require(!deforms || is_node(second, corner), "corner", "a node that does not exist",
                        "a node of the second body");
        }
    }
}

/// Names of columns of anchors for messages.
struct AnchorNames {
    std::string collider, point;
};

/// Checks that anchors on bodies name existing nodes and no collider. Anchors without a body are not checked here.
void check_anchors(const SavedFile& file, const Model& model, const AnchorNames& names, const AnchorColumns& anchors) {
    for (std::size_t row = 0; row < anchors.body.size(); ++row) {
        const Index body = anchors.body[row];
        if (body == no_index) continue;
        if (anchors.collider[row] != no_index)
            file.complain(names.collider, at_row(anchors.collider[row], row), "-1, because the anchor is on a body");
        const Index count = model.bodies.nodes[static_cast<std::size_t>(body)].size();
        for (const Index node : anchors.point[row].node)
            if (node < 0 || node >= count)
                file.complain(names.point + "/node", at_row(node, row),
                              "the number of a node of the body, from 0 to " + std::to_string(count - 1));
    }
}

void check_cables(const SavedFile& file, const Model& model) {
    const CableTable& table = model.cables;
    check_keys(file, "cables", "keys", table.keys.span(), table.key.span());
    const std::size_t points = table.anchor.body.size();
    expect_size(file, "cables/collider", table.anchor.collider.size(), points);
    expect_size(file, "cables/anchor", table.anchor.point.size(), points);
    expect_size(file, "cables/tension", table.tension.size(), points);
    expect_size(file, "cables/length", table.length.size(), points);
    expect_between(file, "cables/step", table.step, 0.0, infinity);
    expect_between(file, "cables/friction", table.friction, 0.0, infinity);
    expect_between(file, "cables/released", table.released, 0.0, infinity);
    expect_between(file, "cables/tension", table.tension, 0.0, infinity);
    check_anchors(file, model, {"cables/collider", "cables/anchor"}, table.anchor);
    Index end = 0;
    for (std::size_t c = 0; c < table.size(); ++c) {
        const Range of = table.points[c];
        if (of.begin != end || of.size() < 2)
            file.complain("cables/points",
                          at_row(std::to_string(of.size()) + " points from row " + std::to_string(of.begin) + " on", c),
                          "at least two points from row " + std::to_string(end) + " on");
        if (table.keys[c].size() < 1) file.complain("cables/keys", at_row("no keys", c), "at least one key");
        for (const TimeKey& key : table.keys_of(c))
            if (table.control[c] == CableControl::tension && !(key.value >= 0))
                file.complain("cables/key", at_row("the tension " + short_text(key.value), c), "a tension >= 0 (N)");
        end = of.end;
    }
    if (static_cast<std::size_t>(end) != points)
        file.complain("cables/points", std::to_string(end) + " points", std::to_string(points));
}

void check_cavities(const SavedFile& file, const Model& model) {
    const CavityTable& table = model.cavities;
    check_keys(file, "cavities", "keys", table.keys.span(), table.key.span());
    expect_partition(file, "cavities/faces", table.faces, table.face.size());
    expect_size(file, "cavities/corners", table.corners.size(), table.face.size());
    expect_between(file, "cavities/mass", table.mass, 0.0, infinity);
    for (std::size_t c = 0; c < table.size(); ++c) {
        const auto require = [&](bool good, const char* column, const char* found, const char* expected) {
            if (!good) file.complain(std::string("cavities/") + column, at_row(found, c), expected);
        };
        require(table.body[c] != no_index, "body", "-1", "the index of a body");
        require(table.keys[c].size() > 0, "keys", "no keys", "at least one key");
        require(table.closed[c] <= 1, "closed", "a value above 1", "0 or 1");
        const CavityFluid& fluid = table.fluid[c];
        const bool gas = table.law[c] == CavityLaw::gas, liquid = table.law[c] == CavityLaw::liquid;
        require(!gas || (fluid.ambient > 0 && fluid.density > 0 && fluid.exponent >= 1), "fluid",
                "a constant of a gas that is too small", "an ambient pressure and a density > 0, an exponent >= 1");
        require(!liquid || (fluid.ambient >= 0 && fluid.bulk_modulus > 0), "fluid",
                "a constant of a liquid that is too small", "an ambient pressure >= 0 and a bulk modulus > 0");
        const Index nodes = model.bodies.nodes[table.body[c]].size();
        for (const std::array<Index, 3>& face : table.faces_of(c))
            for (const Index n : face)
                require(n >= 0 && n < nodes, "face", "a node that the body does not have", "a node of the body");
    }
    const PipeTable& pipes = model.pipes;
    check_keys(file, "pipes", "keys", pipes.keys.span(), pipes.key.span());
    expect_between(file, "pipes/conductance", pipes.conductance, 0.0, infinity);
    for (std::size_t p = 0; p < pipes.size(); ++p) {
        const auto body_of_end = [&](std::uint32_t slot) {
            const bool lives = model.cavity_map.has_slot(slot);
            const auto row =
                static_cast<std::size_t>(lives ? model.cavity_map.row(model.cavity_map.handle_of_slot(slot)) : 0);
            if (!lives || table.law[row] != CavityLaw::gas)
                file.complain("pipes/first, second", at_row(std::to_string(slot), p), "the slot of a cavity with gas");
            return table.body[row];
        };
        const auto require = [&](const char* column, Index found, Index expected, const char* reason) {
            if (found != expected)
                file.complain(std::string("pipes/") + column, at_row(std::to_string(found), p),
                              std::to_string(expected) + ", " + reason);
        };
        const Index first_body = body_of_end(pipes.first[p]), second_body = body_of_end(pipes.second[p]);
        require("first_body", pipes.first_body[p], first_body, "the body of the first cavity");
        if (pipes.keys[p].size() > 0) {
            require("second_body", pipes.second_body[p], no_index, "because the second end is a reservoir");
            require("second", static_cast<Index>(pipes.second[p]), static_cast<Index>(pipes.first[p]),
                    "as in pipes/first, because the second end is a reservoir");
        } else {
            require("second_body", pipes.second_body[p], second_body, "the body of the second cavity");
        }
    }
}

void check_loads(const SavedFile& file, const Model& model) {
    const LoadTable& table = model.loads;
    check_keys(file, "loads", "scale_keys", table.scale_keys.span(), table.key.span());
    if (table.node.size() != table.weight.size())
        file.complain("loads/weight", std::to_string(table.weight.size()) + " rows",
                      std::to_string(table.node.size()) + ", as in loads/node");
    expect_between(file, "loads/rate", table.rate, 0.0, infinity);
    expect_partition(file, "loads/faces", table.faces, table.face.size());
    Index listed = 0;
    for (std::size_t row = 0; row < table.size(); ++row) {
        const auto require = [&](bool good, const char* column, const char* found, const char* expected) {
            if (!good) file.complain(std::string("loads/") + column, at_row(found, row), expected);
        };
        require(table.scale_keys[row].size() > 0, "scale_keys", "no keys", "at least one key");
        const bool on_nodes = table.kind[row] == LoadKind::force || table.kind[row] == LoadKind::traction;
        const Range nodes = table.nodes[row];
        require(nodes.begin >= 0 && nodes.begin <= nodes.end && nodes.end <= static_cast<Index>(table.node.size()) &&
                    (nodes.size() > 0) == on_nodes,
                "nodes", "a range that does not exist or does not suit the kind of load",
                "a range of the rows of loads/node for a force or a traction, and an empty range for a field");
        listed += nodes.size();
        require(table.body[row] != no_index || !on_nodes, "body", "-1 (all bodies) for a force or a traction",
                "the index of a body");
        if (!on_nodes) continue;
        const Index count = model.bodies.nodes[static_cast<std::size_t>(table.body[row])].size();
        require(std::ranges::all_of(table.nodes_of(row), [&](Index n) { return n >= 0 && n < count; }), "node",
                "a node that the body does not have", "numbers of nodes of the body");
        require(table.area[row] == LoadArea::reference || nodes.size() % 3 == 0, "nodes",
                "a number of nodes that is no multiple of three", "three nodes for each face of the present area");
    }
    if (listed != static_cast<Index>(table.node.size()))
        file.complain("loads/node", std::to_string(table.node.size()) + " rows",
                      std::to_string(listed) + ", as many as all ranges together");
}

void check_springs(const SavedFile& file, const Model& model) {
    const SpringTable& table = model.springs;
    check_keys(file, "springs", "rest_length", table.rest_length.span(), table.key.span());
    check_anchors(file, model, {"springs/first_collider", "springs/first_point"}, table.first);
    check_anchors(file, model, {"springs/second_collider", "springs/second_point"}, table.second);
    expect_between(file, "springs/stiffness", table.stiffness, 0.0, infinity);
    expect_between(file, "springs/damping", table.damping, 0.0, infinity);
    expect_between(file, "springs/strength", table.strength, 0.0, infinity);
    for (std::size_t s = 0; s < table.size(); ++s)
        if (table.rest_length[s].size() == 0)
            file.complain("springs/rest_length", at_row("no keys", s), "at least one key");
}

void check_fibres(const SavedFile& file, const Model& model) {
    const FibreTable& table = model.fibres;
    check_keys(file, "fibres", "tension_keys", table.tension_keys.span(), table.key.span());
    expect_partition(file, "fibres/tetrahedra", table.tetrahedra, table.node.size());
    expect_size(file, "fibres/tetrahedron", table.tetrahedron.size(), table.node.size());
    expect_size(file, "fibres/slope", table.slope.size(), table.node.size());
    expect_size(file, "fibres/volume", table.volume.size(), table.node.size());
    expect_size(file, "fibres/passive", table.passive.size(), table.node.size());
    expect_between(file, "fibres/stiffness", table.stiffness, 0.0, infinity);
    expect_between(file, "fibres/exponent", table.exponent, 0.0, infinity);
    expect_between(file, "fibres/volume", table.volume, 0.0, infinity);
    for (std::size_t f = 0; f < table.size(); ++f) {
        if (table.tension_keys[f].size() == 0)
            file.complain("fibres/tension_keys", at_row("no keys", f), "at least one key");
        const auto body = static_cast<std::size_t>(table.body[f]);
        const Index nodes = model.bodies.nodes[body].size(), tetrahedra = model.bodies.tetrahedron_count[body];
        const auto has = [](Index n, Index count) { return n >= 0 && n < count; };
        for (auto t = static_cast<std::size_t>(table.tetrahedra[f].begin);
             t < static_cast<std::size_t>(table.tetrahedra[f].end); ++t)
            if (!has(table.tetrahedron[t], tetrahedra) ||
                !std::ranges::all_of(table.node[t], [&](Index n) { return has(n, nodes); }))
                file.complain("fibres/node", at_row("a node or tetrahedron that the body does not have", t),
                              "nodes and tetrahedra of the body");
    }
}

}  // namespace

void check_joining_tables(const SavedFile& file, Model& model) {
    model.for_each_joining(
        [&](const char* name, auto& table, auto&) { check_joined_objects(file, model, name, table); });
    check_joints(file, model);
    check_surface_rules(file, model);
    check_ties(file, model);
    check_cables(file, model);
    check_cavities(file, model);
    check_loads(file, model);
    check_springs(file, model);
    check_fibres(file, model);
}

}  // namespace skerry
