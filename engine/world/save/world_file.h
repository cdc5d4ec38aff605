// Files that hold a whole world (docs/save_restore.md): a head of text followed by an HDF5 file.
#pragma once

#include <filesystem>
#include <string>

#include "engine/world/world_state.h"

namespace skerry {

/// Data that a file holds besides the world: a text of the caller.
struct SavedNote {
    std::string text;
};

/// Does all that World::save does. The world does not change.
void save_world(WorldState& world, const SavedNote& note, const std::filesystem::path& file);

struct LoadedWorld {
    World world;
    SavedNote note;
};
/// Reads a file as World::load does. `compare_hash`: refuse a world whose hash differs from the saved one. Without it
/// any values that fit together are accepted, for tests of the code that reads them.
LoadedWorld load_world(const std::filesystem::path& file, const LoadSettings& settings, bool compare_hash = true);

}  // namespace skerry
