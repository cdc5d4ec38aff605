// One number for all inputs that determine the result of a case.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>

#include "engine/scene/place.h"

namespace skerry {

class Hash;

/// Hashes cases of one scene: the content of its file after a case's assignments, and all scene and mesh files that it
/// names. Each file is read once.
class CaseHasher {
public:
    /// Throws SceneError for a scene that cannot be read.
    explicit CaseHasher(const std::filesystem::path& scene);
    /// Returns "0x" and 16 digits. Assignments that fail are hashed as text.
    std::string hash(std::span<const std::string> assignments);
    const Json& scene() const { return scene_; }

private:
    std::uint64_t hash_of_file(const std::filesystem::path& file);
    /// Adds the hashes of all files named by the keys "include" and "file".
    void add_files(const Json& json, const std::filesystem::path& of, Hash& hash);

    std::filesystem::path file_;
    Json scene_;
    std::map<std::filesystem::path, std::uint64_t> files_;
};

}  // namespace skerry
