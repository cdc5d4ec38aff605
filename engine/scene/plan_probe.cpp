// Finds the bodies, colliders, joints and other objects that probes name.
#include <algorithm>

#include "engine/scene/scene_plan.h"

namespace skerry {

namespace {

/// Finds the body or collider `entry.by` that exerts the measured force. For the force on a collider only bodies are
/// searched, because only they exert forces on it. Throws SceneError if no object has this name, or if a body and a
/// collider both have it.
void find_partner(const ProbeEntry& entry, const ScenePlan& plan, SeriesPlan& series) {
    const Place place = entry.place.key("by");
    const auto index_in = [&](const std::vector<std::string_view>& names) -> std::optional<std::size_t> {
        const auto found = std::ranges::find(names, *entry.by);
        if (found == names.end()) return {};
        return static_cast<std::size_t>(found - names.begin());
    };
    series.by_body = index_in(names_of(plan.bodies));
    if (const auto collider = index_in(names_of(plan.colliders)); collider && !series.collider) {
        if (series.by_body)
            place.refuse(in_quotes(*entry.by) + ", which is the name of both a body and a collider",
                         "the name of only one body or collider");
        series.by_collider = collider;
    }
    if (series.by_body || series.by_collider) return;
    std::vector<std::string> names;
    for (const std::string_view name : names_of(plan.bodies)) names.emplace_back(name);
    if (!series.collider)
        for (const std::string_view name : names_of(plan.colliders)) names.emplace_back(name);
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
    // Largest allowed distance of the point of a probe from the mesh, as a fraction of the diagonal of the bounding
    // box. A point of the body can be outside of its mesh by rounding, or because a round shape has flat facets.
    constexpr Real reach = 0.01;
    const auto found = follow_point(mesh.nodes, mesh.tetrahedra, *entry.point, reach * (upper - lower).norm());
    if (found) return *found;
    const Vec3& nearest = mesh.nodes[static_cast<std::size_t>(nearest_node(mesh.nodes, *entry.point).first)];
    constexpr int digits = 6;
    const auto text = [](const Vec3& v) {
        return "[" + short_text(v.x(), digits) + ", " + short_text(v.y(), digits) + ", " + short_text(v.z(), digits) +
               "]";
    };
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
    const auto find = [&](const char* kind, const std::optional<std::string>& name,
                          const std::vector<std::string_view>& names, std::size_t& index) {
        if (name) index = find_name(names, *name, kind, entry.place.key(kind));
    };
    find("joint", entry.joint, names_of(plan.joints), series.joint);
    find("tie", entry.tie, names_of(plan.ties), series.tie);
    find("cable", entry.cable, names_of(plan.cables), series.cable);
    find("cavity", entry.cavity, names_of(plan.cavities), series.cavity);
    find("spring", entry.spring, names_of(plan.springs), series.spring);
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
