// Memory use of tetrahedra and contacts, measured as differences between worlds.
#pragma once

#include "skerry/mesh.h"

namespace skerry::profiling {

struct MemoryFigures {
    double tetrahedron_in_balls = 0;  // per tetrahedron in small bodies that touch nothing [bytes]
    double tetrahedron_in_body = 0;   // per tetrahedron in one large body [bytes]
    double fixed = 0;                 // of a world regardless of its content [bytes]
    double contact = 0;               // difference of a pile to as many separate balls, per contact [bytes]
    double contact_tables = 0;        // part of `contact` in the rows of contacts and of their start values [bytes]
    std::size_t contacts = 0, balls = 0;
};

/// Measures the bytes in use from the allocator. They are exact and exclude memory that the allocator retains, while
/// resident pages depend on earlier work of the program. `ball` is the mesh of the balls; the pile has
/// `balls_per_edge`^3 of them.
MemoryFigures measure_memory(const Mesh& ball, int balls_per_edge);

}  // namespace skerry::profiling
