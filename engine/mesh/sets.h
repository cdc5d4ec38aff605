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

/// Nodes of a face in ascending order. Faces with the same sorted nodes are the same face.
inline std::array<Index, 3> sorted_face(std::array<Index, 3> face) {
    std::ranges::sort(face);
    return face;
}

/// Sorts the nodes and tetrahedra of a set and drops duplicates. Also drops faces with the same three nodes as an
/// earlier face of the set; the order of the other faces is kept.
void tidy(MeshSet& set);

/// Throws SceneError if a node or tetrahedron of a set does not exist, or if a listed face is neither a face of the
/// tetrahedra nor of the surface. The message names `object` and the set.
void require_set(const std::string& object, const std::string& name, const MeshSet& set, std::size_t node_count,
                 std::span<const std::array<Index, 4>> tetrahedra, std::span<const std::array<Index, 3>> surface = {});

/// Orients each face of the sets outward if it is on the boundary of the mesh. Drops triangles that are not faces of
/// the tetrahedra, and returns their number.
std::size_t match_faces(std::span<const std::array<Index, 4>> tetrahedra, std::map<std::string, MeshSet>& sets);

/// Returns the part of an error message that says which sets are possible: one of the sets "a", "b", or that there are
/// no sets.
std::string expected_set(const std::vector<std::string>& names);
std::vector<std::string> names_of(const std::map<std::string, MeshSet>& sets);

}  // namespace skerry::mesh
