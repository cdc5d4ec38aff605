#include "engine/program/plan_warnings.h"

#include <algorithm>
#include <cmath>
#include <iostream>

#include "engine/mesh/manifold_fault.h"
#include "engine/output/number_text.h"
#include "systems/geometry/rotation.h"

namespace skerry {

namespace {

// Limits beyond which a value is probably a mistake.

// sag of a body under its weight, divided by its height: density * gravity * height / E; the softest gels reach about 1
constexpr Real most_sag = 2;
constexpr Real least_density = 2, most_density = 25000;  // aerogels and osmium are just within [kg/m^3]
constexpr Real most_modulus = 1.3e12;                    // diamond is just below [Pa]
constexpr Real most_gravity = 5000;                      // below 9810, which is gravity in mm/s^2 by mistake [m/s^2]
constexpr Real most_size_ratio = 999;                    // size of longest body over shortest; a body in mm gives 1000
// If the center of a body is further from the origin than this multiple of the size of the body, a pin that rotates
// about the origin is probably a mistake.
constexpr Real most_pivot_distance = 1;
// longest plausible rigid body from a surface file; the file of a longer one is probably in mm [m]
constexpr Real most_surface_size = 20;
constexpr Real least_given_density = 1;   // mean density if a mass is given; the body may be hollow [kg/m^3]
constexpr Real least_yield_ratio = 1e-6;  // yield stress over Young's modulus

struct Extent {
    Real size = 0;               // longest edge of the bounding box [m]
    Real height = 0;             // extent along the direction of gravity [m]
    Vec3 center = Vec3::Zero();  // center of the bounding box in the frame of the mesh [m]
    Vec3 edges = Vec3::Zero();   // edges of the bounding box in the frame of the mesh [m]
};

Extent extent_of(const Mesh& mesh, const BodySettings& body, const Vec3& gravity) {
    if (mesh.nodes.empty()) return {};
    const Vec3 down = rotation_matrix(body.rotation).transpose() * gravity.normalized();
    Vec3 lower = mesh.nodes.front(), upper = lower;
    Real lowest = infinity, highest = -infinity;
    for (const Vec3& node : mesh.nodes) {
        lower = lower.cwiseMin(node);
        upper = upper.cwiseMax(node);
        lowest = std::min(lowest, down.dot(node));
        highest = std::max(highest, down.dot(node));
    }
    return {(upper - lower).maxCoeff(), highest - lowest, (lower + upper) / 2, upper - lower};
}

/// Formats an estimate with two digits, for example "20,000" or "3.9".
std::string rough(Real value) {
    if (value < 100) return short_text(value, 2);
    const Real unit = std::pow(10, std::floor(std::log10(value)) - 1);
    return count_text(std::round(value / unit) * unit);
}

/// Returns the materials of a body: the default material, then those of the labels of its tetrahedra.
std::vector<std::size_t> materials_of(const BodyPlan& body) {
    std::vector<std::size_t> materials{body.material};
    for (const auto& [label, material] : body.materials) materials.push_back(material);
    return materials;
}

void warn_of_sag(const ScenePlan& plan, const BodyPlan& body, Real height, std::vector<std::string>& warnings) {
    if (body.settings.dynamics == BodyDynamics::rigid) return;
    Real sag = infinity;
    const MaterialSettings* sagging = nullptr;
    for (const std::size_t m : materials_of(body)) {
        const MaterialSettings& material = plan.materials[m].second;
        const Real of_material = material.density * plan.settings.gravity.norm() * height / material.young_modulus;
        if (of_material >= sag) continue;
        sag = of_material;
        sagging = &material;
    }
    if (sagging == nullptr || !(sag > most_sag)) return;
    warnings.push_back("body \"" + body.settings.name + "\" sags by about " + rough(sag) +
                       " times its height under its own weight (height " + with_unit(height, "m") + ", E " +
                       short_text(sagging->young_modulus) + " Pa, density " + short_text(sagging->density, 4) +
                       " kg/m^3): is E in Pa, the density in kg/m^3, and the mesh in m (mesh.scale)?");
}

/// Volume of a mesh of tetrahedra or of a closed surface [m^3].
Real volume_of(const Mesh& mesh) {
    Real six_volumes = 0;
    const Vec3& origin = mesh.nodes.front();
    const auto from_point = [&](Index n, const Vec3& start) -> Vec3 {
        return mesh.nodes[static_cast<std::size_t>(n)] - start;
    };
    for (const auto& t : mesh.triangles)
        six_volumes += from_point(t[0], origin).dot(from_point(t[1], origin).cross(from_point(t[2], origin)));
    for (const auto& t : mesh.tetrahedra) {
        const Vec3& corner = mesh.nodes[static_cast<std::size_t>(t[0])];
        six_volumes += from_point(t[1], corner).dot(from_point(t[2], corner).cross(from_point(t[3], corner)));
    }
    return six_volumes / 6;
}

/// Warns of an unlikely size and of unlikely mass properties of a rigid body.
void warn_of_rigid(const BodySettings& body, const Mesh& mesh, const Extent& extent,
                   std::vector<std::string>& warnings) {
    if (body.dynamics != BodyDynamics::rigid || mesh.nodes.empty()) return;
    const std::string body_text = "body \"" + body.name + "\"";
    if (!mesh.triangles.empty() && extent.size > most_surface_size)
        warnings.push_back(body_text + " is " + with_unit(extent.size, "m") +
                           " long: is its surface in m? STL files have no units; for a file in millimetres set "
                           "\"scale\": 0.001 in \"mesh\"");
    if (!body.mass) return;
    const Real density = *body.mass / volume_of(mesh), diagonal = extent.edges.norm();
    if (density > most_density || density < least_given_density)
        warnings.push_back(body_text + " has a mass of " + short_text(*body.mass) + " kg and a mean density of " +
                           short_text(density, 2) + " kg/m^3: is \"mass\" in kg, and the mesh in m?");
    if (!body.inertia || !body.center_of_mass) return;
    const Real radius = std::sqrt(body.inertia->diagonal().maxCoeff() / *body.mass);
    if (radius > diagonal)
        warnings.push_back(body_text + " has a radius of gyration of " + with_unit(radius, "m") +
                           ", more than the diagonal of its bounding box of " + with_unit(diagonal, "m") +
                           ": is \"inertia\" in kg m^2, and \"mass\" in kg?");
    const Vec3 outside = (*body.center_of_mass - extent.center).cwiseAbs() - extent.edges / 2;
    if (outside.maxCoeff() > diagonal)
        warnings.push_back(body_text + " has its centre of mass " + with_unit(outside.maxCoeff(), "m") +
                           " outside its bounding box: is \"center_of_mass\" in m, and in the frame of the mesh?");
}

void warn_of_sizes(const ScenePlan& plan, const std::vector<Extent>& extents, std::vector<std::string>& warnings) {
    const auto by_size = [](const Extent& a, const Extent& b) { return a.size < b.size; };
    const auto [least, most] = std::ranges::minmax_element(extents, by_size);
    if (least == extents.end() || !(least->size > 0) || !(most->size > most_size_ratio * least->size)) return;
    const auto body_text = [&](auto extent) {
        return "body \"" + plan.bodies[static_cast<std::size_t>(extent - extents.begin())].settings.name + "\"";
    };
    warnings.push_back(body_text(most) + " is " + with_unit(most->size, "m") + " long, but " + body_text(least) +
                       " only " + with_unit(least->size, "m") +
                       ": are all lengths in m? For a mesh file in millimetres set mesh.scale to 0.001");
}

void warn_of_material(const std::string& name, const MaterialSettings& material, std::vector<std::string>& warnings) {
    const std::string density_part =
        "material \"" + name + "\" has a density of " + short_text(material.density, 4) + " kg/m^3, ";
    if (material.density < least_density)
        warnings.push_back(density_part + "as light as air or lighter: is it in g/cm^3? 1 g/cm^3 is 1000 kg/m^3");
    if (material.density > most_density)
        warnings.push_back(density_part + "more than any material: is it in kg/m^3? Water has 1000 kg/m^3");
    if (material.young_modulus > most_modulus)
        warnings.push_back("material \"" + name + "\" has a Young's modulus of " + short_text(material.young_modulus) +
                           " Pa, more than diamond: is it in Pa?");
    if (material.plasticity && material.plasticity->yield_stress < least_yield_ratio * material.young_modulus)
        warnings.push_back("material \"" + name + "\" has a yield stress of " +
                           short_text(material.plasticity->yield_stress) + " Pa, far below its Young's modulus of " +
                           short_text(material.young_modulus) + " Pa: are both in Pa?");
}

/// Warns if the position given for a collider differs from the position of its first motion key. The run uses the keys.
void warn_of_pose(const ColliderSettings& collider, std::vector<std::string>& warnings) {
    if (collider.motion.keys.empty() || collider.position.isZero(0)) return;
    const Vec3& first = collider.motion.keys.front().position;
    if (collider.position.isApprox(first)) return;
    const auto text = [](const Vec3& v) { return Json{v.x(), v.y(), v.z()}.dump(); };
    warnings.push_back("collider \"" + collider.name + "\" starts at the position " + text(first) +
                       " of its first key, not at its \"position\" " + text(collider.position) +
                       ": keys are poses of the collider itself; correct the keys, or delete \"position\"");
}

/// Warns if a pin rotates about the origin of the world because no centre of rotation was given, and the body is far
/// from the origin.
void warn_of_pivots(const BodyPlan& body, const Extent& extent, std::vector<std::string>& warnings) {
    for (std::size_t p = 0; p < body.pins.size(); ++p) {
        const Motion& motion = body.pins[p].motion;
        const Vec3& center = motion.keys.empty() ? body.pins[p].pivot : motion.keys.front().position;
        const bool turns = motion.turns() || !motion.angular_velocity.isZero(0);
        const Real distance = (body.settings.position + rotation_matrix(body.settings.rotation) * extent.center).norm();
        if (!turns || !center.isZero(0) || !(distance > most_pivot_distance * extent.size)) continue;
        warnings.push_back("pin " + std::to_string(p) + " of body \"" + body.settings.name +
                           "\" rotates about the origin of the world, " + with_unit(distance, "m") +
                           " away: give the centre of rotation as " +
                           (motion.keys.empty() ? "\"pivot\"" : "\"position\" of every key"));
    }
}

/// Warns if several pins together hold all nodes of a body that deforms. The mesh is then too coarse for the region
/// between the pins, for example with one layer of tetrahedra between two plates.
void warn_of_held_nodes(const BodyPlan& body, const Mesh& mesh, std::vector<std::string>& warnings) {
    if (body.settings.dynamics == BodyDynamics::rigid || body.pins.size() < 2) return;
    std::vector<bool> held(mesh.nodes.size(), false);
    for (const PinPlan& pin : body.pins)
        if (pin.directions.empty())
            for (const Index node : pin.nodes) held[static_cast<std::size_t>(node)] = true;
    if (!std::ranges::all_of(held, [](bool each) { return each; })) return;
    warnings.push_back("the pins of body \"" + body.settings.name +
                       "\" hold all of its nodes, so that none can move between them: refine its mesh (mesh.refine)");
}

}  // namespace

std::vector<std::string> plan_warnings(const ScenePlan& plan) {
    std::vector<std::string> warnings;
    const Vec3& gravity = plan.settings.gravity;
    if (gravity.norm() > most_gravity)
        warnings.push_back("settings.gravity is " + short_text(gravity.norm()) +
                           " m/s^2: is it in m/s^2? The Earth has 9.81 m/s^2");
    std::vector<Extent> extents;
    std::vector<bool> used(plan.materials.size(), false);
    const BodyPlan* before = nullptr;
    for (const BodyPlan& body : plan.bodies) {
        for (const std::size_t m : materials_of(body)) used[m] = true;
        const bool copy = before != nullptr && body.mesh == before->mesh && body.material == before->material &&
                          body.materials == before->materials && body.settings.dynamics == before->settings.dynamics &&
                          body.settings.rotation == before->settings.rotation;
        extents.push_back(copy ? extents.back() : extent_of(plan.meshes[body.mesh], body.settings, gravity));
        if (!copy) warn_of_sag(plan, body, extents.back().height, warnings);
        const bool same_mass = copy && body.settings.mass == before->settings.mass &&
                               body.settings.center_of_mass == before->settings.center_of_mass &&
                               body.settings.inertia == before->settings.inertia;
        if (!same_mass) warn_of_rigid(body.settings, plan.meshes[body.mesh], extents.back(), warnings);
        if (!copy && body.settings.dynamics == BodyDynamics::rigid)
            for (const std::size_t m : materials_of(body))
                if (plan.materials[m].second.plasticity)
                    warnings.push_back("body \"" + body.settings.name +
                                       "\" is rigid and does not yield: the plasticity of " + "material \"" +
                                       plan.materials[m].first + "\" is not used for it");
        warn_of_pivots(body, extents.back(), warnings);
        warn_of_held_nodes(body, plan.meshes[body.mesh], warnings);
        before = &body;
    }
    warn_of_sizes(plan, extents, warnings);
    for (std::size_t m = 0; m < used.size(); ++m)
        if (used[m]) warn_of_material(plan.materials[m].first, plan.materials[m].second, warnings);
    for (const ColliderPlan& collider : plan.colliders) warn_of_pose(collider.settings, warnings);
    return warnings;
}

std::vector<std::string> plan_notes(const ScenePlan& plan) {
    std::vector<std::string> found = plan.notes;
    std::vector<bool> seen(plan.meshes.size(), false);
    for (const BodyPlan& body : plan.bodies) {
        if (seen[body.mesh] || body.settings.dynamics == BodyDynamics::rigid) continue;
        seen[body.mesh] = true;
        const std::size_t parts = mesh::count_parts(plan.meshes[body.mesh]);
        if (parts > 1)
            found.push_back("the mesh of body \"" + body.settings.name + "\" has " + grouped(parts) +
                            " parts without a common node, which can move apart");
    }
    return found;
}

void print_lines(const char* kind, const std::vector<std::string>& texts) {
    for (const std::string& text : texts) std::cerr << "skerry: " << kind << ": " << text << std::endl;
}

}  // namespace skerry
