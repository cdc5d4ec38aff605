// Finds bodies whose surface crosses itself. Contacts prevent this only for bodies with self-contact.
#include <algorithm>

#include "engine/base/complaint.h"
#include "engine/world/step/step.h"
#include "jobs/parallel_for.h"
#include "systems/collision/search/search_pair.h"
#include "systems/collision/tree/bvh.h"

namespace skerry {

namespace {

// Placeholder for the number of self-crossings of a body that is not checked: the number cannot have changed, or
// another rank checks the body.
constexpr Index unchanged = -1;

/// True if this rank must check the body: it owns the body, and the body may have deformed since the last check.
bool may_have_changed(const Model& model, std::size_t b) {
    return model.bodies.kind[b] == BodyKind::deformable && !model.is_rigid(b) && !model.bodies.asleep[b] &&
           model.bodies.unstrained[b] == 0 && !model.bodies.is_ghost(b);
}

Index count_crossings(Model& model, const CollisionInputs& inputs, Index body) {
    refit_bvh(model.bodies.bvh_nodes[body], model.bvh.node, model.bvh_leaves.nodes, model.nodes.position,
              model.bvh.box);
    return count_self_crossings(inputs, body, model.bvh.box);
}

void note(const Model& model, std::size_t b, Real time, Index places, std::vector<SelfCrossing>& crossings) {
    const BodyHandle body = model.body_map.handle_of_slot(model.bodies.slot[b]);
    auto entry = std::ranges::find(crossings, body, &SelfCrossing::body);
    if (entry == crossings.end()) {
        if (places <= 0) return;
        entry =
            crossings.insert(entry, SelfCrossing{.body = body, .name = model.body_records[b].name, .first_time = time});
    }
    if (places != unchanged) entry->last_places = places;
    if (entry->last_places == 0) return;
    entry->self_contact = model.bodies.self_contact[b] != 0;
    entry->last_time = time;
    entry->most_places = std::max(entry->most_places, places);
}

}  // namespace

void find_self_crossings(Executor& executor, Model& model, Real time, Column<Index>& places,
                         std::vector<SelfCrossing>& crossings) {
    const CollisionInputs inputs =
        CollisionInputs::bind({}, model.bodies, model.colliders, model.surface, model.materials, model.bvh,
                              model.bvh_leaves, model.nodes, model.disabled_pairs, model.material_pairs);
    places.resize(model.bodies.slot.size());
    parallel_for(executor, places.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b)
            places[b] = may_have_changed(model, b) ? count_crossings(model, inputs, static_cast<Index>(b)) : unchanged;
    });
    for (std::size_t b = 0; b < places.size(); ++b)
        if (places[b] > 0 ||
            (!crossings.empty() && model.bodies.kind[b] == BodyKind::deformable && !model.bodies.is_ghost(b)))
            note(model, b, time, places[b], crossings);
}

std::string SelfCrossing::message() const {
    return "the surface of body '" + name + "' crosses itself in up to " + std::to_string(most_places) +
           (most_places == 1 ? " place" : " places") + ", first found at " + short_text(first_time) +
           " s and last at " + short_text(last_time) + " s";
}

}  // namespace skerry
