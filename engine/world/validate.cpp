#include "engine/world/validate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "engine/mesh/labels.h"
#include "engine/mesh/require_positive.h"
#include "engine/mesh/sets.h"
#include "engine/mesh/surface/check_shells.h"
#include "systems/collision/build_surface.h"
#include "systems/dynamics/rigid/rigid_motion.h"
#include "systems/geometry/rotation.h"

namespace skerry {

namespace {

std::string titled(const char* kind, const std::string& name) {
    return name.empty() ? kind : kind + (" '" + name + "'");
}

struct ShapeCheck {
    const std::string& object;

    void operator()(const Plane& plane) const {
        require_finite(object, "point", plane.point);
        if (!plane.normal.allFinite() || plane.normal.norm() == 0)
            refuse(object, "normal", shown(plane.normal), "a vector that is not zero");
    }
    void operator()(const Sphere& sphere) const {
        require(sphere.radius > 0, object, "radius", sphere.radius, "a length > 0 (m)");
    }
    void operator()(const Box& box) const {
        if (!box.size.allFinite() || box.size.minCoeff() <= 0)
            refuse(object, "size", shown(box.size), "three lengths > 0 (m)");
    }
    void operator()(const Capsule& capsule) const {
        require(capsule.radius > 0, object, "radius", capsule.radius, "a length > 0 (m)");
        require(capsule.length >= 0, object, "length", capsule.length, "a length >= 0 (m)");
    }
    void operator()(const Cylinder& cylinder) const {
        require(cylinder.radius > 0, object, "radius", cylinder.radius, "a length > 0 (m)");
        require(cylinder.height > 0, object, "height", cylinder.height, "a length > 0 (m)");
    }
    void operator()(const Bucket& bucket) const {
        require(bucket.radius > 0, object, "radius", bucket.radius, "a length > 0 (m)");
        require(bucket.height > 0, object, "height", bucket.height, "a length > 0 (m)");
        require(bucket.thickness > 0, object, "thickness", bucket.thickness, "a length > 0 (m)");
    }
    void operator()(const SurfaceMesh& surface) const {
        if (surface.triangles.empty()) refuse(object, "triangles", "no triangles", "at least one triangle");
        for (const Vec3& node : surface.nodes) require_finite(object, "nodes", node);
        for (std::size_t t = 0; t < surface.triangles.size(); ++t) check(t, surface.triangles[t], surface.nodes.size());
    }

private:
    void check(std::size_t number, const std::array<Index, 3>& triangle, std::size_t nodes) const {
        for (Index corner : triangle)
            if (corner < 0 || corner >= static_cast<Index>(nodes))
                refuse(object, "triangles", "node " + std::to_string(corner),
                       "the index of a node of the mesh, 0 to " + std::to_string(static_cast<Index>(nodes) - 1));
        // A triangle with two equal nodes is refused, because the engine uses such triangles for a special purpose
        // (Model::append_outline): they represent the core of a round body, which is its centre or axis.
        const auto [a, b, c] = triangle;
        if (a == b || b == c || c == a)
            refuse(object, "triangles",
                   "triangle " + std::to_string(number) + " of nodes " + std::to_string(a) + ", " + std::to_string(b) +
                       ", " + std::to_string(c),
                   "three different nodes");
    }
};

void require_labels(const Mesh& mesh, const std::map<int, MaterialHandle>& materials, const std::string& object) {
    if (!mesh.label.empty() && mesh.label.size() != mesh.tetrahedra.size())
        refuse(object, "mesh", std::to_string(mesh.label.size()) + " labels",
               std::to_string(mesh.tetrahedra.size()) + " labels, one for each tetrahedron, or none");
    const std::map<int, std::size_t> labels = mesh::count_labels(mesh);
    for (const auto& [label, material] : materials)
        if (!labels.contains(label))
            refuse(object, "materials", "label " + std::to_string(label), mesh::expected_label(mesh));
}

/// Checks the sets of a mesh. Sets with a material of their own must contain tetrahedra, and must not have common
/// tetrahedra. `materials`: materials of sets by the names of the sets.
void require_sets(const Mesh& mesh, const std::map<std::string, MaterialHandle>& materials, const std::string& object) {
    for (const auto& [name, set] : mesh.sets)
        mesh::require_set(object, name, set, mesh.nodes.size(), mesh.tetrahedra, mesh.triangles);
    std::vector<const std::string*> set_of(materials.empty() ? 0 : mesh.tetrahedra.size());
    for (const auto& [name, material] : materials) {
        const auto found = mesh.sets.find(name);
        if (found == mesh.sets.end())
            refuse(object, "materials_of_sets", '"' + name + '"', mesh::expected_set(mesh::names_of(mesh.sets)));
        const std::vector<Index> tetrahedra = mesh::tetrahedra_of(found->second, mesh.tetrahedra);
        if (tetrahedra.empty())
            refuse(object, "materials_of_sets", "the set \"" + name + "\", which contains no tetrahedron",
                   "a set with at least one tetrahedron");
        for (const Index t : tetrahedra) {
            const std::string*& other = set_of[static_cast<std::size_t>(t)];
            if (other != nullptr)
                refuse(object, "materials_of_sets",
                       "tetrahedron " + std::to_string(t) + " in both \"" + *other + "\" and \"" + name + '"',
                       "sets without common tetrahedra");
            other = &name;
        }
    }
}

/// Checks the values of friction and restitution of a body or collider.
void require_surface(const std::optional<Real>& friction, const std::optional<Real>& static_friction,
                     const std::optional<Real>& dynamic_friction, const std::optional<Real>& restitution,
                     const std::string& object) {
    if (friction) require(*friction >= 0, object, "friction", *friction, "a number >= 0");
    if (dynamic_friction)
        require(*dynamic_friction >= 0, object, "dynamic_friction", *dynamic_friction, "a number >= 0");
    if (static_friction)
        require(*static_friction >= dynamic_friction.value_or(friction.value_or(0)), object, "static_friction",
                *static_friction, "a number >= dynamic_friction");
    if (restitution)
        require(*restitution >= 0 && *restitution <= 1, object, "restitution", *restitution, "a number from 0 to 1");
}

}  // namespace

void require_table(const std::string& object, const std::string& field, const TimeTable& table) {
    if (table.keys.empty()) refuse(object, field, "no key", "at least one key");
    for (std::size_t k = 0; k < table.keys.size(); ++k) {
        const TimeKey& key = table.keys[k];
        const std::string key_name = field + "[" + std::to_string(k) + "]";
        if (!std::isfinite(key.value)) refuse(object, key_name + ".value", shown(key.value), "a finite number");
        if (!std::isfinite(key.time)) refuse(object, key_name + ".time", shown(key.time), "a finite number (s)");
        if (k > 0 && !(key.time > table.keys[k - 1].time))
            refuse(object, key_name + ".time", short_text(key.time, 9) + " s",
                   "a time after that of the key before, " + short_text(table.keys[k - 1].time, 9) + " s");
    }
}

void require_nodes(const std::string& object, std::span<const Index> nodes, Index count) {
    for (const Index node : nodes)
        if (node < 0 || node >= count)
            refuse(object, "nodes", "node " + std::to_string(node),
                   "node indices of the body, 0 to " + std::to_string(count - 1));
}

void require_different_nodes(const std::string& object, std::span<const Index> nodes, Index count) {
    require_nodes(object, nodes, count);
    std::vector<Index> sorted(nodes.begin(), nodes.end());
    std::ranges::sort(sorted);
    if (const auto twice = std::ranges::adjacent_find(sorted); twice != sorted.end())
        refuse(object, "nodes", "node " + std::to_string(*twice) + " twice", "each node at most once");
}

void validate(const Settings& settings) {
    require_finite("settings", "gravity", settings.gravity);
    if (settings.step_size)
        require(*settings.step_size > 0, "settings", "step_size", *settings.step_size, "a time > 0 (s)");
    require(settings.threads >= 0, "settings", "threads", settings.threads,
            "a number of threads >= 0 (0: as many as the caller's task arena has)");
    require(settings.tolerance > 0 && settings.tolerance < 1, "settings", "tolerance", settings.tolerance,
            "a number > 0 and < 1");
    require(settings.max_iterations >= 1, "settings", "max_iterations", settings.max_iterations, "an integer >= 1");
    require(settings.recovery_speed > 0, "settings", "recovery_speed", settings.recovery_speed, "a speed > 0 (m/s)");
    require(settings.sleep_time >= 0, "settings", "sleep_time", settings.sleep_time, "a time >= 0 (s)");
    require(settings.theta >= 0.5 && settings.theta <= 1, "settings", "theta", settings.theta,
            "a number from 0.5 to 1");
    require(settings.theta == 1 || settings.integrator == Integrator::symplectic_euler, "settings", "theta",
            settings.theta, "1 with this integrator (smaller values require symplectic_euler)");
    require(settings.implicit_step >= 0 && std::isfinite(settings.implicit_step), "settings", "implicit_step",
            settings.implicit_step, "a time >= 0 (s)");
    require(settings.implicit_step == 0 || settings.integrator == Integrator::symplectic_euler, "settings",
            "implicit_step", settings.implicit_step, "0 with this integrator (other values require symplectic_euler)");
}

void validate(const Tuning& tuning) {
    require(tuning.step_safety > 0 && tuning.step_safety <= 1, "tuning", "step_safety", tuning.step_safety,
            "a fraction > 0 and <= 1");
    require(tuning.max_strain_step > 0, "tuning", "max_strain_step", tuning.max_strain_step, "a fraction > 0");
    require(tuning.restitution_speed >= 0, "tuning", "restitution_speed", tuning.restitution_speed,
            "a speed >= 0 (m/s)");
    require(tuning.sleep_speed >= 0, "tuning", "sleep_speed", tuning.sleep_speed, "a speed >= 0 (m/s)");
    require(tuning.relaxation > 0 && tuning.relaxation < 2, "tuning", "relaxation", tuning.relaxation,
            "a number > 0 and < 2");
}

namespace {

/// Checks that each side of a face has at most one tetrahedron. Two tetrahedra on one side overlap, and the surface of
/// the mesh is then not defined.
void require_apart(const Mesh& mesh, const std::string& object) {
    const std::vector<TetrahedronFace> faces = sorted_faces(mesh.tetrahedra);
    std::string found;  // for the message: the first two tetrahedra found on the same side of one face
    std::size_t count = 0;
    for (std::size_t first = 0; first < faces.size();) {
        std::array<Index, 2> seen{no_index, no_index};  // the tetrahedron on each side of the face, or no_index
        std::size_t i = first;
        for (; i < faces.size() && faces[i].node == faces[first].node; ++i) {
            Index& on_side = seen[faces[i].turned ? 1 : 0];
            if (on_side != no_index && count++ == 0)
                found = "tetrahedra " + std::to_string(on_side) + " and " + std::to_string(faces[i].tetrahedron) +
                        " on the same side of a shared face";
            on_side = faces[i].tetrahedron;
        }
        first = i;
    }
    if (count > 1) found += " (" + std::to_string(count) + " such pairs)";
    if (count > 0) refuse(object, "mesh", found, "at most one tetrahedron on each side of a face");
}

/// Checks the pose, the initial motion and the contact distance of a body.
void require_start(const BodySettings& body, const std::string& object) {
    require_finite(object, "position", body.position);
    require_finite(object, "rotation", body.rotation);
    require_finite(object, "velocity", body.velocity);
    require_finite(object, "angular_velocity", body.angular_velocity);
    if (body.contact_distance)
        require(*body.contact_distance >= 0, object, "contact_distance", *body.contact_distance, "a length >= 0 (m)");
}

/// Checks that the mesh is valid for a body. `may_cross`: true if the shells (closed parts) of a surface may cross each
/// other. This is allowed only if the user gives the inertia, so that it is not computed from the volume in the shells.
void require_mesh(const Mesh& mesh, bool may_cross, const std::string& object) {
    if (mesh.tetrahedra.empty() && mesh.triangles.empty())
        refuse(object, "mesh", "no tetrahedra", "at least one tetrahedron, or the triangles of a surface");
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
        if (!mesh.nodes[n].allFinite())
            refuse(object, "mesh", "node " + std::to_string(n) + " at " + shown(mesh.nodes[n]),
                   "finite coordinates (m)");
    for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e)
        for (Index corner : mesh.tetrahedra[e])
            if (corner < 0 || corner >= static_cast<Index>(mesh.nodes.size()))
                refuse(object, "mesh", "tetrahedron " + std::to_string(e) + " with node " + std::to_string(corner),
                       "node indices from 0 to " + std::to_string(static_cast<Index>(mesh.nodes.size()) - 1));
    if (!mesh.tetrahedra.empty()) {
        mesh::require_positive(mesh, object);
        require_apart(mesh, object);
    }
    if (mesh.triangles.empty()) return;
    if (!mesh.tetrahedra.empty()) refuse(object, "mesh", "both tetrahedra and triangles", "one of the two");
    const SurfaceMesh surface{mesh.nodes, mesh.triangles};
    ShapeCheck{object}(surface);
    mesh::require_shells(surface, object, may_cross);
}

/// Checks the mass, centre of mass and inertia that a user gives for a body. Only a rigid body may have them.
void require_mass(const BodySettings& body, bool rigid, const std::string& object) {
    if (!body.mass && !body.center_of_mass && !body.inertia) return;
    const char* const given = body.mass ? "mass" : body.inertia ? "inertia" : "center_of_mass";
    if (!rigid)
        refuse(object, given, "a value for a body with the dynamics " + std::string(name_of(body.dynamics)),
               "the dynamics rigid; other bodies have the mass of their materials");
    if (body.center_of_mass.has_value() != body.inertia.has_value())
        refuse(object, body.inertia ? "inertia" : "center_of_mass", "a value without the other of the two",
               "both center_of_mass and inertia, or neither");
    if (!body.mass) refuse(object, given, "a value without mass", "also the mass");
    require(*body.mass > 0, object, "mass", *body.mass, "a mass > 0 (kg)");
    if (!body.inertia) return;
    require_finite(object, "center_of_mass", *body.center_of_mass);
    const Mat3& inertia = *body.inertia;
    const Real largest = inertia.cwiseAbs().maxCoeff();
    constexpr Real digits = 1e-6;  // relative error of numbers that were written with six digits
    if (!inertia.allFinite() || !((inertia - inertia.transpose()).cwiseAbs().maxCoeff() <= digits * largest))
        refuse(object, "inertia", "a matrix that is not finite and symmetric", "a symmetric matrix (kg m^2)");
    const Vec3 moments = PrincipalInertia(inertia).moments;  // ascending
    if (!(moments[0] > 0) || !(moments[2] <= (moments[0] + moments[1]) * (1 + digits)))
        refuse(object, "inertia", "principal moments " + shown(moments) + " kg m^2",
               "moments > 0, none larger than the sum of the other two");
}

}  // namespace

