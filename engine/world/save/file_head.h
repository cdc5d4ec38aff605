// Text at the start of a saved world, before the HDF5 part. It identifies the file and shows whether the file is
// damaged. libhdf5 may crash on damaged files, so only undamaged data are passed to it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace skerry {

/// Size of the text [bytes]. HDF5 allows a block of this size for the user's own data before the HDF5 data.
inline constexpr std::size_t head_bytes = 512;
inline constexpr int world_file_version = 24;

/// Returns the text for a file whose HDF5 part is `body`.
std::string head_of(std::span<const char> body);

/// Throws SceneError unless the file is undamaged and has the present file version.
void check_head(const std::filesystem::path& file);

}  // namespace skerry
