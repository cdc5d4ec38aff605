// What tetrahedra and contacts take of the memory, measured as differences between worlds.
#pragma once

#include "skerry/mesh.h"

namespace skerry::profiling {

struct MemoryFigures {
    double tetrahedron_in_balls = 0;  // bytes, in small bodies that touch nothing
    double tetrahedron_in_body = 0;   // bytes, in one large body
    double fixed = 0;                 // bytes, of a world whatever is in it
    double contact = 0;               // bytes, of a pile more than of as many balls apart, by contacts
    double contact_tables = 0;        // bytes, of that in the rows of contacts and of what they start from
    std::size_t contacts = 0, balls = 0;
};

/// Bytes that the program has from the allocator, exact and without what the allocator keeps: resident pages change
/// with what else the program has done. Balls of the given mesh, `balls_per_edge`^3 of them in the pile.
MemoryFigures measure_memory(const Mesh& ball, int balls_per_edge);

}  // namespace skerry::profiling
