// Resolves the names of bodies, colliders and joints that probes use.
#include <algorithm>

#include "engine/scene/scene_plan.h"

namespace skerry {

namespace {

constexpr std::size_t nowhere = static_cast<std::size_t>(-1);

/// Returns the index of a name in a list of plans, or `nowhere`.
std::size_t find_name(const auto& plans, const std::string& name) {
    const auto found = std::ranges::find(plans, name, [](const auto& plan) { return plan.settings.name; });
    return found == plans.end() ? nowhere : static_cast<std::size_t>(found - plans.begin());
}

std::vector<std::string> names_of(const auto& plans) {
    std::vector<std::string> names;
    for (const auto& plan : plans) names.push_back(plan.settings.name);
    return names;
}

}  // namespace

std::size_t find_body(const ScenePlan& plan, const std::string& name, const Place& place) {
    const std::size_t body = find_name(plan.bodies, name);
    if (body == nowhere) place.refuse(in_quotes(name), "the name of a body", nearest_hint(name, names_of(plan.bodies)));
    return body;
}

std::size_t find_collider(const ScenePlan& plan, const std::string& name, const Place& place) {
    const std::size_t collider = find_name(plan.colliders, name);
    if (collider == nowhere)
        place.refuse(in_quotes(name), "the name of a collider", nearest_hint(name, names_of(plan.colliders)));
    return collider;
}

namespace {

std::size_t find_cable(const ScenePlan& plan, const std::string& name, const Place& place) {
    const auto found = std::ranges::find(plan.cables, name, &CablePlan::name);
    if (found != plan.cables.end()) return static_cast<std::size_t>(found - plan.cables.begin());
    std::vector<std::string> names;
    for (const CablePlan& cable : plan.cables) names.push_back(cable.name);
    place.refuse(in_quotes(name),
                 names.empty() ? "the name of a cable, but the scene has no cables" : "the name of a cable",
                 nearest_hint(name, names));
}

}  // namespace

std::size_t find_joint(const ScenePlan& plan, const std::string& name, const Place& place) {
    const auto found = std::ranges::find(plan.joints, name, &JointPlan::name);
    if (found != plan.joints.end()) return static_cast<std::size_t>(found - plan.joints.begin());
    std::vector<std::string> names;
    for (const JointPlan& joint : plan.joints) names.push_back(joint.name);
    place.refuse(in_quotes(name),
                 names.empty() ? "the name of a joint, but the scene has no joints" : "the name of a joint",
                 nearest_hint(name, names));
}

namespace {

/// Finds the body or collider that exerts a force. Throws SceneError if a body and a collider both have the name.
void find_partner(const ProbeEntry& entry, const ScenePlan& plan, SeriesPlan& series) {
    const Place place = entry.place.key("by");
    const std::size_t body = find_name(plan.bodies, *entry.by), collider = find_name(plan.colliders, *entry.by);
    if (body != nowhere) series.by_body = body;
    if (collider != nowhere && !series.collider) {
        if (body != nowhere)
            place.refuse(in_quotes(*entry.by) + ", which is the name of both a body and a collider",
                         "the name of only one body or collider");
        series.by_collider = collider;
    }
    if (series.by_body || series.by_collider) return;
    std::vector<std::string> names = names_of(plan.bodies);
    if (!series.collider)
        for (const std::string& name : names_of(plan.colliders)) names.push_back(name);
    place.refuse(in_quotes(*entry.by), series.collider ? "the name of a body" : "the name of a body or a collider",
                 nearest_hint(*entry.by, names));
}

PartEntry part_of(const ProbeEntry& entry) {
    return {.set = entry.set, .box = entry.box, .nodes = {}, .place = entry.place};
}

MaterialPoint find_point(const ProbeEntry& entry, const Mesh& mesh) {
    Vec3 lower = mesh.nodes.front(), upper = lower;
    for (const Vec3& node : mesh.nodes) {
        lower = lower.cwiseMin(node);
        upper = upper.cwiseMax(node);
    }
    // Largest distance of a probe from the body, as a fraction of the diagonal of the bounding box. It allows for
    // rounding and for the facets of round shapes.
    constexpr Real reach = 0.01;
    const auto found = follow_point(mesh.nodes, mesh.tetrahedra, *entry.point, reach * (upper - lower).norm());
    if (found) return *found;
    const Vec3& nearest = mesh.nodes[static_cast<std::size_t>(nearest_node(mesh.nodes, *entry.point).first)];
    const auto text = [](const Vec3& v) { return Json{v.x(), v.y(), v.z()}.dump(); };
    entry.place.key("point").refuse(text(*entry.point), "a point inside the body",
                                    "move the point; the nearest node is at " + text(nearest));
}

void plan_series(const ProbeEntry& entry, ScenePlan& plan) {
    SeriesPlan series;
    series.name = entry.name;
    series.quantity = entry.quantity;
    series.place = entry.place;
    if (entry.body) series.body = find_body(plan, *entry.body, entry.place.key("body"));
    if (entry.collider) series.collider = find_collider(plan, *entry.collider, entry.place.key("collider"));
    if (entry.joint) series.joint = find_joint(plan, *entry.joint, entry.place.key("joint"));
    if (entry.tie) series.tie = find_tie(plan, *entry.tie, entry.place.key("tie"));
    if (entry.cable) series.cable = find_cable(plan, *entry.cable, entry.place.key("cable"));
    if (entry.cavity) series.cavity = find_cavity(plan, *entry.cavity, entry.place.key("cavity"));
    if (entry.spring) series.spring = find_spring(plan, *entry.spring, entry.place.key("spring"));
    if (entry.by) find_partner(entry, plan, series);
    if (series.body) {
        const BodyPlan& body = plan.bodies[*series.body];
        const Mesh& mesh = plan.meshes[body.mesh];
        const bool is_rigid = body.settings.dynamics == BodyDynamics::rigid || body.shape.sphere ||
                              body.shape.capsule || body.shape.cylinder;
        if (is_rigid && (entry.quantity == ProbeQuantity::stress || entry.quantity == ProbeQuantity::volume))
            entry.place.key("body").refuse(
                "the rigid body " + in_quotes(*entry.body),
                "a body that deforms, for the quantity " + in_quotes(name_of(entry.quantity)));
        if (entry.box || entry.set) series.nodes = nodes_of(part_of(entry), body, plan);
        if (entry.point) series.point = find_point(entry, mesh);
        if (entry.quantity == ProbeQuantity::reaction) {
            series.pin = static_cast<std::size_t>(entry.pin.value_or(0));
            if (series.pin >= body.pins.size())
                entry.place.key(entry.pin ? "pin" : "body")
                    .refuse(body.pins.empty() ? "a body without pins" : "pin " + std::to_string(series.pin),
                            body.pins.empty()
                                ? "a body with pins"
                                : "the number of a pin of the body, from 0 to " + std::to_string(body.pins.size() - 1));
        }
    }
    plan.series.push_back(std::move(series));
}

}  // namespace

void plan_probe(const ProbeEntry& entry, ScenePlan& plan) {
    const auto same = [&](const auto& other) { return other.name == entry.name; };
    if (std::ranges::any_of(plan.probes, same) || std::ranges::any_of(plan.series, same))
        entry.place.key("name").refuse(in_quotes(entry.name) + ", which is already the name of a probe",
                                       "a different name for every probe");
    if (entry.quantity != ProbeQuantity::contacts) return plan_series(entry, plan);
    if (!entry.box && !entry.set)
        entry.place.refuse("neither \"box\" nor \"set\"", "the part of the body whose contacts are recorded");
    const std::size_t body = find_body(plan, *entry.body, entry.place.key("body"));
    plan.probes.push_back({entry.name, body, nodes_of(part_of(entry), plan.bodies[body], plan)});
}

}  // namespace skerry
