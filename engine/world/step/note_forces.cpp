#include <algorithm>
#include <span>

#include "components/any_table.h"
#include "engine/world/edit/joining_rows.h"
#include "engine/world/step/seams.h"
#include "engine/world/step/step.h"

namespace skerry {

namespace {

/// Adds the links (pairs of joined bodies) of a table such as JointTable. Each row adds pairs of its first body with
/// every other body that it joins. A tie whose nodes have all broken off joins nothing.
template <class Table>
void add_links(Table& table, BodyLinks& links) {
    const AnyTable any(table);
    for (std::size_t row = 0; row < table.slot.size(); ++row) {
        if constexpr (requires { table.holds(row); })
            if (!table.holds(row)) continue;
        Index first = no_index;
        for (const ColumnInfo& info : any.columns()) {
            if (info.role != ColumnRole::body) continue;
            const auto* const bodies = reinterpret_cast<const Index*>(any.column(info).read());
            const Range entries = entries_of(table, info, row);
            for (Index entry = entries.begin; entry < entries.end; ++entry) {
                const Index body = bodies[entry];
                if (body == no_index || body == first) continue;
                if (first == no_index) {
                    first = body;
                    continue;
                }
                links.first.push_back(first);
                links.second.push_back(body);
            }
        }
    }
}

}  // namespace

void note_forces(Model& model) {
    const bool was_forced = model.forced;
    model.forced = model.force_rate_moves = false;
    for (const ForceElement* element : force_elements) {
        if (!element->any(model)) continue;
        model.forced = true;
        model.force_rate_moves |= element->rate_moves;
        if (element->derive) element->derive(model);
    }
    note_force_rates(model);
    // If the last force element was removed, `forced` stays true for one more step. The reason is the energy balance of
    // this step: velocities are older than positions, so the balance uses the forces of the step before.
    if (was_forced && !model.forced)
        model.forced =
            std::ranges::any_of(model.nodes.applied_before, [](const Vec3& force) { return force != Vec3::Zero(); });
}

void note_force_rates(Model& model) {
    model.force_rate.clear();
    model.force_damping.clear();
    model.force_drag.clear();
    for (const ForceElement* element : force_elements) {
        if (!element->any(model)) continue;
        const auto add = [&](auto* add_of, Column<Real>& of_body) {
            if (!add_of) return;
            of_body.resize(model.bodies.slot.size());
            add_of(model, of_body);
        };
        add(element->add_rate, model.force_rate);
        add(element->bound_damping, model.force_damping);
        add(element->add_drag, model.force_drag);
    }
}

void note_changed_seams(Model& model) {
    const auto has_one = [&](const ForceElement* element) { return element->any(model); };
    if (model.forced && std::ranges::none_of(force_elements, has_one)) note_forces(model);
    if (model.force_rate_moves) note_force_rates(model);
    if (!model.links_open) return;
    model.links_open = false;
    model.index_surface_sets();
    model.links.first.clear();
    model.links.second.clear();
    model.for_each_joining([&](const char*, auto& table, auto&) { add_links(table, model.links); });
    for (std::size_t j = 0; j < model.joints.size(); ++j) {
        if (model.joints.leader[j] == no_index) continue;
        model.links.first.push_back(model.joints.first[j]);
        model.links.second.push_back(model.joints.first[static_cast<std::size_t>(model.joints.leader[j])]);
    }
}

}  // namespace skerry