void validate(const Mesh& mesh, const BodySettings& body, bool mesh_is_known) {
    const std::string object = titled("body", body.name);
    if (!mesh_is_known) require_mesh(mesh, body.inertia.has_value(), object);
    const bool rigid = body.dynamics == BodyDynamics::rigid;
    if (!mesh.triangles.empty() && !rigid)
        refuse(object, "dynamics", std::string(name_of(body.dynamics)),
               "rigid, because a body that deforms needs a mesh of tetrahedra instead of a surface");
    require_mass(body, rigid, object);
    if ((body.dynamics == BodyDynamics::rigid || body.dynamics == BodyDynamics::implicit_elastic) && body.self_contact)
        refuse(object, "self_contact", "true for a body with the dynamics " + std::string(name_of(body.dynamics)),
               "false");
    require_labels(mesh, body.materials, object);
    require_sets(mesh, body.materials_of_sets, object);
    require_start(body, object);
}

namespace {

/// Checks the settings of a sphere, capsule or cylinder. `shape`: name of the shape for messages.
void require_round(const std::string& shape, const BodySettings& body, const std::string& object) {
    if (body.dynamics != BodyDynamics::rigid && body.dynamics != BodyDynamics::automatic)
        refuse(object, "dynamics", std::string(name_of(body.dynamics)),
               "rigid, because a " + shape + " does not deform");
    require_mass(body, true, object);
    if (body.self_contact) refuse(object, "self_contact", "true for a " + shape, "false");
    if (!body.materials.empty() || !body.materials_of_sets.empty())
        refuse(object, "materials", "materials by label or set", "none, because a " + shape + " has one material");
    require_start(body, object);
}

}  // namespace

