// The one list of what a file holds of a world: who writes and who reads both walk it.
#pragma once

#include <stdexcept>
#include <string>

#include "engine/world/save/saved_numbers.h"
#include "engine/world/save/saved_rows.h"

namespace skerry {

/// An archive has column(path, Column<T>&) and value(path, T&).
template <class T>
void list_column(const std::string& path, Column<T>& column, ColumnRole role, auto&& archive) {
    if (!is_saved(role)) return;
    if constexpr (Savable<T>)
        archive.column(path, column);
    else
        throw std::logic_error(path + " is state, but saved_numbers.h does not know its rows");
}

template <class T>
void list_ragged(const std::string& path, Ragged<T>& rows, auto&& archive) {
    archive.column(path + "/offset", rows.offset);
    archive.column(path + "/item", rows.item);
}

void list_settings(Settings& settings, SavedRows& saved, auto&& archive) {
    archive.value("/settings", settings);
    archive.value("/settings/step_size", saved.step_size);
}

void list_records(SavedRows& saved, auto&& archive) {
    archive.column("/meshes/of_body", saved.meshes.of_body);
    list_ragged("/meshes/nodes", saved.meshes.nodes, archive);
    list_ragged("/meshes/tetrahedra", saved.meshes.tetrahedra, archive);
    list_ragged("/meshes/surface", saved.meshes.surface, archive);
    list_ragged("/meshes/covered_offset", saved.meshes.covered_offset, archive);
    list_ragged("/meshes/covered_item", saved.meshes.covered_item, archive);
    archive.value("/handles/world", saved.world);
    archive.column("/records/body_element", saved.body_element);
    archive.column("/records/body_asked", saved.body_asked);
    archive.column("/records/body_settled", saved.body_settled);
    archive.column("/records/choice_reason", saved.choice_reason);
    archive.column("/records/choice_estimate", saved.choice_estimate);
    archive.column("/records/collider_settled", saved.collider_settled);
    list_ragged("/records/tetrahedron_material", saved.tetrahedron_material, archive);
    list_ragged("/records/body_name", saved.body_name, archive);
    list_ragged("/records/collider_name", saved.collider_name, archive);
    archive.column("/records/shape_kind", saved.shape_kind);
    archive.column("/records/shape_size", saved.shape_size);
}

void list_watch(StepWatch& watch, auto&& archive) {
    archive.value("/watch/progress", watch);
    archive.value("/watch/look", watch.look);
    archive.column("/watch/position", watch.position);
    archive.column("/watch/stiffness_sum", watch.stiffness_sum);
    archive.column("/watch/step", watch.step);
}

void list_model(Model& model, auto&& archive) {
    model.for_each_table([&](const std::string& table, auto& columns) {
        columns.for_each_column([&](const char* name, auto& column, ColumnRole role) {
            // meshes are saved once each, in their own frames
            const bool of_mesh = static_cast<const void*>(&column) == &model.nodes.rest_position;
            if (!of_mesh) list_column("/" + table + "/" + name, column, role, archive);
        });
    });
    const auto handles = [&](const std::string& path, auto& map) {
        map.for_each_column([&](const char* name, auto& column) { archive.column(path + "/" + name, column); });
    };
    handles("/handles/materials", model.material_map);
    handles("/handles/bodies", model.body_map);
    handles("/handles/colliders", model.collider_map);
    handles("/handles/attachments", model.attachment_map);
    handles("/handles/joints", model.joint_map);
    list_ragged("/clusters/nodes", model.clusters.nodes, archive);
    archive.column("/clusters/body", model.clusters.body);
    archive.column("/clusters/inverse", model.clusters.inverse);
    list_watch(model.watch, archive);
    archive.value("/clusters/open", model.clusters_open);
    archive.value("/model/settled", model.settled);
}

void list_cache(ContactCache& cache, SavedRows& saved, auto&& archive) {
    cache.warm_start.for_each_column([&](const char* name, auto& column, ColumnRole) {
        archive.column(std::string("/warm_start/") + name, column);
    });
    cache.resting.for_each_column([&](const char* name, auto& column, ColumnRole role) {
        list_column(std::string("/resting_contacts/") + name, column, role, archive);
    });
    cache.pairs.for_each_row_column([&](const char* name, auto& column, ColumnRole role) {
        list_column(std::string("/pairs/") + name, column, role, archive);
    });
    archive.column("/pairs/candidates/offset", saved.candidates.offset);
    archive.column("/pairs/candidates", saved.candidates.item);
    archive.column("/pairs/candidates/asleep_until", saved.asleep_until);
    SearchState& search = cache.search;
    archive.column("/search/body_valid_until", search.body_valid_until);
    archive.column("/search/collider_valid_until", search.collider_valid_until);
    archive.column("/search/collider_extent", search.memory.collider_extent);
    archive.column("/search/rebase", search.memory.rebase);
    archive.value("/search/broad_searches", search.broad_searches);
    archive.value("/search/pair_searches", search.pair_searches);
    archive.value("/search/candidate_count", search.candidate_count);
    archive.value("/crossings/tested", cache.crossings.tested);
    archive.value("/crossings/hits", cache.crossings.hits);
    archive.value("/crossings/let_through", cache.crossings.let_through);
}

void list_run(WorldState& world, SavedRows& saved, auto&& archive) {
    archive.value("/run/counters", world.record.counters);
    archive.value("/run/balance", world.record.balance);
    archive.column("/run/limits/limit", saved.limit);
    archive.column("/run/limits/slot", saved.limit_slot);
    archive.column("/run/limits/generation", saved.limit_generation);
    list_ragged("/run/limits/name", saved.limit_name, archive);
    archive.column("/run/limits/steps", saved.limit_steps);
    archive.column("/run/limits/tries", saved.limit_tries);
    archive.column("/run/limits/seconds", saved.limit_seconds);
    SavedStart& start = saved.start;
    archive.column("/run/start/overlap", start.overlap);
    archive.column("/run/start/kind", start.kind);
    archive.column("/run/start/measure", start.measure);
    archive.column("/run/start/resolved", start.resolved);
    list_ragged("/run/start/first_name", start.first_name, archive);
    list_ragged("/run/start/second_name", start.second_name, archive);
    archive.column("/run/start/moved", start.moved);
    list_ragged("/run/start/moved_name", start.moved_name, archive);
    archive.column("/run/start/translation", start.translation);
    archive.value("/last_step/kick", world.scratch.parameters.kick);
    saved.contacts.for_each_column([&](const char* name, auto& column, ColumnRole) {
        archive.column(std::string("/last_step/contacts/") + name, column);
    });
}

/// All but the settings, with which a world is made.
void list_state(WorldState& world, SavedRows& saved, auto&& archive) {
    archive.value("/clock/time", world.clock.time);
    archive.value("/clock/offset", world.clock.offset);
    archive.value("/clock/step_before", world.clock.step_before);
    archive.value("/clock/kick_before", world.clock.kick_before);
    list_records(saved, archive);
    list_model(world.model, archive);
    list_cache(world.cache, saved, archive);
    list_run(world, saved, archive);
}

}  // namespace skerry
