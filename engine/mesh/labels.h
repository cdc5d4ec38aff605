// Labels of the tetrahedra of a mesh, for reports and messages.
#pragma once

#include <map>
#include <string>

#include "skerry/mesh.h"

namespace skerry::mesh {

/// Tetrahedra with each label.
std::map<int, std::size_t> count_labels(const Mesh& mesh);

/// "one of the labels of the mesh: 1, 2, 5", or that it has none; of many the first.
std::string expected_label(const Mesh& mesh);

}  // namespace skerry::mesh
