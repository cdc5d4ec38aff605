// Decompresses a block of zlib (RFC 1950).
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace skerry::mesh {

/// Returns the `size` bytes of a compressed block, or nothing if the block is damaged or has a different size.
std::optional<std::string> inflated(std::string_view packed, std::size_t size);

}  // namespace skerry::mesh
