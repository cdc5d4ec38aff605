// Copies of scene files with other values.
#pragma once

#include <filesystem>
#include <span>
#include <string>

namespace skerry {

/// Returns the path by which the scene file `scene` names `file`: relative to the folder of the scene file.
std::string path_in_scene(const std::filesystem::path& file, const std::filesystem::path& scene);

/// Writes the content of the scene file `source` with assignments (assign.h) to the file `target`. Keys keep their
/// order. Paths of meshes, visual surfaces, included scenes and the schema are changed so that they still name the
/// files that they name in `source`. Throws SceneError if the assignments are invalid or the file cannot be written.
void write_scene(const std::filesystem::path& target, const std::filesystem::path& source,
                 std::span<const std::string> assignments);

}  // namespace skerry
