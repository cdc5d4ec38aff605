#include "engine/output/series/probe_columns.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "engine/base/complaint.h"
#include "engine/world/control/control.h"
#include "engine/world/world_state.h"
#include "skerry/cable.h"
#include "skerry/joint.h"
#include "skerry/tie.h"
#include "systems/dynamics/checks/volume_ratios.h"
#include "systems/dynamics/elements/element_energy.h"

namespace skerry {

namespace {

template <class... Cases>
struct Overloaded : Cases... {
    using Cases::operator()...;
};
template <class... Cases>
Overloaded(Cases...) -> Overloaded<Cases...>;  // clang 14 needs this deduction guide for an aggregate

void put_vector(const Vec3& v, std::vector<Real>& values) {
    values.insert(values.end(), {v.x(), v.y(), v.z()});
}

Vec3 at_point(std::span<const Vec3> values, const PointProbe& point) {
    Vec3 sum = Vec3::Zero();
    for (std::size_t a = 0; a < 4; ++a)
        if (point.weight[a] != 0) sum += point.weight[a] * values[static_cast<std::size_t>(point.node[a])];
    return sum;
}

struct Motion3 {
    Vec3 position, velocity;
};

Motion3 motion_of(const World& world, const PointProbe& point) {
    return {at_point(world.positions(point.body), point), at_point(world.velocities(point.body), point)};
}

Motion3 motion_of(const World& world, const BodyProbe& probe) {
    const Model& model = WorldAccess::state_of(world).model;
    const Range nodes = model.bodies.nodes[static_cast<std::size_t>(model.row(probe.body, "sample"))];
    Vec3 momentum = Vec3::Zero();
    for (auto n = static_cast<std::size_t>(nodes.begin); n < static_cast<std::size_t>(nodes.end); ++n)
        momentum += model.nodes.mass[n] * model.nodes.velocity[n];
    return {world.center_of_mass(probe.body), momentum / world.mass(probe.body)};
}

ForceReport force_of(const Forces& forces, const BodyForceProbe& probe) {
    if (!probe.by) return forces.on(probe.body);
    return std::visit([&](auto by) { return forces.on(probe.body, by); }, *probe.by);
}
ForceReport force_of(const Forces& forces, const ColliderForceProbe& probe) {
    return probe.by ? forces.on(probe.collider, *probe.by) : forces.on(probe.collider);
}
ForceReport force_of(const Forces& forces, const ReactionProbe& probe) {
    return forces.by(probe.attachment);
}

/// Largest von Mises stress, then largest and smallest principal stress, of the nodes of a probe [Pa].
std::array<Real, 3> extreme_stresses(const World& world, const StressProbe& probe) {
    Real largest = 0, tension = -infinity, pressure = infinity;
    for (const Mat3& of_node :
         probe.nodes.empty() ? world.node_stress(probe.body) : world.node_stress(probe.body, probe.nodes)) {
        const Vec3 principal = principal_stresses(of_node);
        largest = std::max(largest, von_mises(of_node));
        tension = std::max(tension, principal[0]);
        pressure = std::min(pressure, principal[2]);
    }
    return {largest, tension, pressure};
}

Real smallest_volume(const World& world, BodyHandle body) {
    const Model& model = WorldAccess::state_of(world).model;
    const Range blocks = model.bodies.tetrahedron_blocks[static_cast<std::size_t>(model.row(body, "sample"))];
    return tetrahedron_volume_ratios(model.tetrahedra.node, model.tetrahedra.volume, blocks, model.nodes.position)
        .smallest;
}

/// Calls function(). If it throws a SceneError, adds the name of the probe in front of the message.
auto called_for(const RecordedProbe& probe, auto&& function) {
    try {
        return function();
    } catch (const SceneError& error) {
        throw error_at({{}, "probe \"" + probe.name + "\"", {}, {}, {}, {}}, error);
    }
}

void require_name(const std::string& name) {
    const bool odd =
        std::ranges::any_of(name, [](char c) { return c == '/' || static_cast<unsigned char>(c) < ' ' || c == 127; });
    if (name.empty() || name == "." || name == "time" || odd)
        refuse({}, "name", "\"" + name + "\"",
               "a name other than \"time\" and \".\", without / and control characters (the name heads columns)");
}

void require_nodes(const World& world, BodyHandle body, std::span<const Index> nodes) {
    const auto count = static_cast<Index>(world.positions(body).size());
    for (const Index n : nodes)
        if (n < 0 || n >= count)
            refuse({}, "nodes", "node " + std::to_string(n),
                   "node indices of the body, 0 to " + std::to_string(count - 1));
}

void require_weights(const PointProbe& point) {
    Real sum = 0;
    for (const Real w : point.weight) sum += w;
    constexpr Real rounding = 1e-9;
    if (!(std::abs(sum - 1) < rounding))
        refuse({}, "weight", "weights whose sum is " + short_text(sum, 9), "weights that sum to one");
}

void put_force(ForceSum& force, bool of_contacts, std::vector<Real>& values) {
    // The mean force is known only if at least one call of advance since the last row was long enough to measure it.
    const bool is_measured = force.seconds > 0 && force.measured;
    const Real none = std::numeric_limits<Real>::quiet_NaN();
    const Real per = is_measured ? 1 / force.seconds : none;
    put_vector(is_measured ? force.impulse : Vec3::Constant(none), values);
    put_vector(per * force.impulse, values);
    put_vector(per * force.moment, values);
    values.push_back(is_measured ? force.largest : none);
    if (of_contacts) {
        values.push_back(per * force.pressing);
        put_vector(per * force.friction, values);
        values.push_back(force.contacts);
    }
    force = {};
}

JointState state_of(const World& world, const JointProbe& probe) {
    return joint_state(WorldAccess::state_of(world).model, probe.joint);
}

CableState state_of(const World& world, const CableProbe& probe) {
    return cable_state(WorldAccess::state_of(world), probe.cable);
}

void put_cable(const CableState& cable, std::vector<Real>& values) {
    values.insert(values.end(), cable.tension.begin(), cable.tension.end());
    values.insert(values.end(), {cable.length, cable.rate, cable.work, cable.dissipated});
}

bool has_coordinate(JointKind kind) {
    return kind == JointKind::hinge || kind == JointKind::slider;
}

void put_joint(const JointState& joint, std::vector<Real>& values) {
    put_vector(joint.force, values);
    put_vector(joint.moment, values);
    if (has_coordinate(joint.kind))
        values.insert(values.end(), {joint.coordinate, joint.speed, joint.motor, joint.passive, joint.limit});
}

void put_motion(const Motion3& motion, const Vec3& origin, std::vector<Real>& values) {
    put_vector(motion.position, values);
    put_vector(motion.position - origin, values);
    put_vector(motion.velocity, values);
}

void put_values(const World& world, TrackedProbe& probe, std::vector<Real>& values) {
    std::visit(
        Overloaded{
            [&](const PointProbe& point) { put_motion(motion_of(world, point), probe.origin, values); },
            [&](const BodyProbe& body) { put_motion(motion_of(world, body), probe.origin, values); },
            [&](const BodyForceProbe&) { put_force(probe.force, true, values); },
            [&](const ColliderForceProbe&) { put_force(probe.force, true, values); },
            [&](const ReactionProbe&) { put_force(probe.force, false, values); },
            [&](const JointProbe& joint) { put_joint(state_of(world, joint), values); },
            [&](const CableProbe& cable) { put_cable(state_of(world, cable), values); },
            [&](const TieProbe& tie) {
                const TieState now = tie_state(WorldAccess::state_of(world), tie.tie);
                put_vector(now.force, values);
                put_vector(now.moment, values);
                const auto broken =
                    std::ranges::count_if(now.nodes, [](const TiedNode& node) { return bool(node.broken); });
                values.insert(values.end(), {now.error, static_cast<Real>(broken)});
            },
            [&](const CavityProbe& cavity) {
                const CavityState now = cavity_state(WorldAccess::state_of(world), cavity.cavity);
                values.insert(values.end(), {now.pressure, now.volume, now.mass, now.energy});
                put_vector(now.force, values);
            },
            [&](const SpringProbe& spring) {
                const SpringState now = spring_state(WorldAccess::state_of(world), spring.spring);
                values.insert(values.end(), {now.length, now.rate, now.force, now.energy});
            },
            [&](const EnergyProbe&) {
                const Energy energy = world.energy();
                values.insert(values.end(), {energy.kinetic, energy.elastic, energy.potential, energy.dissipated});
            },
            [&](const StressProbe& stress) {
                const std::array<Real, 3> extreme = extreme_stresses(world, stress);
                values.insert(values.end(), extreme.begin(), extreme.end());
            },
            [&](const VolumeProbe& volume) { values.push_back(smallest_volume(world, volume.body)); },
            [&](const PoseProbe& pose) {
                const MotionKey now = std::visit([&](auto object) { return world.pose(object); }, pose.object);
                put_vector(now.position, values);
                put_vector(now.rotation, values);
            },
            [&](const VelocityProbe& velocity) {
                const Twist now = std::visit([&](auto object) { return world.velocity(object); }, velocity.object);
                put_vector(now.velocity, values);
                put_vector(now.angular_velocity, values);
            },
            [&](const NodesProbe& nodes) {
                for (const Vec3& position : world.positions(nodes.body)) put_vector(position, values);
            }},
        probe.probe.what);
}

}  // namespace

void ForceSum::add(const ForceReport& report) {
    impulse += report.impulse;
    moment += report.moment_impulse;
    friction += report.friction_impulse;
    pressing += report.pressing_impulse;
    if (report.measured) largest = std::max(largest, report.largest_force);
    measured = measured || report.measured;
    seconds += report.seconds;
    contacts = report.contacts;
}

namespace {

constexpr Overloaded measures_force{[](const BodyForceProbe&) { return true; },
                                    [](const ColliderForceProbe&) { return true; },
                                    [](const ReactionProbe&) { return true; }, [](const auto&) { return false; }};

/// Throws SceneError if the world lacks an object or a node of the probe.
void require_objects(const World& world, const RecordedProbe& probe) {
    const Model& model = WorldAccess::state_of(world).model;
    const auto require = [&](auto handle) { (void)model.row(handle, "Recorder"); };
    std::visit(Overloaded{[&](const PointProbe& point) {
                              require_nodes(world, point.body, point.node);
                              require_weights(point);
                          },
                          [&](const StressProbe& stress) { require_nodes(world, stress.body, stress.nodes); },
                          [&](const BodyForceProbe& force) {
                              require(force.body);
                              if (force.by) std::visit(require, *force.by);
                          },
                          [&](const ColliderForceProbe& force) {
                              require(force.collider);
                              if (force.by) require(*force.by);
                          },
                          [&](const ReactionProbe& force) { require(force.attachment); },
                          [&](const JointProbe& joint) { require(joint.joint); },
                          [&](const CableProbe& cable) { require(cable.cable); }, [](const EnergyProbe&) {},
                          [&](const TieProbe& tie) { require(tie.tie); },
                          [&](const CavityProbe& cavity) { require(cavity.cavity); },
                          [&](const SpringProbe& spring) { require(spring.spring); },
                          [&](const BodyProbe& body) { require(body.body); },
                          [&](const VolumeProbe& volume) { require(volume.body); },
                          [&](const NodesProbe& nodes) { require(nodes.body); },
                          [&](const auto& moving) { std::visit(require, moving.object); }},
               probe.what);
}

}  // namespace

void check_probes(const World& world, std::span<const RecordedProbe> probes) {
    std::set<std::string> names;
    for (const RecordedProbe& probe : probes)
        called_for(probe, [&] {
            require_name(probe.name);
            if (!names.insert(probe.name).second)
                refuse({}, "name", "a name that an earlier probe has", "a different name for every probe");
            require_objects(world, probe);
        });
}

std::vector<TrackedProbe> track(World& world, std::vector<RecordedProbe> probes) {
    const auto needs_forces = [](const RecordedProbe& probe) { return std::visit(measures_force, probe.what); };
    if (std::ranges::any_of(probes, needs_forces) && !world.measures_forces()) world.measure_forces(true);
    std::vector<TrackedProbe> tracked;
    for (RecordedProbe& probe : probes) {
        tracked.push_back({.probe = std::move(probe)});
        TrackedProbe& last = tracked.back();
        const auto set_origin = [&](const auto& moving) {
            last.origin = moving.origin.value_or(motion_of(world, moving).position);
        };
        std::visit(Overloaded{[&](const PointProbe& point) { set_origin(point); },
                              [&](const BodyProbe& body) { set_origin(body); }, [](const auto&) {}},
                   last.probe.what);
    }
    return tracked;
}

void add_columns(const World& world, const RecordedProbe& probe, std::vector<SeriesColumn>& columns) {
    const auto add_column = [&](const char* quantity, const char* unit) {
        columns.push_back({probe.name, quantity, unit});
    };
    const auto three = [&](const std::string& quantity, const char* unit) {
        for (const char* axis : {"_x", "_y", "_z"}) columns.push_back({probe.name, quantity + axis, unit});
    };
    const auto motion = [&] {
        three("position", "m");
        three("displacement", "m");
        three("velocity", "m/s");
    };
    const auto force = [&] {
        three("impulse", "N s");
        three("force", "N");
        three("moment", "N m");
        add_column("largest_force", "N");
    };
    const auto contact_force = [&] {
        force();
        add_column("pressing_force", "N");
        three("friction_force", "N");
        add_column("contacts", "1");
    };
    const auto of_joint = [&](JointKind kind) {
        three("force", "N");
        three("moment", "N m");
        if (!has_coordinate(kind)) return;
        const bool turns = kind == JointKind::hinge;
        add_column(turns ? "angle" : "displacement", turns ? "rad" : "m");
        add_column("speed", turns ? "rad/s" : "m/s");
        add_column(turns ? "motor_moment" : "motor_force", turns ? "N m" : "N");
        add_column(turns ? "passive_moment" : "passive_force", turns ? "N m" : "N");
        add_column(turns ? "limit_moment" : "limit_force", turns ? "N m" : "N");
    };
    const auto of_cable = [&](std::size_t segments) {
        for (std::size_t s = 0; s < segments; ++s) add_column(("tension_" + std::to_string(s)).c_str(), "N");
        add_column("length", "m");
        add_column("rate", "m/s");
        add_column("work", "J");
        add_column("dissipated", "J");
    };
    std::visit(
        Overloaded{[&](const PointProbe&) { motion(); }, [&](const BodyProbe&) { motion(); },
                   [&](const BodyForceProbe&) { contact_force(); }, [&](const ColliderForceProbe&) { contact_force(); },
                   [&](const ReactionProbe&) { force(); },
                   [&](const JointProbe& joint) { of_joint(state_of(world, joint).kind); },
                   [&](const CableProbe& cable) { of_cable(state_of(world, cable).tension.size()); },
                   [&](const TieProbe&) {
                       three("force", "N");
                       three("moment", "N m");
                       add_column("error", "m");
                       add_column("broken", "1");
                   },
                   [&](const CavityProbe&) {
                       add_column("pressure", "Pa");
                       add_column("volume", "m^3");
                       add_column("mass", "kg");
                       add_column("energy", "J");
                       three("force", "N");
                   },
                   [&](const SpringProbe&) {
                       add_column("length", "m");
                       add_column("rate", "m/s");
                       add_column("force", "N");
                       add_column("energy", "J");
                   },
                   [&](const EnergyProbe&) {
                       for (const char* part : {"kinetic", "elastic", "potential", "dissipated"}) add_column(part, "J");
                   },
                   [&](const StressProbe&) {
                       for (const char* axis_suffix : {"largest_von_mises", "largest_principal", "smallest_principal"})
                           add_column(axis_suffix, "Pa");
                   },
                   [&](const VolumeProbe&) { add_column("smallest_volume_ratio", "1"); },
                   [&](const PoseProbe&) {
                       three("position", "m");
                       three("rotation", "rad");
                   },
                   [&](const VelocityProbe&) {
                       three("velocity", "m/s");
                       three("angular_velocity", "rad/s");
                   },
                   [&](const NodesProbe& nodes) {
                       for (std::size_t n = 0; n < world.positions(nodes.body).size(); ++n)
                           for (const char* axis : {"position_x_", "position_y_", "position_z_"})
                               columns.push_back({probe.name, axis + std::to_string(n), "m"});
                   }},
        probe.what);
}

void add_forces(const World& world, TrackedProbe& probe) {
    const auto add = [&](const auto& force) {
        called_for(probe.probe, [&] { probe.force.add(force_of(world.forces(), force)); });
    };
    std::visit(Overloaded{[&](const BodyForceProbe& force) { add(force); },
                          [&](const ColliderForceProbe& force) { add(force); },
                          [&](const ReactionProbe& force) { add(force); }, [](const auto&) {}},
               probe.probe.what);
}

void put_row(const World& world, TrackedProbe& probe, std::vector<Real>& values) {
    called_for(probe.probe, [&] { put_values(world, probe, values); });
}

}  // namespace skerry
