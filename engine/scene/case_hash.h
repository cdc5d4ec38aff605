// Hash of a scene, the assignments that change it and the files that it names.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "engine/scene/place.h"

namespace skerry {

class Hash;

/// Computes hashes of the cases of one scene. A case is the scene, changed by a list of assignments (assign.h). Its
/// hash covers the changed scene and all scene and mesh files that the scene names, so an unchanged hash shows that an
/// earlier result of the case is still valid.
class CaseHasher {
public:
    /// Throws SceneError if the scene file cannot be read.
    explicit CaseHasher(const std::filesystem::path& scene);
    /// Returns the hash of a case as "0x" and 16 hexadecimal digits. If an assignment is refused, the hash also covers
    /// the text of all assignments, so that it still differs from the hashes of other cases.
    std::string hash(std::span<const std::string> assignments);
    const Json& scene() const { return scene_; }
    /// Returns the files that hash() has read so far: included scenes, meshes and surfaces, without the scene itself.
    std::vector<std::filesystem::path> files() const;

private:
    std::uint64_t hash_of_file(const std::filesystem::path& file);
    /// Adds to `hash` the hashes of all files that `json` names: scenes, meshes and surfaces. Names are relative to the
    /// folder of the file `source_file`, from which `json` was read.
    void add_files(const Json& json, const std::filesystem::path& source_file, Hash& hash);

    std::filesystem::path file_;
    Json scene_;
    std::map<std::filesystem::path, std::uint64_t> files_;
};

}  // namespace skerry
