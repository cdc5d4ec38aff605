// Whether output can be written, asked before anything is computed.
#pragma once

#include <filesystem>

namespace skerry {

/// A file that can be made or replaced, its folders made where they are missing. Leaves no trace. Throws SceneError.
void require_writable_file(const std::filesystem::path& file);
/// A folder that can be made, or written into. Leaves no trace. Throws SceneError.
void require_writable_folder(const std::filesystem::path& folder);

}  // namespace skerry
