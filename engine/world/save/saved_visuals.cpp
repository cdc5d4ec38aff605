#include "engine/world/save/saved_visuals.h"

#include <algorithm>
#include <map>
#include <memory>
#include <vector>

#include "engine/mesh/visual/bound_visual.h"
#include "engine/world/save/saved_sets.h"

namespace skerry {

namespace {

/// Reads one visual surface. `first_material`: row of its first material in SavedVisuals::material_name and texture.
VisualSurface surface_of(const SavedVisuals& saved, std::size_t row, std::size_t first_material) {
    const auto list = [row](const auto& rows) { return std::vector(rows[row].begin(), rows[row].end()); };
    VisualSurface surface{.nodes = list(saved.nodes),
                          .triangles = list(saved.triangles),
                          .texture_points = list(saved.texture_points),
                          .texture_corners = list(saved.texture_corners),
                          .materials = {},
                          .material = list(saved.material),
                          .file = text_of_row(saved.file[row])};
    for (const std::array<Real, 4>& color : saved.color[row]) {
        const std::size_t material = first_material + surface.materials.size();
        surface.materials.push_back({.name = text_of_row(saved.material_name[material]),
                                     .color = {color[0], color[1], color[2]},
                                     .opacity = color[3],
                                     .texture = text_of_row(saved.texture[material])});
    }
    return surface;
}

}  // namespace

SavedVisuals visuals_to_save(const Model& model) {
    SavedVisuals saved;
    std::map<const BoundVisual*, Index> row_of;
    for (const BodyRecord& record : model.body_records) {
        if (!record.visual) {
            saved.of_body.push_back(no_index);
            continue;
        }
        const auto [known, is_new] = row_of.try_emplace(record.visual.get(), static_cast<Index>(row_of.size()));
        saved.of_body.push_back(known->second);
        if (!is_new) continue;
        const VisualSurface& surface = record.visual->surface;
        append<Vec3>(surface.nodes, saved.nodes);
        append<std::array<Index, 3>>(surface.triangles, saved.triangles);
        append<std::array<Real, 2>>(surface.texture_points, saved.texture_points);
        append<std::array<Index, 3>>(surface.texture_corners, saved.texture_corners);
        append<Index>(surface.material, saved.material);
        append_text(surface.file, saved.file);
        std::vector<std::array<Real, 4>> colors;
        for (const VisualMaterial& material : surface.materials) {
            colors.push_back({material.color[0], material.color[1], material.color[2], material.opacity});
            append_text(material.name, saved.material_name);
            append_text(material.texture, saved.texture);
        }
        append<std::array<Real, 4>>(colors, saved.color);
    }
    return saved;
}

void put_visuals(const SavedVisuals& saved, const SavedFile& file, Model& model) {
    const std::size_t bodies = model.body_records.size(), count = saved.nodes.size(),
                      materials = saved.color.item.size();
    expect_rows(file, "visuals/of_body", saved.of_body.size(), bodies, "bodies");
    expect_rows_of(file, "visuals/of_body", saved.of_body, count, true);
    expect_ragged(file, "visuals/nodes", saved.nodes, count, "visual surfaces");
    expect_ragged(file, "visuals/triangles", saved.triangles, count, "visual surfaces");
    expect_ragged(file, "visuals/texture_points", saved.texture_points, count, "visual surfaces");
    expect_ragged(file, "visuals/texture_corners", saved.texture_corners, count, "visual surfaces");
    expect_ragged(file, "visuals/material", saved.material, count, "visual surfaces");
    expect_ragged(file, "visuals/file", saved.file, count, "visual surfaces");
    expect_ragged(file, "visuals/color", saved.color, count, "visual surfaces");
    expect_ragged(file, "visuals/material_name", saved.material_name, materials, "materials of visual surfaces");
    expect_ragged(file, "visuals/texture", saved.texture, materials, "materials of visual surfaces");
    std::map<Index, std::size_t> first_body;  // by row of a visual surface: first body that has it
    for (std::size_t b = 0; b < bodies; ++b) {
        const Index row = saved.of_body[b];
        if (row == no_index) continue;
        BodyRecord& record = model.body_records[b];
        const auto [first, is_new] = first_body.try_emplace(row, b);
        const std::span<const Vec3> nodes = model.mesh_shape(b);
        if (nodes.empty())
            file.complain("visuals/of_body", "a visual surface of body " + std::to_string(b) + ", which has no nodes",
                          "no visual surface");
        if (!is_new && std::ranges::equal(nodes, model.mesh_shape(first->second)) &&
            record.tetrahedra == model.body_records[first->second].tetrahedra &&
            record.surface == model.body_records[first->second].surface) {
            record.visual = model.body_records[first->second].visual;
            continue;
        }
        const auto place = static_cast<std::size_t>(row);
        VisualSurface surface = surface_of(saved, place, static_cast<std::size_t>(saved.color.offset[place]));
        try {
            require_visual(surface, "body " + std::to_string(b));
        } catch (const SceneError& error) {
            file.complain("visuals", std::string("an invalid surface (") + error.what() + ")", "a valid surface");
        }
        record.visual = std::make_shared<const BoundVisual>(
            bind_visual(std::move(surface), nodes, record.tetrahedra, record.surface));
    }
}

}  // namespace skerry
