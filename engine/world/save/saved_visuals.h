// Visual surfaces of bodies (surfaces that are drawn in place of the meshes), in the form in which files contain them.
// The binding of their points to the meshes is computed again after reading.
#pragma once

#include <array>
#include <cstdint>

#include "components/ragged.h"
#include "engine/world/save/saved_file.h"
#include "engine/world/state/model.h"

namespace skerry {

/// The lists have one row per visual surface, except where noted.
struct SavedVisuals {
    Column<Index> of_body;  // by body: row of its visual surface, or no_index
    Ragged<Vec3> nodes;     // [m]
    Ragged<std::array<Index, 3>> triangles, texture_corners;
    Ragged<std::array<Real, 2>> texture_points;
    Ragged<Index> material;
    Ragged<std::uint8_t> file;
    Ragged<std::array<Real, 4>> color;            // by material of the surface: red, green, blue and opacity
    Ragged<std::uint8_t> material_name, texture;  // one row per material of all surfaces
};

SavedVisuals visuals_to_save(const Model& model);
/// Restores and binds the visual surfaces of all bodies. Throws SceneError that names the file if they are
/// inconsistent. Must be called after the meshes of the bodies were restored.
void put_visuals(const SavedVisuals& saved, const SavedFile& file, Model& model);

}  // namespace skerry
