// Compresses bytes with zlib (RFC 1950). Browsers decompress them with DecompressionStream("deflate").
#pragma once

#include <memory>
#include <string>
#include <string_view>

namespace skerry {

/// Compresses bytes as they arrive. Only the compressed bytes are stored.
class Deflater {
public:
    Deflater();
    ~Deflater();
    Deflater(Deflater&&) noexcept;
    Deflater& operator=(Deflater&&) noexcept;

    void add(std::string_view bytes);
    /// Returns all bytes added so far as a complete compressed stream. More bytes can be added afterwards.
    std::string packed() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace skerry
