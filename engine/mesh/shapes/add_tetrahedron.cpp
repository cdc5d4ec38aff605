#include "engine/mesh/shapes/add_tetrahedron.h"

#include <cmath>
#include <string>
#include <utility>

#include "engine/base/complaint.h"
#include "engine/mesh/tetrahedron.h"

namespace skerry::mesh {

void add_tetrahedron(Mesh& mesh, std::array<Index, 4> nodes) {
    if (six_volumes(mesh, nodes) < 0) std::swap(nodes[2], nodes[3]);
    mesh.tetrahedra.push_back(nodes);
}

void require_size(const char* shape, const char* field, Real value) {
    if (!(std::isfinite(value) && value > 0)) refuse(shape, field, short_text(value, 6), "a length > 0 (m)");
}

void require_count(const char* shape, const char* field, int value) {
    if (value < 1) refuse(shape, field, std::to_string(value), "a whole number >= 1");
}

void require_fits(const char* shape, const char* field, double tetrahedra) {
    // Tables of corners and of faces have four entries per tetrahedron, and their indices are 32-bit integers.
    constexpr int most = 0x7fffffff / 4;
    if (!(tetrahedra <= most))
        refuse(shape, field, "a mesh of about " + short_text(tetrahedra, 6) + " elements",
               "at most " + std::to_string(most) + ", because indices have 32 bits");
}

}  // namespace skerry::mesh
