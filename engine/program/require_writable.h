// Checks before any computation whether the outputs can be written.
#pragma once

#include <filesystem>
#include <span>

namespace skerry {

/// Throws SceneError unless the file can be created or replaced. The folder may be missing if it can be created. The
/// check does not change any file or folder.
void require_writable_file(const std::filesystem::path& file);
/// Throws SceneError unless the folder exists and is writable, or can be created. The check does not change any file or
/// folder.
void require_writable_folder(const std::filesystem::path& folder);

/// A file, and the name by which messages call it. An empty path means that there is no such file.
struct NamedFile {
    const char* name;
    std::filesystem::path file;
};
/// Throws SceneError if two of the files are the same, so that no output replaces another output or an input. The error
/// names both files. Devices such as /dev/null may be named several times.
void require_distinct(std::span<const NamedFile> files);

}  // namespace skerry
