// Files that appear complete or not at all.
#pragma once

#include <filesystem>
#include <iosfwd>

#include "jobs/function_ref.h"

namespace skerry {

/// Makes the folder if needed. Throws SceneError that names it when it cannot be made or is no folder.
void make_folder(const std::filesystem::path& folder);

/// Writes to a temporary name beside `file` and renames it: a reader never sees half a file, and a failure leaves the
/// old one alone. Makes the folder. Throws SceneError that names the file and what stood in the way.
void write_file(const std::filesystem::path& file, FunctionRef<void(std::ostream&)> write);

}  // namespace skerry
