// What stands before the HDF5 part of a saved world: text that says what it is and tells damage. libhdf5 may crash on
// damaged files, so nothing is given to it that is not as it was written.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace skerry {

/// HDF5 files may begin with as much of something else.
inline constexpr std::size_t head_bytes = 512;
inline constexpr int world_file_version = 21;

/// The head of a file that goes on with `body`.
std::string head_of(std::span<const char> body);

/// Throws SceneError unless the file is whole and of this version.
void check_head(const std::filesystem::path& file);

}  // namespace skerry
