// Checks before any computation that output can be written.
#pragma once

#include <filesystem>
#include <span>

namespace skerry {

/// Requires that a file can be created or replaced; missing folders are created later. Leaves no trace. Throws
/// SceneError.
void require_writable_file(const std::filesystem::path& file);
/// Requires that a folder can be created or written into. Leaves no trace. Throws SceneError.
void require_writable_folder(const std::filesystem::path& folder);

/// A file and its name in messages; an empty path stands for no file.
struct NamedFile {
    const char* name;
    std::filesystem::path file;
};
/// Requires that no output replaces another one or an input. Throws SceneError that names both.
void require_distinct(std::span<const NamedFile> files);

}  // namespace skerry
