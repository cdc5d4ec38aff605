// Conversion of a body between explicit, implicit and rigid dynamics.
#include <Eigen/Dense>
#include <algorithm>
#include <numeric>
#include <string>
#include <vector>

#include "engine/mesh/tetrahedron.h"
#include "engine/world/control/control.h"
#include "engine/world/edit/edit_model.h"
#include "engine/world/edit/erase_gone.h"
#include "engine/world/edit/joining_rows.h"
#include "engine/world/edit/rigid_bodies.h"
#include "engine/world/kernels.h"
#include "engine/world/step/step.h"
#include "engine/world/validate.h"

namespace skerry {

namespace {

[[noreturn]] void refuse_change(const Model& model, std::size_t body, const char* field, const std::string& found,
                                const std::string& expected, const std::string& hint = {}) {
    refuse("body '" + model.body_records[body].name + "'", field, found, expected, hint);
}

/// Joins names to a text such as "joints, ties and cables".
std::string sequence_of(const std::vector<const char*>& names) {
    std::string text;
    for (std::size_t i = 0; i < names.size(); ++i)
        text += (i == 0 ? "" : i + 1 == names.size() ? " and " : ", ") + std::string(names[i]);
    return text;
}

void require_changeable(Model& model, std::size_t body, BodyDynamics next) {
    const auto row = static_cast<Index>(body);
    if (next == BodyDynamics::automatic)
        refuse_change(model, body, "dynamics", "automatic",
                      "explicit, implicit or rigid (automatic is possible only when a body is added)");
    if (next != BodyDynamics::explicit_elastic && model.bodies.self_contact[body])
        refuse_change(model, body, "self_contact", "true",
                      "false, as required by the dynamics " + std::string(name_of(next)));
    if (model.bodies.core_nodes[body] > 0)
        refuse_change(model, body, "dynamics", std::string(name_of(next)),
                      "rigid, because a " + std::string(model.round_name(body)) + " does not deform");
    if (model.shares_mass(body))
        refuse_change(model, body, "dynamics", std::string(name_of(next)),
                      std::string("rigid, because ") + (model.body_records[body].tetrahedra.empty()
                                                            ? "a body without tetrahedra cannot deform"
                                                            : "the mass of the body is given"));
    if (next == BodyDynamics::implicit_elastic)
        require_implicit_materials(model, model.bodies.material[body], model.body_records[body].tetrahedron_material,
                                   model.body_records[body].name);
    if (has_flowed(model, body))
        refuse_change(model, body, "dynamics", "a change of dynamics for a body that has deformed plastically",
                      "a body without plastic strain, because other dynamics have none",
                      "call reset() first, or add another body with the deformed mesh");
    const auto is_of_body = [row](Index of) { return of == row; };
    if (std::ranges::any_of(model.attachments.body, is_of_body))
        refuse_change(model, body, "dynamics", "a change of dynamics for an attached body",
                      "a body without attachments",
                      "remove the attachments, change the dynamics, then attach the body again");
    if (const std::vector<const char*> found = tables_joining(row, model); !found.empty())
        refuse_change(model, body, "dynamics", "a change of dynamics for a body with " + sequence_of(found),
                      "a body without " + sequence_of(tables_joining(no_index, model)),
                      "remove the " + sequence_of(found) + ", change the dynamics, then add them again");
}

/// Centre of mass, momentum and angular momentum of a body.
struct BodyMotion {
    Vec3 center;                      // centre of mass [m]
    Vec3 momentum, angular_momentum;  // angular momentum is about `center` [kg m/s, kg m^2/s]
};

Real mass_of_nodes(const Model& model, std::size_t body) {
    const std::span<const Real> mass = rows_of(model.nodes.mass, model.bodies.nodes[body]);
    return std::accumulate(mass.begin(), mass.end(), Real(0));
}

Vec3 center_of_nodes(const Model& model, std::size_t body) {
    Vec3 center = Vec3::Zero();
    const Range range = model.bodies.nodes[body];
    for (Index n = range.begin; n < range.end; ++n) center += model.nodes.mass[n] * model.nodes.position[n];
    return center / mass_of_nodes(model, body);
}

BodyMotion motion_of(const Model& model, std::size_t body) {
    if (model.has_frame(body)) {
        const auto r = static_cast<std::size_t>(model.bodies.rigid[body].begin);
        const RigidBodyTable& table = model.rigid_bodies;
        return {table.center[r], table.momentum[r], table.angular_momentum[r]};
    }
    const Vec3 center = center_of_nodes(model, body);
    const NodeMotion nodes = motion_of_nodes(model, body, center);
    return {center, nodes.momentum, nodes.angular_momentum};
}

/// Adds a rigid motion to the node velocities of an explicit body, so that its momentum and its angular momentum about
/// `target.center` become those of `target`.
void give_nodes_momenta(Model& model, std::size_t body, const BodyMotion& target) {
    const Vec3 center = center_of_nodes(model, body);
    const NodeMotion present = motion_of_nodes(model, body, center);
    const Vec3 about_center = target.angular_momentum + (target.center - center).cross(target.momentum);
    const Vec3 velocity = (target.momentum - present.momentum) / mass_of_nodes(model, body);
    const Vec3 angular_velocity = present.inertia.inverse() * (about_center - present.angular_momentum);
    const Range range = model.bodies.nodes[body];
    for (Index n = range.begin; n < range.end; ++n)
        model.nodes.velocity[n] += velocity + angular_velocity.cross(model.nodes.position[n] - center);
}

/// Present node positions of a body in the mesh frame, whose pose is `pose` [m]. Empty if no node has moved relative to
/// `mesh_shape` by more than rounding errors.
std::vector<Vec3> deformed_shape_of(const Model& model, std::size_t body, const RigidPose& pose,
                                    std::span<const Vec3> mesh_shape) {
    std::vector<Vec3> shape;
    Real largest = 0;
    for (const Vec3& x : rows_of(model.nodes.position, model.bodies.nodes[body])) {
        shape.push_back(pose.rotation.transpose() * (x - pose.position));
        largest = std::max(largest, (shape.back() - mesh_shape[shape.size() - 1]).norm());
    }
    // Displacements up to this fraction of the mean edge length count as rounding errors of the fitted pose.
    constexpr Real rounding = 1e-12;
    if (!(largest > rounding * model.bodies.mean_edge[body])) shape.clear();
    return shape;
}

/// Throws SceneError if a tetrahedron of the shape is flat or inverted. A rigid body with such a shape would have a
/// wrong inertia.
void require_upright_shape(const Model& model, std::size_t body, std::span<const Vec3> shape) {
    const BodyRecord& record = model.body_records[body];
    const Mesh deformed{.nodes = {shape.begin(), shape.end()}, .tetrahedra = record.tetrahedra};
    const auto is_bad = [&](const std::array<Index, 4>& tetrahedron) {
        return mesh::orientation(deformed, tetrahedron) != mesh::Orientation::positive;
    };
    const auto count = std::ranges::count_if(record.tetrahedra, is_bad);
    if (count > 0)
        refuse_change(model, body, "dynamics",
                      "a shape in which " + std::to_string(count) + " of " + std::to_string(record.tetrahedra.size()) +
                          " tetrahedra are flat or inverted",
                      "a shape without such tetrahedra, because a rigid body is frozen in its present shape",
                      "advance until the body has recovered, or call reset() first");
}

/// Appends another row for a body, with the dynamics `next` and without velocity. A rigid row gets the present shape of
/// the body, other rows the shape of its mesh. If the new row has no valid stable step, it is removed again, and
/// SceneError is thrown.
std::size_t append_as(WorldState& world, std::size_t body, BodyDynamics next) {
    Model& model = world.model;
    const BodyTable& bodies = model.bodies;
    const BodyRecord record = model.body_records[body];
    const RigidPose pose = pose_of_body(model, body);
    const std::span<const Vec3> shape = model.mesh_shape(body);
    const std::vector<Vec3> mesh_shape(shape.begin(), shape.end());  // copy, as appending rows may move `shape`
    std::vector<Vec3> frozen;
    if (next == BodyDynamics::rigid) frozen = deformed_shape_of(model, body, pose, mesh_shape);
    if (!frozen.empty()) require_upright_shape(model, body, frozen);
    const Index row = append_body(model, world.scratch.stiffness_sum,
                                  {.slot = bodies.slot[body],
                                   .self_contact = bodies.self_contact[body] != 0,
                                   .dynamics = next,
                                   .filter = bodies.filter[body],
                                   .element = record.requested_element,
                                   .material = bodies.material[body],
                                   .tetrahedron_material = record.tetrahedron_material,
                                   .contact_distance = bodies.contact_distance[body],
                                   .nodes = frozen.empty() ? mesh_shape : frozen,
                                   .mesh_shape = frozen.empty() ? std::span<const Vec3>() : mesh_shape,
                                   .tetrahedra = record.tetrahedra,
                                   .triangles = {},
                                   .position = pose.position,
                                   .rotation = pose.rotation,
                                   .velocity = Vec3::Zero(),
                                   .angular_velocity = Vec3::Zero()});
    const auto after = static_cast<std::size_t>(row);
    model.body_records[after].name = record.name;
    model.body_records[after].start = record.start;
    model.body_records[after].label = record.label;
    model.body_records[after].sets = record.sets;
    model.body_records[after].visual = record.visual;
    try {
        validate_step(model, row, record.name);
    } catch (const SceneError&) {
        std::vector<std::uint8_t> removed(after + 1, 0);
        removed[after] = 1;
        erase_gone(row_moves(model, removed, {}), model);
        throw;
    }
    return after;
}

void copy_node_rows(Column<Vec3>& column, Range from, Range to) {
    std::ranges::copy(rows_of(column, from), rows_of(column, to).begin());
}

/// Gives the body `after` the surface properties, loads and momenta of the body `before`. Unless `after` is rigid, also
/// copies node positions and velocities.
void take_state(WorldState& world, std::size_t before, std::size_t after) {
    Model& model = world.model;
    const Range nodes_before = model.bodies.nodes[before], nodes_after = model.bodies.nodes[after];
    const BodyMotion motion = motion_of(model, before);
    model.bodies.surface[after] = model.bodies.surface[before];
    copy_node_rows(model.nodes.load, nodes_before, nodes_after);
    copy_node_rows(model.nodes.applied_before, nodes_before, nodes_after);
    model.note_loads(after, false);
    hand_over_rows(before, after, model);
    note_forces(model);
    model.body_records[after].settled = model.body_records[before].settled;
    if (model.is_rigid(after)) {
        set_momenta(model, after, motion.momentum, motion.angular_momentum);
        return;
    }
    copy_node_rows(model.nodes.position, nodes_before, nodes_after);
    copy_node_rows(model.nodes.displacement_origin, nodes_before, nodes_after);
    copy_node_rows(model.nodes.velocity, nodes_before, nodes_after);
    if (!model.has_frame(after)) {
        give_nodes_momenta(model, after, motion);
        relax_fully(model, after);
        model.bodies.stable_step[after] =
            evaluate_stable_step(model, after, model.nodes.position, world.scratch.stiffness_sum);
        return;
    }
    const std::span<const Vec3> position = rows_of(model.nodes.position, nodes_before),
                                velocity = rows_of(model.nodes.velocity, nodes_before);
    set_deformed_shape(model, after, position);
    std::ranges::copy(velocity, rows_of(model.nodes.velocity, nodes_after).begin());
    follow_node_velocities(model, after);
    set_momenta(model, after, motion.momentum, motion.angular_momentum);
}

}  // namespace

void relax_fully(Model& model, std::size_t body) {
    const Range blocks = model.bodies.blocks[body];
    const ElementInputs elements = model.all_elements();
    std::vector<Mat3> strain(static_cast<std::size_t>(blocks.size()) * element_lanes);
    kernels().element_strains(elements, blocks, model.nodes.position, strain);
    for (Index b = blocks.begin; b < blocks.end; ++b) {
        if (!elements.material_of(static_cast<std::size_t>(b)).relaxes()) continue;
        SpringStrain& spring_strain = model.elements.spring_strain[static_cast<std::size_t>(b)];
        spring_strain = {};
        for (std::size_t l = 0; l < element_lanes; ++l) {
            const Mat3& E = strain[static_cast<std::size_t>(b - blocks.begin) * element_lanes + l];
            const std::array<Real, 6> entry{E(0, 0), E(1, 1), E(2, 2), E(0, 1), E(1, 2), E(2, 0)};
            for (std::size_t i = 0; i < entry.size(); ++i) spring_strain[i][l] = static_cast<float>(2 * entry[i]);
        }
        model.elements.spring_strain_next[static_cast<std::size_t>(b)] = spring_strain;
    }
}

void World::set_dynamics(BodyHandle body, BodyDynamics dynamics) {
    state_->require_between_steps("set_dynamics");
    state_->settle();
    Model& model = state_->model;
    const auto before = static_cast<std::size_t>(model.row(body, "set_dynamics"));
    if (dynamics == model.dynamics_of(before)) return;
    require_changeable(model, before, dynamics);
    const std::size_t after = append_as(*state_, before, dynamics);
    take_state(*state_, before, after);
    OpenEdits& edits = state_->edits;
    edits.places.add_body(model, before);
    edits.places.add_body(model, after);
    model.body_map.rename(body, static_cast<Index>(after));
    edits.removed_bodies.resize(after + 1, 0);
    edits.removed_bodies[before] = 1;
    edits.rows = edits.elements = true;
    state_->settle();
}

}  // namespace skerry
