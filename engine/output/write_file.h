// Writes a file so that it appears either complete or not at all.
#pragma once

#include <filesystem>
#include <iosfwd>

#include "jobs/function_ref.h"

namespace skerry {

/// Creates the folder if it does not exist. Throws SceneError with its name if it cannot be created or is not a folder.
void make_folder(const std::filesystem::path& folder);

/// Throws SceneError if write_file would refuse to replace an existing object of this name. Writable regular files and
/// streams such as pipes and terminals are accepted. Symbolic links are followed.
void require_replaceable(const std::filesystem::path& file);

/// Writes a temporary file beside `file`, then renames the temporary file. Other programs never see an incomplete file,
/// and a failure leaves the old file unchanged. The new file gets the permissions of the old one. If `file` is a
/// symbolic link, its target is replaced. Pipes and terminals are written directly. Creates the folder if needed.
/// Throws SceneError that names the file and the cause.
void write_file(const std::filesystem::path& file, FunctionRef<void(std::ostream&)> write);

}  // namespace skerry