void validate(const Sphere& sphere, const BodySettings& body) {
    const std::string object = titled("body", body.name);
    ShapeCheck{object}(sphere);
    require_round("sphere", body, object);
}

void validate(const Capsule& capsule, const BodySettings& body) {
    const std::string object = titled("body", body.name);
    ShapeCheck{object}(capsule);
    require(capsule.length > 0, object, "length", capsule.length, "a length > 0 (m); for length 0 use a sphere");
    require_round("capsule", body, object);
}

void validate(const Cylinder& cylinder, const BodySettings& body) {
    const std::string object = titled("body", body.name);
    ShapeCheck{object}(cylinder);
    require_round("cylinder", body, object);
}

void validate(const Motion& motion, const std::string& object) {
    require_finite(object, "motion.velocity", motion.velocity);
    require_finite(object, "motion.angular_velocity", motion.angular_velocity);
    if (!motion.keys.empty() && (!motion.velocity.isZero(0) || !motion.angular_velocity.isZero(0)))
        refuse(object, "motion", "both keys and a velocity", "either keys or a velocity");
    for (std::size_t k = 0; k < motion.keys.size(); ++k) {
        const MotionKey& key = motion.keys[k];
        require_finite(object, "motion.keys.position", key.position);
        require_finite(object, "motion.keys.rotation", key.rotation);
        // upper limit of a rotation [rad]; the rounding error of the angle is then about 1e-10 rad
        constexpr Real most = 1e6;
        require(key.rotation.norm() <= most, object, "motion.keys.rotation", key.rotation.norm(),
                "a rotation of at most 1000000 rad");
        require(k == 0 || key.time > motion.keys[k - 1].time, object, "motion.keys.time", key.time,
                "a time after the time of the previous key (s)");
    }
}

