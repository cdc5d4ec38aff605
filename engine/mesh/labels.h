// Labels of the tetrahedra of a mesh, for reports and messages.
#pragma once

#include <map>
#include <string>

#include "skerry/mesh.h"

namespace skerry::mesh {

/// Number of tetrahedra with each label.
std::map<int, std::size_t> count_labels(const Mesh& mesh);

/// Text for messages: "one of the labels of the mesh: 1, 2, 5" (the first 20), or "a mesh with labels" if it has none.
std::string expected_label(const Mesh& mesh);

}  // namespace skerry::mesh
