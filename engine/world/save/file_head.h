// Text before the HDF5 part of a saved world. It identifies the file and reveals damage. libhdf5 may crash on damaged
// files, so it gets only data that are exactly as written.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace skerry {

/// Size of the text in bytes. HDF5 allows a user block of this size before its data.
inline constexpr std::size_t head_bytes = 512;
inline constexpr int world_file_version = 22;

/// Returns the text for a file whose HDF5 part is `body`.
std::string head_of(std::span<const char> body);

/// Throws SceneError unless the file is undamaged and has the present file version.
void check_head(const std::filesystem::path& file);

}  // namespace skerry
