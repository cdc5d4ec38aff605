// Whether output can be written, asked before anything is computed.
#pragma once

#include <filesystem>
#include <span>

namespace skerry {

/// A file that can be made or replaced, its folders made where they are missing. Leaves no trace. Throws SceneError.
void require_writable_file(const std::filesystem::path& file);
/// A folder that can be made, or written into. Leaves no trace. Throws SceneError.
void require_writable_folder(const std::filesystem::path& folder);

/// What a person calls a file, and the file; an empty one is none.
struct NamedFile {
    const char* name;
    std::filesystem::path file;
};
/// No output takes the place of another one, or of what is read. Throws SceneError that names both.
void require_distinct(std::span<const NamedFile> files);

}  // namespace skerry
