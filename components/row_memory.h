// Memory of columns: whole cache lines and, of long ones, pages of 2 MiB where the system has them.
#pragma once

#include <cstddef>

namespace skerry {

/// Bytes to which the rows of a column are aligned: a vector register, and a line that no other column shares.
inline constexpr std::size_t row_alignment = 64;

/// Memory of `bytes`, which may be 0, from operator new. A step goes through the columns of a large world once: with
/// pages of 4 kB looking up where each is takes 4 % of a step of 360,000 tetrahedra (docs/scaling.md). So Linux is
/// asked for pages of 2 MiB under what spans whole ones. Throws std::bad_alloc.
void* allocate_rows(std::size_t bytes);
void free_rows(void* memory) noexcept;

}  // namespace skerry
