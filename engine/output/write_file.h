// Writes files that appear complete or not at all.
#pragma once

#include <filesystem>
#include <iosfwd>

#include "jobs/function_ref.h"

namespace skerry {

/// Creates the folder if needed. Throws SceneError that names it if this fails or if it is not a folder.
void make_folder(const std::filesystem::path& folder);

/// Throws SceneError if write_file would refuse to replace an existing object. It accepts writable regular files and
/// streams such as pipes and terminals. Symbolic links are followed.
void require_replaceable(const std::filesystem::path& file);

/// Writes to a temporary name beside `file`, then renames it. A reader never sees an incomplete file; a failure leaves
/// the old file unchanged. The new file gets the old permissions. A symbolic link stays and its target is replaced;
/// pipes and terminals receive the bytes. Creates the folder. Throws SceneError that names the file and the cause.
void write_file(const std::filesystem::path& file, FunctionRef<void(std::ostream&)> write);

}  // namespace skerry
