// One number for all that the result of a case follows from.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>

#include "engine/scene/place.h"

namespace skerry {

class Hash;

/// Hashes of cases of one scene: of what its file holds after a case's assignments, and of the scene and mesh files
/// that this names. Files are read once.
class CaseHasher {
public:
    /// Throws SceneError for a scene that cannot be read.
    explicit CaseHasher(const std::filesystem::path& scene);
    /// "0x" and 16 digits. Assignments that cannot be carried out are hashed as they are.
    std::string hash(std::span<const std::string> assignments);
    const Json& scene() const { return scene_; }

private:
    std::uint64_t hash_of_file(const std::filesystem::path& file);
    /// Walks all that names a file: "include", "file".
    void add_files(const Json& json, const std::filesystem::path& of, Hash& hash);

    std::filesystem::path file_;
    Json scene_;
    std::map<std::filesystem::path, std::uint64_t> files_;
};

}  // namespace skerry
