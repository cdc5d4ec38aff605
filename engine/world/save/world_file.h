// Files that hold a whole world (docs/save_restore.md): a head of text and an HDF5 file behind it.
#pragma once

#include <filesystem>
#include <string>

#include "engine/world/world_state.h"

namespace skerry {

/// What a file is told to hold beside the world: a text of whoever saves it.
struct SavedNote {
    std::string text;
};

/// All that World::save writes. Changes nothing of the world.
void save_world(WorldState& world, const SavedNote& note, const std::filesystem::path& file);

struct LoadedWorld {
    World world;
    SavedNote note;
};
/// What World::load reads. `compare_hash`: whether the world must be the very one that was saved. Without it any values
/// that fit together are taken: for tests of what reads them.
LoadedWorld load_world(const std::filesystem::path& file, const LoadSettings& settings, bool compare_hash = true);

}  // namespace skerry
