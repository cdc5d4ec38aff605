#include "engine/world/save/list_state.h"

#include <stdexcept>

#include "engine/world/save/saved_numbers.h"

namespace skerry {

namespace {

/// Lists the saved columns of a table, except for the column at the address `left_out`. In the file, each column has
/// the path `path` followed by its name.
void list_table(const std::string& path, AnyTable table, Archive& archive, const void* left_out = nullptr) {
    for (const ColumnInfo& info : table.columns()) {
        if (!is_saved(info.role) || table.column(info).is(left_out)) continue;
        if (!info.type->is_known())
            throw std::logic_error(path + info.name +
                                   " must be saved, but its row type has neither NumbersOf nor MembersOf");
        archive.column(path + info.name, table.column(info));
    }
}

template <class Handle>
void list_handles(const std::string& path, HandleMap<Handle>& map, Archive& archive) {
    map.for_each_column([&](const char* name, auto& column) { archive.column(path + "/" + name, column); });
    archive.value(path + "/least_generation", map.least_generation());
}

template <class T>
void list_ragged(const std::string& path, Ragged<T>& rows, Archive& archive) {
    archive.column(path + "/offset", rows.offset);
    archive.column(path + "/item", rows.item);
}

void list_visuals(SavedVisuals& saved, Archive& archive) {
    archive.column("visuals/of_body", saved.of_body);
    list_ragged("visuals/nodes", saved.nodes, archive);
    list_ragged("visuals/triangles", saved.triangles, archive);
    list_ragged("visuals/texture_points", saved.texture_points, archive);
    list_ragged("visuals/texture_corners", saved.texture_corners, archive);
    list_ragged("visuals/material", saved.material, archive);
    list_ragged("visuals/file", saved.file, archive);
    list_ragged("visuals/color", saved.color, archive);
    list_ragged("visuals/material_name", saved.material_name, archive);
    list_ragged("visuals/texture", saved.texture, archive);
}

void list_records(SavedRows& saved, Archive& archive) {
    archive.column("meshes/of_body", saved.meshes.of_body);
    list_ragged("meshes/nodes", saved.meshes.nodes, archive);
    list_ragged("meshes/tetrahedra", saved.meshes.tetrahedra, archive);
    list_ragged("meshes/surface", saved.meshes.surface, archive);
    list_ragged("meshes/covered_offset", saved.meshes.covered_offset, archive);
    list_ragged("meshes/covered_item", saved.meshes.covered_item, archive);
    archive.value("handles/world", saved.world);
    archive.column("records/body_element", saved.body_element);
    archive.column("records/body_asked", saved.body_asked);
    archive.column("records/body_settled", saved.body_settled);
    archive.column("records/given_mass", saved.given_mass);
    archive.column("records/choice_reason", saved.choice_reason);
    archive.column("records/choice_estimate", saved.choice_estimate);
    archive.column("records/collider_settled", saved.collider_settled);
    archive.column("records/body_start", saved.body_start);
    archive.column("records/body_built", saved.body_built);
    list_ragged("records/mesh_shape", saved.mesh_shape, archive);
    list_ragged("records/tetrahedron_material", saved.tetrahedron_material, archive);
    list_ragged("records/label", saved.sets.label, archive);
    archive.column("sets/body", saved.sets.body);
    list_ragged("sets/name", saved.sets.name, archive);
    list_ragged("sets/nodes", saved.sets.nodes, archive);
    list_ragged("sets/tetrahedra", saved.sets.tetrahedra, archive);
    list_ragged("sets/faces", saved.sets.faces, archive);
    list_visuals(saved.visuals, archive);
    list_ragged("records/body_name", saved.body_name, archive);
    list_ragged("records/collider_name", saved.collider_name, archive);
    archive.column("records/shape_kind", saved.shape_kind);
    archive.column("records/shape_size", saved.shape_size);
}

void list_watch(StepWatch& watch, Archive& archive) {
    archive.value("watch/progress", watch);
    archive.value("watch/look", watch.evaluation);
    archive.column("watch/position", watch.position);
    archive.column("watch/stiffness_sum", watch.stiffness_sum);
    archive.column("watch/step", watch.step);
}

void list_model(Model& model, SavedRows& saved, Archive& archive) {
    for (const AnyTable& table : model.tables()) {
        // rest positions are saved once for each mesh (meshes/nodes), because several bodies may share a mesh
        const void* const of_meshes = &model.nodes.rest_position;
        list_table(std::string(table.name()) + "/", table, archive, of_meshes);
    }
    list_handles("handles/materials", model.material_map, archive);
    list_handles("handles/bodies", model.body_map, archive);
    list_handles("handles/colliders", model.collider_map, archive);
    list_handles("handles/attachments", model.attachment_map, archive);
    model.for_each_joining([&](const char* name, auto&, auto& map) {
        list_handles(std::string("handles/") + name, map, archive);
        list_ragged(std::string("names/") + name, saved.object_name[name], archive);
    });
    list_ragged("clusters/nodes", model.clusters.nodes, archive);
    archive.column("clusters/body", model.clusters.body);
    archive.column("clusters/inverse", model.clusters.inverse);
    list_watch(model.watch, archive);
    archive.value("clusters/open", model.clusters_open);
    archive.value("model/settled", model.settled);
}

void list_cache(ContactCache& cache, SavedRows& saved, Archive& archive) {
    list_table("warm_start/", cache.warm_start, archive);
    list_table("resting_contacts/", cache.resting, archive);
    list_table("pairs/", cache.pairs, archive);
    archive.column("pairs/candidates/offset", saved.candidates.offset);
    archive.column("pairs/candidates", saved.candidates.item);
    archive.column("pairs/candidates/asleep_until", saved.asleep_until);
    archive.column("pairs/self_origin", cache.pairs.self.origin);
    list_ragged("pairs/leaf_pairs", saved.leaf_pairs, archive);
    SearchState& search = cache.search;
    archive.column("search/body_valid_until", search.body_valid_until);
    archive.column("search/collider_valid_until", search.collider_valid_until);
    archive.column("search/collider_extent", search.memory.collider_extent);
    archive.column("search/rebase", search.memory.rebase);
    archive.value("search/broad_searches", search.broad_searches);
    archive.value("search/pair_searches", search.pair_searches);
    archive.value("search/candidate_count", search.candidate_count);
    archive.value("crossings/tested", cache.crossings.tested);
    archive.value("crossings/hits", cache.crossings.hits);
    archive.value("crossings/let_through", cache.crossings.let_through);
}

void list_run(WorldState& world, SavedRows& saved, Archive& archive) {
    archive.value("run/counters", world.record.counters);
    archive.value("run/balance", world.record.balance);
    archive.value("run/held", world.record.held);
    archive.column("run/limits/limit", saved.limit);
    archive.column("run/limits/slot", saved.limit_slot);
    archive.column("run/limits/generation", saved.limit_generation);
    list_ragged("run/limits/name", saved.limit_name, archive);
    archive.column("run/limits/steps", saved.limit_steps);
    archive.column("run/limits/tries", saved.limit_tries);
    archive.column("run/limits/seconds", saved.limit_seconds);
    SavedStart& start = saved.start;
    archive.column("run/start/overlap", start.overlap);
    archive.column("run/start/kind", start.kind);
    archive.column("run/start/measure", start.measure);
    archive.column("run/start/resolved", start.resolved);
    list_ragged("run/start/first_name", start.first_name, archive);
    list_ragged("run/start/second_name", start.second_name, archive);
    archive.column("run/start/moved", start.moved);
    list_ragged("run/start/moved_name", start.moved_name, archive);
    archive.column("run/start/translation", start.translation);
    SavedSelfCrossings& crossings = saved.self_crossings;
    archive.column("run/self_crossings/body", crossings.body);
    list_ragged("run/self_crossings/name", crossings.name, archive);
    archive.column("run/self_crossings/self_contact", crossings.self_contact);
    archive.column("run/self_crossings/time", crossings.time);
    archive.column("run/self_crossings/places", crossings.places);
    archive.value("last_step/kick", world.scratch.parameters.kick_time);
    // saved because users can read the contacts of the last step until the next step
    const AnyTable contacts(saved.contacts);
    for (const ColumnInfo& info : contacts.columns())
        archive.column(std::string("last_step/contacts/") + info.name, contacts.column(info));
}

}  // namespace

void list_settings(Settings& settings, Tuning& tuning, SavedRows& saved, Archive& archive) {
    archive.value("settings", settings);
    archive.value("settings", tuning);
    archive.value("settings/step_size", saved.step_size);
}

void list_state(WorldState& world, SavedRows& saved, Archive& archive) {
    archive.value("clock/time", world.clock.time);
    archive.value("clock/offset", world.clock.offset);
    archive.value("clock/step_before", world.clock.step_before);
    list_records(saved, archive);
    list_model(world.model, saved, archive);
    list_cache(world.cache, saved, archive);
    list_run(world, saved, archive);
}

}  // namespace skerry
