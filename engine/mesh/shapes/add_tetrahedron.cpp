#include "engine/mesh/shapes/add_tetrahedron.h"

#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "engine/mesh/tetrahedron.h"

namespace skerry::mesh {

void add_tetrahedron(Mesh& mesh, std::array<Index, 4> nodes) {
    if (six_volumes(mesh, nodes) < 0) std::swap(nodes[2], nodes[3]);
    mesh.tetrahedra.push_back(nodes);
}

void require_size(const char* name, Real value) {
    if (!(std::isfinite(value) && value > 0))
        throw std::invalid_argument(std::string(name) + ": found " + std::to_string(value) +
                                    ", expected a length > 0 (m)");
}

void require_count(const char* name, int value) {
    if (value < 1)
        throw std::invalid_argument(std::string(name) + ": found " + std::to_string(value) +
                                    ", expected an integer >= 1");
}

void require_fits(const char* name, double tetrahedra) {
    // The table of triangle corners has four rows per tetrahedron, and row numbers have 32 bits.
    constexpr int most = 0x7fffffff / 4;
    if (!(tetrahedra <= most))
        throw std::invalid_argument(std::string(name) + ": found a mesh of about " + std::to_string(tetrahedra) +
                                    " elements, expected at most " + std::to_string(most) +
                                    " (indices have 32 bits; use a coarser mesh)");
}

}  // namespace skerry::mesh
