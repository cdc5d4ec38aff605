// Named sets of nodes, faces and tetrahedra: checks, and texts of error messages.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "skerry/mesh.h"

namespace skerry::mesh {

/// The nodes of a face in ascending order, by which faces are compared.
inline std::array<Index, 3> sorted_face(std::array<Index, 3> face) {
    std::ranges::sort(face);
    return face;
}

/// Sorts the nodes and tetrahedra of a set and drops duplicates. Also drops faces with the same three nodes as an
/// earlier face of the set; the order of the other faces is kept.
void tidy(MeshSet& set);

/// Throws SceneError that names `object` and the set if a number is out of range, or if a listed face is not a face of
/// the tetrahedra or of the surface.
void require_set(const std::string& object, const std::string& name, const MeshSet& set, std::size_t node_count,
                 std::span<const std::array<Index, 4>> tetrahedra, std::span<const std::array<Index, 3>> surface = {});

/// Orients those faces of the sets that are boundary triangles outward, and drops triangles that are not faces of the
/// tetrahedra. Returns the number of dropped triangles.
std::size_t match_faces(std::span<const std::array<Index, 4>> tetrahedra, std::map<std::string, MeshSet>& sets);

/// Returns the text on the expected set for an error message: that one of the sets "a", "b" is expected, or that there
/// are no sets.
std::string expected_set(const std::vector<std::string>& names);
std::vector<std::string> names_of(const std::map<std::string, MeshSet>& sets);

}  // namespace skerry::mesh
