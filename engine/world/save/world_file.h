// Files that hold a whole world (docs/save_restore.md).
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

#include "engine/world/world_state.h"

namespace skerry {

/// Additional data in a file besides the world: a text that the caller provides.
struct SavedNote {
    std::string text;
};

/// Implementation of World::save. The world does not change.
void save_world(WorldState& world, const SavedNote& note, const std::filesystem::path& file);

struct LoadedWorld {
    World world;
    SavedNote note;
};
/// Implementation of World::load.
LoadedWorld load_world(const std::filesystem::path& file, const LoadSettings& settings);
/// Implementation of World::from_bytes. Messages use `name` in place of a file name. If `compare_hash` is true, a world
/// whose hash differs from the saved hash is refused. Tests of the reading code pass false, so that all consistent
/// values are accepted.
LoadedWorld read_world(const std::string& name, std::span<const std::byte> bytes, const LoadSettings& settings,
                       bool compare_hash = true);

}  // namespace skerry
