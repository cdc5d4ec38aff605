// Files that appear complete or not at all.
#pragma once

#include <filesystem>
#include <iosfwd>

#include "jobs/function_ref.h"

namespace skerry {

/// Makes the folder if needed. Throws SceneError that names it when it cannot be made or is no folder.
void make_folder(const std::filesystem::path& folder);

/// Throws SceneError where write_file would not replace what is there: anything but a file that may be written, and
/// what takes bytes as they come (a pipe, a terminal). Symbolic links stand for what they lead to.
void require_replaceable(const std::filesystem::path& file);

/// Writes to a temporary name beside `file` and renames it: a reader never sees half a file, and a failure leaves the
/// old one alone; the new one has its permissions. A symbolic link stays, and what it leads to is replaced; a pipe or a
/// terminal gets the bytes. Makes the folder. Throws SceneError that names the file and what stood in the way.
void write_file(const std::filesystem::path& file, FunctionRef<void(std::ostream&)> write);

}  // namespace skerry
