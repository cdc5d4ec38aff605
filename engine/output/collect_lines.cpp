#include <cmath>

#include "engine/output/collect_frame.h"
#include "engine/world/control/control.h"
#include "engine/world/world_state.h"

namespace skerry {

namespace {

/// Radius of gyration of the first body of a joint [m].
Real gyration_radius(const Model& model, std::size_t joint) {
    const auto first = static_cast<std::size_t>(model.joints.first[joint]);
    const auto row = static_cast<std::size_t>(model.bodies.rigid[first].begin);
    return std::sqrt(model.rigid_bodies.moments[row].sum() / (2 * model.rigid_bodies.mass[row]));
}

void put_points(const JointState& joint, Real radius, LineFrame& line) {
    line.points = {joint.point};
    if (joint.kind == JointKind::hinge || joint.kind == JointKind::slider)
        line.points = {joint.point - radius * joint.axis, joint.point + radius * joint.axis};
    line.force.assign(line.points.size(), joint.force.norm());
}

void put_points(const World& world, const TieState& tie, LineFrame& line) {
    for (const TiedNode& node : tie.nodes) {
        if (node.broken) continue;
        line.points.push_back(world.positions(tie.body)[static_cast<std::size_t>(node.node)]);
        line.force.push_back(node.force.norm());
    }
}

void put_points(const CableState& cable, LineFrame& line) {
    for (const Anchor& point : cable.points) line.points.push_back(point.point);
    line.force = cable.tension;
    line.force.push_back(cable.tension.back());
}

void put_points(const SpringState& spring, LineFrame& line) {
    line.points = {spring.first.point, spring.second.point};
    line.force.assign(2, spring.force);
}

}  // namespace

std::vector<LineFrame> collect_lines(const World& world) {
    const WorldState& state = WorldAccess::state_of(world);
    const Model& model = state.model;
    std::vector<LineFrame> lines;
    const auto add = [&](LineKind kind, const auto& table, const auto& map, auto&& put) {
        for (std::size_t row = 0; row < table.size(); ++row) {
            const auto handle = map.handle_of_slot(table.slot[row]);
            lines.push_back({.kind = kind,
                             .slot = handle.slot,
                             .generation = handle.generation,
                             .name = std::string(name_of(kind)) + "_" + std::to_string(handle.slot)});
            put(handle, row, lines.back());
        }
    };
    add(LineKind::joint, model.joints, model.joint_map, [&](JointHandle joint, std::size_t row, LineFrame& line) {
        put_points(joint_state(model, joint), gyration_radius(model, row), line);
    });
    add(LineKind::tie, model.ties, model.tie_map,
        [&](TieHandle tie, std::size_t, LineFrame& line) { put_points(world, tie_state(state, tie), line); });
    add(LineKind::cable, model.cables, model.cable_map,
        [&](CableHandle cable, std::size_t, LineFrame& line) { put_points(cable_state(state, cable), line); });
    add(LineKind::spring, model.springs, model.spring_map,
        [&](SpringHandle spring, std::size_t, LineFrame& line) { put_points(spring_state(state, spring), line); });
    return lines;
}

}  // namespace skerry
