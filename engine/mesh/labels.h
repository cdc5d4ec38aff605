// Labels of the tetrahedra of a mesh, for reports and error messages.
#pragma once

#include <map>
#include <string>

#include "skerry/mesh.h"

namespace skerry::mesh {

/// Number of tetrahedra with each label.
std::map<int, std::size_t> count_labels(const Mesh& mesh);

/// Returns the part of an error message that says which labels are possible: "one of the labels of the mesh: 1, 2, 5"
/// (at most 20 labels), or that the mesh has no labels.
std::string expected_label(const Mesh& mesh);

}  // namespace skerry::mesh
