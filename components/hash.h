// Hash: a 64-bit hash of any amount of data.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "components/column.h"

namespace skerry {

/// Hash function XXH3 with 64 bits (Y. Collet; docs/decisions/0010-xxhash.md). XXH3 is not a cryptographic hash, but a
/// change of the data almost surely changes the hash. The same bytes give the same hash on every machine. The hash does
/// not depend on how the bytes are divided among calls of add.
class Hash {
public:
    Hash();
    void add(const void* data, std::size_t bytes);
    void add(std::uint64_t word) { add(&word, sizeof word); }
    /// Adds the number of rows, then the rows. T must have no padding, since padding bytes may have any value.
    template <class T>
    void add(std::span<const T> rows) {
        add(rows.size());
        add(rows.data(), rows.size_bytes());
    }
    template <class T>
    void add(const Column<T>& column) {
        add(column.span());
    }
    std::uint64_t value() const;

private:
    alignas(64) std::byte state_[576];
};

}  // namespace skerry
