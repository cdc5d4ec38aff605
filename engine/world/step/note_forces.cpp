#include <algorithm>
#include <span>

#include "components/any_table.h"
#include "engine/world/step/seams.h"
#include "engine/world/step/step.h"

namespace skerry {

namespace {

/// Adds links between joined bodies: for each row of the table, between its first body and each other body that the row
/// joins.
void add_links(AnyTable table, BodyLinks& links) {
    std::span<const Index> first;
    for (const ColumnInfo& info : table.columns()) {
        if (info.role != ColumnRole::body) continue;
        const AnyColumn column = table.column(info);
        const std::span<const Index> bodies(reinterpret_cast<const Index*>(column.read()), column.size());
        if (first.empty()) {
            first = bodies;
            continue;
        }
        for (std::size_t row = 0; row < bodies.size(); ++row) {
            if (first[row] == no_index || bodies[row] == no_index) continue;
            links.first.push_back(first[row]);
            links.second.push_back(bodies[row]);
        }
    }
}

}  // namespace

void note_forces(Model& model) {
    const bool was_forced = model.forced;
    model.forced = false;
    model.force_rate.clear();
    model.force_damping.clear();
    for (const ForceElement* element : force_elements) {
        if (!element->any(model)) continue;
        model.forced = true;
        if (element->derive) element->derive(model);
        if (element->add_rate) {
            model.force_rate.resize(model.bodies.slot.size());
            element->add_rate(model, model.force_rate);
        }
        if (element->bound_damping) {
            model.force_damping.resize(model.bodies.slot.size());
            element->bound_damping(model, model.force_damping);
        }
    }
    // If the last force element was removed, the next step must still account for the work of its last forces.
    if (was_forced && !model.forced)
        model.forced =
            std::ranges::any_of(model.nodes.applied_before, [](const Vec3& force) { return force != Vec3::Zero(); });
}

void note_changed_seams(Model& model) {
    const auto has_one = [&](const ForceElement* element) { return element->any(model); };
    if (model.forced && std::ranges::none_of(force_elements, has_one)) note_forces(model);
    if (!model.links_open) return;
    model.links_open = false;
    model.links.first.clear();
    model.links.second.clear();
    model.for_each_joining([&](const char*, auto& table, auto&) { add_links(table, model.links); });
}

}  // namespace skerry
