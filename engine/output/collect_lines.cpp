#include <cmath>

#include "engine/output/collect_frame.h"
#include "engine/world/control/control.h"
#include "engine/world/edit/objects.h"
#include "engine/world/world_state.h"

namespace skerry {

namespace {

/// Radius of gyration of the first body of a joint about its centre of mass; the drawn axis is twice as long [m]. The
/// principal moments of inertia add up to twice the integral of the squared distance from the centre of mass.
Real gyration_radius(const Model& model, JointHandle joint) {
    const auto first =
        static_cast<std::size_t>(model.joints.first[static_cast<std::size_t>(model.row(joint, "frame"))]);
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
    const auto add = [&]<class HandleType>(LineKind kind, HandleType, auto&& put_points_of) {
        for (const HandleType handle : handles_of<HandleType>(model)) {
            lines.push_back({.kind = kind,
                             .slot = handle.slot,
                             .generation = handle.generation,
                             .name = object_name(model, handle)});
            put_points_of(handle, lines.back());
        }
    };
    add(LineKind::joint, JointHandle{}, [&](JointHandle joint, LineFrame& line) {
        put_points(joint_state(model, joint), gyration_radius(model, joint), line);
    });
    add(LineKind::tie, TieHandle{},
        [&](TieHandle tie, LineFrame& line) { put_points(world, tie_state(state, tie), line); });
    add(LineKind::cable, CableHandle{},
        [&](CableHandle cable, LineFrame& line) { put_points(cable_state(state, cable), line); });
    add(LineKind::spring, SpringHandle{},
        [&](SpringHandle spring, LineFrame& line) { put_points(spring_state(state, spring), line); });
    return lines;
}

}  // namespace skerry