void validate_step(const Model& model, Index body, const std::string& name) {
    const auto b = static_cast<std::size_t>(body);
    const Real step = model.bodies.rest_step[b];
    if (step > 0 && (std::isfinite(step) || model.has_frame(b))) return;
    const auto material = static_cast<std::size_t>(model.bodies.material[b]);
    refuse(titled("body", name), "mesh, material",
           "a mean edge length of " + shown(model.bodies.mean_edge[b]) + " m, a Young's modulus of " +
               shown(model.materials.young_modulus[material]) + " Pa and a density of " +
               shown(model.materials.constants[material].density) + " kg/m^3",
           "values with a finite stable step > 0; these give " + shown(step) + " s");
}

void validate(const Motion& motion, const Vec3& pivot) {
    validate(motion, "attachment");
    require_finite("attachment", "pivot", pivot);
    if (!motion.keys.empty() && !pivot.isZero(0))
        refuse("attachment", "pivot", "a pivot and keys", "a pivot only for an angular velocity",
               "keys rotate the nodes about the position of the keys: give each key the position of the "
               "centre of rotation");
}

namespace {

/// Checks that the first key of a plane's motion agrees with the point and the normal of the plane, unless these have
/// their default values. Keys are poses of the plane, not displacements from the point. If the user confuses them, the
/// plane would be in the wrong place.
void require_keys_of_plane(const Plane& plane, const ColliderSettings& collider, const std::string& object) {
    if (collider.motion.keys.empty()) return;
    constexpr Real same =
        1e-6;  // relative difference of two positions, or of two unit vectors, that are meant as equal
    const Mat3 turn = rotation_matrix(collider.rotation);
    const MotionKey& first = collider.motion.keys.front();
    const auto refuse_key = [&](const char* field, const std::string& found, const std::string& expected) {
        refuse(object, field, found, expected,
               "keys are poses of the plane itself, as for move_to: position is a point of the plane, and "
               "rotation turns +z to its normal; correct all keys, or leave out point and normal");
    };
    const Vec3 normal = turn * plane.normal.normalized(), of_keys = rotation_matrix(first.rotation).col(2);
    if (collider.motion.turns() && plane.normal.normalized() != Vec3::UnitZ() && (of_keys - normal).norm() > same)
        refuse_key("motion.keys[0].rotation", shown(first.rotation) + " rad, which gives the normal " + shown(of_keys),
                   "a rotation that gives the normal of the plane, " + shown(normal));
    const Vec3 point = collider.position + turn * plane.point;
    if (!plane.point.isZero(0) &&
        std::abs(normal.dot(first.position - point)) > same * std::max(point.norm(), first.position.norm()))
        refuse_key("motion.keys[0].position", shown(first.position) + " m",
                   "a point of the plane through " + shown(point) + " m");
}

}  // namespace

void validate(const Shape& shape, const ColliderSettings& collider) {
    const std::string object = titled("collider", collider.name);
    std::visit(ShapeCheck{object}, shape);
    require_finite(object, "position", collider.position);
    require_finite(object, "rotation", collider.rotation);
    validate(collider.motion, object);
    if (const auto* plane = std::get_if<Plane>(&shape)) require_keys_of_plane(*plane, collider, object);
    require_surface(collider.friction, collider.static_friction, collider.dynamic_friction, collider.restitution,
                    object);
    require(collider.contact_distance >= 0, object, "contact_distance", collider.contact_distance, "a length >= 0 (m)");
}

void validate(const SurfaceSettings& surface, const std::string& object) {
    require_surface(surface.friction, surface.static_friction, surface.dynamic_friction, surface.restitution, object);
}

void validate(const Pose& pose, const std::string& object) {
    require_finite(object, "position", pose.position);
    require_finite(object, "rotation", pose.rotation);
}

}  // namespace skerry
